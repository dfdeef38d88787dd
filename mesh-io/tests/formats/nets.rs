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
    let (units, types, centers) = (["m"; 2], &[], &[]);
    let precision = Precision::Double;
    Net { points, edges, is_old: false, units, types, centers, precision, version: 1, first: 1 }
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

/// Returns the circumcenter of a triangle by its barycentric coordinates. A circumcenter outside of the triangle moves to
/// the edge, on the line to the mean of the corners.
fn inner_circumcenter(corners: [[f64; 2]; 3]) -> [f64; 2] {
    let square = |k: usize| {
        let [a, b] = [corners[(k + 1) % 3], corners[(k + 2) % 3]];
        (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)
    };
    let weight = |k: usize| square(k) * (square((k + 1) % 3) + square((k + 2) % 3) - square(k));
    let sum: f64 = (0..3).map(weight).sum();
    let shares = [0, 1, 2].map(|k| weight(k) / sum);
    let least = shares.iter().copied().fold(f64::MAX, f64::min);
    let way = if least < 0.0 { 1.0 / (1.0 - 3.0 * least) } else { 1.0 };
    let at = |axis: usize| {
        let share = |k: usize| 1.0 / 3.0 + way * (shares[k] - 1.0 / 3.0);
        (0..3).map(|k| share(k) * corners[k][axis]).sum()
    };
    [at(0), at(1)]
}

/// The centers of the two squares are not those of any formula, and keep their values, as no vertex of a square moves.
#[test]
fn circumcenters_of_triangles_follow_the_vertices_beside_other_cells() {
    let folder = Folder::new(&[]);
    let triangles = read(&folder, &net(&POINTS, &EDGES)).triangles().to_vec();
    let centers = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let own = triangles.iter().map(|t| inner_circumcenter(t.map(|v| points[v as usize])));
        own.chain([[-7.0, 0.5], [9.0, 0.25]]).collect()
    };
    let mut to = POINTS;
    to[9] = [1.25, 0.75];
    let [before, after] = [centers(&POINTS), centers(&to)];
    let file = read(&folder, &Net { centers: &before, ..net(&POINTS, &EDGES) });
    let (fields, others) = file.centers(&to).unwrap();
    let axes = [0, 1].map(|axis| {
        let name = ["face_x", "face_y"][axis];
        (axis, fields.iter().find(|field| field.name() == name).unwrap())
    });
    assert!(others.is_empty(), "{others:?}");
    for (axis, field) in axes {
        for (value, expected) in field.values().iter().zip(&after) {
            assert!((value - expected[axis]).abs() < 1e-12, "{value} {expected:?}");
        }
    }
    let mut moved = POINTS;
    moved[4] = [2.1, 2.1];
    let names = file.centers(&moved).unwrap().1;
    assert_eq!(names, ["face_x", "face_y"], "a square has moved");
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
