//! Mesh files that another program changes between reading and writing.

use super::{Folder, NODE, triangle};
use mesh_io::{MeshFile, WriteError};
use std::fs;

fn moved(file: &MeshFile, by: f64) -> Vec<[f64; 2]> {
    file.points().iter().map(|[x, y]| [x + by, *y]).collect()
}

/// Checks that a write to `out` is refused because the file `name` has changed, and that no file changes.
#[track_caller]
fn assert_changed(folder: &Folder, file: &MeshFile, out: &str, name: &str) {
    let content = || ["la.1.node", "la.1.ele", "la.1.poly"].map(|name| fs::read(folder.path(name)));
    let before = content().map(Result::ok);
    match file.write(&folder.path(out), &moved(file, 0.5)) {
        Err(WriteError::Changed { path }) => assert_eq!(path, folder.path(name)),
        other => panic!("{other:?}"),
    }
    assert!(content().map(Result::ok) == before);
    assert_eq!(folder.count(), 3);
}

#[test]
fn a_file_that_was_changed_after_reading_is_not_replaced() {
    // One edit keeps the length of the file, and comes within the resolution of modification times.
    let edits = [("la.1.node", NODE.replacen('2', "3", 1)), ("la.1.ele", "# new\n".to_owned())];
    for (name, edited) in edits {
        let folder = triangle();
        let file = folder.read("la.1");
        fs::write(folder.path(name), edited).unwrap();
        assert_changed(&folder, &file, "la.1.node", name);
        // A write to another path still succeeds.
        file.write(&folder.path("other"), &moved(&file, 0.5)).unwrap();
        folder.read("other");
    }
}

#[test]
fn a_file_is_written_in_place_again_and_again_by_one_reader() {
    let folder = triangle();
    let file = folder.read("la.1");
    for by in [0.5, 0.25, 0.0] {
        file.write(file.path(), &moved(&file, by)).unwrap();
        assert_eq!(folder.read("la.1").points(), moved(&file, by));
    }
    // A file with the bytes that were read is unchanged, whichever program wrote the bytes.
    fs::write(folder.path("la.1.node"), NODE).unwrap();
    file.write(file.path(), &moved(&file, 0.5)).unwrap();
    let second = folder.read("la.1");
    file.write(file.path(), &moved(&file, 0.25)).unwrap();
    assert_changed(&folder, &second, "la.1.ele", "la.1.node");
    // A missing file has no content to lose, so the write succeeds.
    fs::remove_file(folder.path("la.1.node")).unwrap();
    file.write(&folder.path("la.1.node"), file.points()).unwrap();
}
