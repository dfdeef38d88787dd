//! Exodus II: names of groups, and refused files.

use super::Folder;
use super::facts::fixed;
use super::made::{Made, all, base};
use super::others::folder;
use mesh_io::{Conversion, Format, MeshFile};
use std::fs;

fn samples() -> Vec<Made> {
    let mut all = all(&base());
    all.retain(|made| made.format == Format::Exodus);
    all
}

#[test]
fn blocks_and_sets_are_groups() {
    for made in samples() {
        let file = folder(&made, &made.bytes).read(made.name);
        let groups = file.groups().unwrap();
        let told: Vec<_> = groups
            .iter()
            .map(|g| (g.to_string(), g.tag, g.triangles().len(), g.lines, g.vertices().len()))
            .collect();
        let told: Vec<_> =
            told.iter().map(|(name, tag, t, l, v)| (name.as_str(), *tag, *t, *l, *v)).collect();
        for expected in [
            ("block line wire", Some(9), 0, 1, 2),
            ("block surface steel", Some(5), 30, 0, 24),
            ("block surface 7", Some(7), 0, 0, 4),
            ("sideset line shore", Some(40), 0, 2, 4),
            ("nodeset point 1", Some(1), 0, 0, 3),
        ] {
            // The vertex count of `steel` is not checked, as the block shares vertices with neighbors that the mesh
            // determines.
            let found = told.iter().find(|group| group.0 == expected.0);
            let Some(found) = found else { panic!("no {} in {told:?}", expected.0) };
            assert_eq!((found.1, found.2, found.3), (expected.1, expected.2, expected.3));
            assert!(found.4 == expected.4 || expected.0.contains("steel"), "{found:?}");
        }
        assert_eq!(groups.find("nodeset:1").unwrap().vertices(), [0, 12, 14]);
        // Vertices of node sets may move.
        assert!(!fixed(&file).contains(&14));
        assert!(groups.find("steel").unwrap().triangles().iter().copied().eq(0..30));
    }
}

/// The sample is in space, so side 3 of its first triangle is the first edge. In the plane, side 3 is the third edge.
#[test]
fn sides_of_triangles_begin_with_two_faces_in_space_and_with_edges_in_the_plane() {
    for made in samples() {
        let [a, b, c] = made.mesh.triangles[0];
        let shore = |bytes: &[u8]| {
            let file = folder(&made, bytes).read(made.name);
            let groups = file.groups().unwrap();
            let shore = groups.find("shore").unwrap();
            assert_eq!(shore.lines, 2);
            shore.vertices().to_vec()
        };
        let has = |vertices: &[u32], v: u32| vertices.contains(&v);
        let in_space = shore(&made.bytes);
        assert!(has(&in_space, a) && has(&in_space, b) && !has(&in_space, c), "{in_space:?}");
        if !made.bytes.windows(6).any(|part| part == b"coordx") {
            // A table of all axes has the dimension num_dim, and could not keep three axes.
            continue;
        }
        let name = b"num_dim\0";
        let at = made.bytes.windows(name.len()).position(|part| part == name).unwrap() + name.len();
        let length = at + made.bytes[at..].iter().position(|&byte| byte == 3).unwrap();
        let mut in_plane = made.bytes.clone();
        in_plane[length] = 2;
        let in_plane = shore(&in_plane);
        assert!(has(&in_plane, a) && !has(&in_plane, b) && has(&in_plane, c), "{in_plane:?}");
    }
}

/// Writes the edge of a mesh in space to a side set, as another program would read the set.
#[test]
fn a_mesh_in_space_is_written_with_the_sides_of_triangles_in_space() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 7 \"shore\"\n$EndPhysicalNames\n\
        $Nodes\n4\n1 0 0 1\n2 1 0 1\n3 1 1 2\n4 0 1 1\n$EndNodes\n\
        $Elements\n4\n1 1 2 7 7 2 3\n2 1 2 7 7 3 4\n3 2 2 1 1 1 2 3\n4 2 2 1 1 1 3 4\n$EndElements\n";
    let folder = Folder::new(&[("in.msh", text)]);
    let file = folder.read("in.msh");
    let conversion = Conversion::new(&file, Format::Exodus).unwrap().unwrap();
    conversion.write(&folder.path("out.exo")).unwrap();
    let bytes = fs::read(folder.path("out.exo")).unwrap();
    // Elements 1 and 2, both with side 4: the second edge after two faces.
    let set: Vec<u8> = [1_i32, 2, 4, 4].iter().flat_map(|number| number.to_be_bytes()).collect();
    let count = bytes.windows(16).filter(|part| **part == *set).count();
    let groups = folder.read("out.exo").groups().unwrap();
    let shore = groups.find("shore").unwrap();
    assert_eq!((shore.lines, shore.vertices()), (2, &[1, 2, 3][..]));
    assert_eq!(count, 1, "no side 4 of elements 1 and 2");
}

#[test]
fn results_are_data_in_every_time_step() {
    for made in samples() {
        let file = folder(&made, &made.bytes).read(made.name);
        assert_eq!(file.data_names(), ["z", "T", "p"]);
        let fields = file.point_fields(Some(&["p".to_owned()])).unwrap();
        assert_eq!(fields.len(), 2);
        assert!(fields.iter().all(|field| field.values()[4] == 4.0));
    }
}

fn refused(bytes: &[u8], parts: &[&str]) {
    let folder = Folder::new(&[]);
    fs::write(folder.path("in.exo"), bytes).unwrap();
    let error = MeshFile::read(&folder.path("in.exo")).unwrap_err().to_string();
    assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
}

fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|part| part == from).unwrap();
    [&bytes[..at], to, &bytes[at + from.len()..]].concat()
}

#[test]
fn files_that_are_no_exodus_mesh_are_refused_with_a_remedy() {
    refused(
        b"\x89HDF\r\n\x1a\n\0\0",
        &["in.exo, byte 0: the superblock of the HDF5 file is damaged"],
    );
    refused(b"CDF\x03\0\0\0\0", &["in.exo, byte 0: the version of netCDF is not known"]);
    let made = &samples()[2];
    assert!(made.bytes.starts_with(b"CDF\x02"));
    refused(
        &replaced(&made.bytes, b"num_nodes", b"num_points"[..9].into()),
        &["no mesh of Exodus II", "num_nodes", "or UGRID"],
    );
    refused(&replaced(&made.bytes, b"TRI3", b"TET4"), &["this a volume mesh"]);
    refused(&replaced(&made.bytes, b"TRI3", b"WORD"), &["elements of the type WORD", "TRI3"]);
    refused(&replaced(&made.bytes, b"coordy", b"coordw"), &["no coordinates in two or three axes"]);
    // The header has the offset of an array 24 bytes after the array's name. Here y gets the offset of x.
    let offset = |name: &[u8]| {
        let at = made.bytes.windows(name.len()).position(|part| part == name).unwrap();
        at + name.len() + 24
    };
    let (x, y) = (offset(b"coordx\0\0"), offset(b"coordy\0\0"));
    let mut bytes = made.bytes.clone();
    bytes.copy_within(x..x + 8, y);
    refused(&bytes, &["coordx and coordy overlap"]);
}
