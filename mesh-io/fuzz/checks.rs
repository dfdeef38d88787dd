//! Checks of what must hold for any file. The fuzzer's targets and `tests/fuzz.rs` share them. Each panics if something does not
//! hold.

use std::fs;
use std::path::Path;

use mesh_io::{Conversion, Format, MeshFile, Remark};

/// Reads any bytes as a mesh file of any format but Triangle's, and does everything with it that needs no second file.
pub(crate) fn any_file(bytes: &[u8]) {
    match MeshFile::from_bytes(Path::new("fuzzed"), bytes.to_vec()) {
        Ok(file) => {
            use_file(&file);
            let mut written = Vec::new();
            file.write_to(Path::new("again"), &mut written, file.points()).unwrap();
            assert!(written == bytes, "a file that has not changed is written otherwise");
        }
        Err(error) => assert_told(&error.to_string()),
    }
}

/// Reads any bytes as a file beside an XDMF, in HDF5 or raw.
pub(crate) fn any_file_beside(folder: &Path, bytes: &[u8]) {
    const NAMING: [(&str, &str); 3] = [
        ("dolfin.h5", include_str!("../tests/formats/h5/dolfin.xdmf")),
        ("latest.h5", include_str!("../tests/formats/h5/latest.xdmf")),
        ("raw.bin", include_str!("../tests/formats/h5/raw.xdmf")),
    ];
    let path = folder.join("fuzzed.xdmf");
    for (named, text) in NAMING {
        // The cells of the raw one stand in the same file.
        let text = text.replace("raw-cells.bin", named).replace(named, "fuzzed.h5");
        fs::write(&path, &text).unwrap();
        fs::write(folder.join("fuzzed.h5"), bytes).unwrap();
        match MeshFile::read(&path) {
            Ok(file) => {
                use_file(&file);
                file.write(&path, file.points()).unwrap();
                assert_eq!(fs::read_to_string(&path).unwrap(), text);
                let again = fs::read(folder.join("fuzzed.h5")).unwrap();
                assert!(again == bytes, "a file that has not changed is written otherwise");
            }
            Err(error) => assert_told(&error.to_string()),
        }
    }
}

/// Reads any bytes as the two or three files of a Triangle mesh, which a byte that no text holds parts.
pub(crate) fn any_triangle_files(folder: &Path, bytes: &[u8]) {
    let mut parts = bytes.splitn(3, |byte| *byte == 0xFF);
    for ending in ["node", "ele", "poly"] {
        let path = folder.join("fuzzed").with_extension(ending);
        match parts.next() {
            Some(part) => fs::write(path, part).unwrap(),
            None => drop(fs::remove_file(path)),
        }
    }
    match MeshFile::read(&folder.join("fuzzed.node")) {
        // A file of this name may be of another format by its first bytes.
        Ok(file) if file.format() != Format::Triangle => use_file(&file),
        Ok(file) => {
            use_file(&file);
            // Of an earlier mesh, whose lines are not those of this one.
            drop(fs::remove_file(folder.join("again.poly")));
            file.write(&folder.join("again.node"), file.points()).unwrap();
            for ending in ["node", "ele"] {
                let [own, again] = ["fuzzed", "again"]
                    .map(|name| fs::read(folder.join(name).with_extension(ending)).unwrap());
                assert!(own == again, "a .{ending} that has not changed is written otherwise");
            }
        }
        Err(error) => assert_told(&error.to_string()),
    }
}

/// Checks that a message has one line, names the file, and is short enough to read.
fn assert_told(message: &str) {
    assert!(message.contains("fuzzed") && message.len() < 600, "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
}

fn use_file(file: &MeshFile) {
    let vertices = file.points().len();
    let between = file.interface_vertices();
    let constrained = file.constraints().vertices.iter();
    let mut named = file.triangles().iter().flatten().chain(constrained).chain(&between);
    assert!(named.all(|&v| (v as usize) < vertices), "a vertex that does not exist");
    assert_eq!(file.vertex_locations(0..vertices as u32).len(), vertices);
    assert_eq!(file.triangle_locations(0..file.triangles().len()).len(), file.triangles().len());
    if let Ok(groups) = file.groups() {
        for group in groups.iter() {
            let is_of_lines = group.dimension == 1 && !group.vertices().is_empty();
            assert!(!is_of_lines || file.may_name_lines(), "{group}");
            assert!(group.vertices().iter().all(|&v| (v as usize) < vertices));
            assert!(group.triangles().iter().all(|&t| (t as usize) < file.triangles().len()));
        }
    }
    if let Ok(fields) = file.point_fields(None) {
        assert!(fields.iter().all(|f| f.values().len() == vertices * f.components()));
    }
    let _ = file.plane_parameters(file.points(), file.points());
    assert!(file.difference(file).is_none());
    write_moved(file);
    for (name, format) in Conversion::targets() {
        let Ok(Some(conversion)) = Conversion::new(file, format) else { continue };
        let Some(text) = conversion.text() else { continue };
        match MeshFile::from_bytes(Path::new("fuzzed"), text.into_bytes()) {
            Ok(again) => {
                // Some formats hold fewer digits.
                let stored = |point: &[f64; 2]| point.map(|x| again.precision().rounded(x));
                let points: Vec<_> = file.points().iter().map(stored).collect();
                assert!(again.points() == points, "other points, written as {name}");
                let mut lists = [again.triangles(), file.triangles()].map(<[_]>::to_vec);
                if conversion.losses().iter().any(|lost| lost.starts_with("the order of triangles"))
                {
                    lists.iter_mut().for_each(|list| list.sort_unstable());
                }
                assert!(lists[0] == lists[1], "other triangles, written as {name}");
            }
            // What a damaged file holds need not be a valid mesh in each format.
            Err(error) => assert_told(&error.to_string()),
        }
    }
}

/// Writes a file with every vertex elsewhere: what is read again must be that mesh, and nothing else may differ.
fn write_moved(file: &MeshFile) {
    // Cells that are found from edges depend on the coordinates.
    let is_of_edges = |remark: &Remark| matches!(remark, Remark::CellsOfEdges { .. });
    if file.paths().count() > 1 || file.remarks().iter().any(is_of_edges) {
        return;
    }
    let moved = |x: &f64| file.precision().rounded(x + x / 1024.0 + 1.0 / 64.0);
    let points: Vec<_> = file.points().iter().map(|[x, y]| [moved(x), moved(y)]).collect();
    let mut written = Vec::new();
    match file.write_to(Path::new("fuzzed"), &mut written, &points) {
        Ok(()) => {
            let again = MeshFile::from_bytes(Path::new("again"), written).unwrap();
            assert!(again.points() == points, "a vertex is not where it was written");
            assert_eq!(again.triangles(), file.triangles());
            assert_eq!(file.difference(&again), None);
        }
        Err(error) => assert_told(&error.to_string()),
    }
}
