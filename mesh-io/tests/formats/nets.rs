//! Nets of edges without faces: cells, notes, units, and files that are refused.

use super::Folder;
use super::facts::remarks;
use super::made::nets::Net;
use mesh_io::{Conversion, Format, MeshFile, Precision, Remark};
use std::fs;

/// Two squares side by side over a row of triangles. A triangle divides into three around vertex 9; vertex 10 is beside
/// the mesh.
const POINTS: [[f64; 2]; 11] = [
    [0.0, 0.0],
    [2.0, 0.0],
    [4.0, 0.0],
    [0.0, 2.0],
    [2.0, 2.0],
    [4.0, 2.0],
    [0.0, 4.0],
    [2.0, 4.0],
    [4.0, 4.0],
    [1.5, 0.5],
    [6.0, 4.0],
];
const EDGES: [[u32; 2]; 18] = [
    [0, 1],
    [2, 1],
    [3, 4],
    [4, 5],
    [6, 7],
    [8, 7],
    [0, 3],
    [3, 6],
    [1, 4],
    [4, 7],
    [2, 5],
    [5, 8],
    [0, 4],
    [2, 4],
    [0, 9],
    [9, 1],
    [9, 4],
    [8, 10],
];

fn net<'n>(points: &'n [[f64; 2]], edges: &'n [[u32; 2]]) -> Net<'n> {
    let (precision, types) = (Precision::Double, &[]);
    Net { points, edges, is_old: false, units: ["m"; 2], types, precision, version: 1, first: 1 }
}

fn read(folder: &Folder, net: &Net<'_>) -> MeshFile {
    folder.put("in.nc", net.build().bytes);
    folder.read("in.nc")
}

#[test]
fn cells_are_found_from_edges_in_either_kind_of_net() {
    let folder = Folder::new(&[]);
    for is_old in [false, true] {
        let file = read(&folder, &Net { is_old, types: &[2; 18], ..net(&POINTS, &EDGES) });
        assert_eq!(file.format(), Format::Ugrid);
        let triangles = [[0, 1, 9], [0, 4, 3], [0, 9, 4], [1, 2, 4], [1, 4, 9], [2, 5, 4]];
        let mut found = file.triangles().to_vec();
        found.sort_unstable();
        assert_eq!(found, triangles);
        let others: Vec<_> = file.other_faces().collect();
        assert_eq!(others, [[3, 4, 7, 6], [4, 5, 8, 7]]);
        assert_eq!(file.constraints().lines, [[8, 10]]);
        assert_eq!(
            remarks(&file),
            [
                "2 quadrilaterals",
                "1 edge at no cell",
                "cells were found from edges, as the file lists no faces, and an island of three to six edges counts as \
                 a cell"
            ]
        );
        assert_eq!(file.data_names(), ["NetNode_z"]);
        file.write(&folder.path("out.nc"), file.points()).unwrap();
        assert!(
            fs::read(folder.path("out.nc")).unwrap() == fs::read(folder.path("in.nc")).unwrap()
        );
    }
}

#[test]
fn an_island_among_triangles_is_counted_in_the_note() {
    let folder = Folder::new(&[]);
    // The second square gets a vertex in its middle, and the first one triangles at its free edges.
    let points = [&POINTS[..], &[[3.0, 3.0], [-1.0, 3.0], [1.0, 5.0]]].concat();
    let more = [[11, 4], [11, 5], [11, 8], [11, 7], [12, 3], [12, 6], [13, 6], [13, 7]];
    let edges = [&EDGES[..], &more].concat();
    let file = read(&folder, &net(&points, &edges));
    assert_eq!(file.remarks().last(), Some(&Remark::CellsOfEdges { islands: 1 }));
    let note = remarks(&file).pop().unwrap();
    assert!(note.ends_with(": 1 cell among triangles alone may be an island"), "{note}");
}

/// Link types 1, 3 and so on are of one-dimensional links, which cross cells.
#[test]
fn one_dimensional_links_bound_no_cell() {
    let folder = Folder::new(&[]);
    let edges = [&EDGES[..], &[[3, 7]]].concat();
    let mut types = vec![2; edges.len()];
    types[18] = 3;
    let file = read(&folder, &Net { is_old: true, types: &types, ..net(&POINTS, &edges) });
    assert_eq!((file.triangles().len(), file.other_faces().count()), (6, 2));
    assert_eq!(
        file.constraints().lines,
        [[8, 10], [7, 3]].map(|[a, b]: [u32; 2]| [a.min(b), a.max(b)])
    );
    let losses = Conversion::new(&file, Format::Vtu).unwrap().unwrap().losses().to_vec();
    assert_eq!(losses, ["variables of edges"]);
}

#[test]
fn middles_of_edges_follow_the_vertices() {
    let folder = Folder::new(&[]);
    let file = read(&folder, &net(&POINTS, &EDGES));
    let mut to = POINTS;
    to[9] = [1.25, 0.75];
    let (fields, others) = file.centers(&to).unwrap();
    assert_eq!((fields.len(), others.len()), (2, 0));
    file.write_with_fields(&folder.path("out.nc"), &to, &fields).unwrap();
    let expected = Net { points: &to, ..net(&POINTS, &EDGES) }.build().bytes;
    assert!(fs::read(folder.path("out.nc")).unwrap() == expected);
}

#[test]
fn units_of_coordinates_decide_whether_they_are_degrees() {
    let folder = Folder::new(&[]);
    for (units, says) in [
        (["m", "m"], Some(false)),
        (["degrees_east", "degrees_north"], Some(true)),
        (["radian", "radian"], Some(false)),
        (["", ""], None),
    ] {
        let file = read(&folder, &Net { units, ..net(&POINTS, &EDGES) });
        assert_eq!(file.says_degrees(), says, "{units:?}");
        assert_eq!(file.remarks().contains(&Remark::Degrees), says == Some(true));
    }
}

#[test]
fn edges_that_are_none_are_refused_by_number_and_place() {
    let folder = Folder::new(&[]);
    let mut edges = EDGES;
    edges[3][1] = 40;
    let built = net(&POINTS, &edges).build();
    let at = built.variable("net_edges").unwrap().start + 3 * 8;
    folder.put("in.nc", &built.bytes);
    let error = MeshFile::read(&folder.path("in.nc")).unwrap_err().to_string();
    let expected =
        format!("in.nc, byte {at}: edge 4 has node 41, which the list of nodes does not list");
    assert!(error.contains(&expected), "{error}");
}
