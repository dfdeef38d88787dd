//! The whole mesh of a file as [`MeshFile::content`](mesh_io::MeshFile::content) returns it.

use super::{ELE, Folder, GMSH22, NODE, POLY};
use mesh_io::CellKind::{self, Line, Point, Quadrilateral, Triangle};

/// Returns kind, number and vertex indices of each cell.
fn cells(content: &mesh_io::Content) -> Vec<(CellKind, u64, Vec<u32>)> {
    content.cells().map(|cell| (cell.kind, cell.id, cell.vertices.to_vec())).collect()
}

#[test]
fn a_file_of_gmsh_has_cells_of_all_kinds_groups_and_data() {
    let folder = Folder::new(&[("a.msh", GMSH22)]);
    let content = folder.read("a.msh").content().unwrap();
    assert_eq!(content.points()[4], [0.25, 0.5]);
    assert_eq!([content.z(0), content.z(5)], [5.0; 2]);
    assert_eq!(content.vertex_ids(), [900_000_000_000, 4, 3, 70, 5, 6]);
    let expected = [
        (Point, 1, vec![1]),
        (Line, 2, vec![0, 1]),
        (Triangle, 3, vec![0, 1, 4]),
        (Triangle, 4, vec![1, 2, 4]),
        (Triangle, 5, vec![2, 3, 4]),
        (Triangle, 6, vec![3, 0, 4]),
        (Quadrilateral, 7, vec![1, 5, 5, 2]),
    ];
    assert_eq!(cells(&content), expected);
    // The fourth triangle has a third tag, which is no group.
    let fourth = content.cells().nth(3).unwrap();
    let groups: Vec<_> =
        fourth.groups().map(|group| (group.kind(), group.dimension(), group.tag())).collect();
    assert_eq!(groups, [("entity", 2, Some(1))]);
    let [data] = content.point_data() else { panic!("{} data", content.point_data().len()) };
    assert_eq!((data.name(), data.components(), data.is_real()), ("T", 1, true));
    assert_eq!(data.values()[4], 0.25);
    assert!(data.values()[0].is_nan());
    assert!(content.cell_data().is_empty());
}

#[test]
fn a_mesh_of_triangle_has_attributes_markers_and_segments() {
    let folder = Folder::new(&[("a.node", NODE), ("a.ele", ELE), ("a.poly", POLY)]);
    let content = folder.read("a.node").content().unwrap();
    let expected = [
        (Triangle, 1, vec![0, 1, 4]),
        (Triangle, 2, vec![1, 2, 4]),
        (Triangle, 3, vec![2, 3, 4]),
        (Triangle, 4, vec![3, 0, 4]),
        (Line, 1, vec![0, 1]),
        (Line, 2, vec![1, 4]),
    ];
    assert_eq!(cells(&content), expected);
    let groups: Vec<Vec<_>> = content
        .cells()
        .map(|cell| cell.groups().map(|group| (group.kind(), group.tag())).collect())
        .collect();
    assert_eq!(groups[..4].concat(), [9, 9, 9, 8].map(|tag| ("attribute", Some(tag))));
    assert_eq!(groups[4..].concat(), [("marker", Some(1)); 2]);
    let of_vertices: Vec<_> = content
        .vertex_groups()
        .map(|(group, vertices)| (group.kind(), group.tag(), vertices.to_vec()))
        .collect();
    assert_eq!(of_vertices, [("marker", Some(1), vec![0, 1, 2, 3])]);
    let [data] = content.point_data() else { panic!("{} data", content.point_data().len()) };
    assert_eq!((data.name(), data.values()), ("attribute", &[7.5; 5][..]));
}

/// A damaged header may announce as many attributes as the file has bytes. Comparing their names in pairs would take
/// minutes.
#[test]
fn a_wrong_number_of_attributes_does_not_hold_up_reading() {
    let node = NODE.replace("5 2 1 1", "5 2 4000000000 0") + &"# padding\n".repeat(11_000);
    let folder = Folder::new(&[("a.node", &node), ("a.ele", ELE)]);
    let file = folder.read("a.node");
    assert_eq!(file.points().len(), 5);
    assert!(file.data_names().len() > 100_000);
    let error = file.point_array("none").err().unwrap().to_string();
    assert!(error.contains("no point data is called 'none'"), "{}", &error[..200]);
}

/// Triangle's `.ele` may have several attributes per triangle. Groups and content include every attribute.
#[test]
fn each_attribute_of_triangles_is_a_kind_of_group() {
    let ele = "4 3 3\n1 1 2 5 9 0.5 a\n2 2 3 5 9 0.5 a\n3 3 4 5 9 1.5 b\n4 4 1 5 8 1.5 b";
    let folder = Folder::new(&[("a.node", NODE), ("a.ele", ele)]);
    let file = folder.read("a.node");
    assert_eq!(file.regions(), Some(&[0, 0, 1, 2][..]));
    let content = file.content().unwrap();
    let last = content.cells().last().unwrap();
    let groups: Vec<_> =
        last.groups().map(|group| (group.kind(), group.tag(), group.name())).collect();
    let expected = [
        ("attribute1", Some(8), None),
        ("attribute2", None, Some("1.5")),
        ("attribute3", None, Some("b")),
    ];
    assert_eq!(groups, expected);
    assert_eq!(
        file.groups().unwrap().iter().filter(|g| g.to_string().contains("attribute")).count(),
        6
    );
}

#[test]
fn other_faces_are_the_quadrilaterals_and_polygons_of_a_file() {
    let off = "OFF\n8 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n2 1 0\n3 0 0\n3 1 0\n3 0 1 2\n4 1 4 5 2\n3 0 2 3\n4 4 6 7 5\n";
    let vtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 7 float\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n3 1 0\n2 2 0\n\
               POLYGONS 3 14\n3 0 1 2\n3 0 2 3\n5 1 4 5 6 2\n";
    let folder = Folder::new(&[("a.off", off), ("a.vtk", vtk), ("a.msh", GMSH22)]);
    for (name, expected) in [
        ("a.off", vec![vec![1, 4, 5, 2], vec![4, 6, 7, 5]]),
        ("a.vtk", vec![vec![1, 4, 5, 6, 2]]),
        ("a.msh", vec![vec![1, 5, 5, 2]]),
    ] {
        let file = folder.read(name);
        let faces: Vec<Vec<u32>> = file.other_faces().map(<[u32]>::to_vec).collect();
        assert_eq!(faces, expected, "{name}");
        // The corners of these faces stay fixed.
        for corner in expected.concat() {
            assert!(file.constraints().vertices.contains(&corner), "{name}: {corner}");
            assert!(file.constraints().anchored.contains(&corner), "{name}: {corner}");
        }
    }
}
