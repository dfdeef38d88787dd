//! Version 4.0 of gmsh's format.

use super::{LINE, Made, POINT, PROBED, Text, fixing, number, region, regions, z};
use gpu_smooth::{Format, Mesh};

const VERTEX: usize = PROBED.0 as usize;
const TRIANGLE: usize = PROBED.1;

/// The tag of a vertex.
fn tag(vertex: u32) -> u32 {
    2 * vertex + 7
}

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    let mut text = Text::new("$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n2 ");
    text.count(mesh.points.len());
    // A vertex inside, on a point of the model; nodes of a surface with their parameters.
    text.put("\n-3 0 0 1\n");
    let row = |i: usize, end: &str| {
        let [x, y] = mesh.points[i];
        format!("{} {} {} {}{end}", tag(i as u32), number(i, x), number(i + 1, y), z(i))
    };
    let alone = POINT as usize;
    let mut order = vec![alone];
    let first = text.rows([row(alone, "")].into_iter().chain([String::from("1 2 1 29")]));
    assert_eq!(first.len(), 2);
    text.lists.clear();
    let others: Vec<_> = (0..mesh.points.len()).filter(|&i| i != alone).collect();
    let rows = text.rows(others.iter().map(|&i| row(i, " 0.5 0.25")));
    order.extend(&others);
    text.put("$EndNodes\n$Elements\n3 ");
    text.count(mesh.triangles.len() + 1);
    text.put(&format!("\n4 1 1 1\n500 {} {}\n", tag(LINE[0]), tag(LINE[1])));
    let halves = (0..mesh.triangles.len()).position(|t| region(t) != region(0)).unwrap();
    let triangle = |t: usize| {
        let [a, b, c] = mesh.triangles[t].map(tag);
        format!("{} {a} {b} {c} ", t + 1)
    };
    text.put(&format!("{} 2 2 {halves}\n", region(0)));
    let listed = text.rows((0..halves).map(triangle));
    text.put(&format!("{} 2 2 {}\n", region(halves), mesh.triangles.len() - halves));
    text.rows((halves..mesh.triangles.len()).map(triangle));
    text.put("$EndElements\n");

    // The vertices stand in the file in another order than in the mesh.
    // One that is in no list keeps its number.
    let position = |v: u32| order.iter().position(|&i| i == v as usize).map_or(v, |at| at as u32);
    let points = order.iter().map(|&i| mesh.points[i]).collect();
    let triangles = mesh.triangles.iter().map(|t| t.map(position)).collect();
    let ordered = Mesh { points, triangles, fixed: Vec::new() };
    let fixed = [POINT].into_iter().chain(LINE).map(position);
    let probed = order[VERTEX];
    let row_of = others.iter().position(|&i| i == probed).unwrap();
    let probes =
        [(u64::from(tag(probed as u32)), rows[row_of]), (TRIANGLE as u64 + 1, listed[TRIANGLE])];
    let mesh = fixing(&ordered, fixed);
    let made = text.made("version 4.0", "in.msh", Format::Gmsh40, mesh.clone(), probes);
    vec![Made { regions: regions(&mesh), ..made }]
}
