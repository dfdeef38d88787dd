//! File names of Triangle meshes: a written mesh is found by each of its names.

use super::facts::mesh_of;
use super::{ELE, Folder, NODE, POLY};
use mesh_io::MeshFile;
use std::fs;

#[test]
fn endings_are_kept_as_given_and_the_partner_is_alike() {
    let folder = Folder::new(&[("in.node", NODE), ("in.ele", ELE)]);
    let file = folder.read("in.node");
    for (out, node, ele) in [
        ("o.Node", "o.Node", "o.Ele"),
        ("p.ELE", "p.NODE", "p.ELE"),
        ("q.nOdE", "q.nOdE", "q.ele"),
        ("r", "r.node", "r.ele"),
    ] {
        file.write(&folder.path(out), file.points()).unwrap();
        assert_eq!((folder.text(node).as_str(), folder.text(ele).as_str()), (NODE, ELE), "{out}");
        assert_eq!(mesh_of(&folder.read(out)), mesh_of(&file), "{out}");
    }
}

#[test]
fn a_mesh_is_not_written_where_another_file_would_be_read_with_it() {
    let folder = Folder::new(&[("in.node", NODE), ("in.ele", ELE), ("out.poly", POLY)]);
    fs::write(folder.path("plain"), "something else").unwrap();
    let file = folder.read("in.node");
    for (out, part) in
        [("out.node", "out.poly exists, belongs to another mesh"), ("plain", "a file of this name")]
    {
        let error = file.write(&folder.path(out), file.points()).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
        assert_eq!(file.check_destination(&folder.path(out)).unwrap_err().to_string(), error);
    }
    let names = ["out.node", "out.ele", "plain.node", "plain.ele"];
    assert!(names.iter().all(|name| !folder.path(name).exists()));
    // Now the mesh has a .poly of its own, which replaces the older file.
    fs::write(folder.path("in.poly"), POLY).unwrap();
    let file = MeshFile::read(&folder.path("in.node")).unwrap();
    file.write(&folder.path("out.node"), file.points()).unwrap();
    assert_eq!(folder.text("out.poly"), POLY);
}
