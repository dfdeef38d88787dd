//! Detection of crossings between edges that cannot move.

use gpu_smooth::{Mesh, MeshError, Topology, topology::Crossing};
use support::SplitMix64;

fn found(mesh: &Mesh, most: usize) -> Vec<Crossing> {
    Topology::by_area(mesh).unwrap().crossings(&mesh.points, most).unwrap()
}

/// Makes a square of five by five vertices, numbered by rows, with a diagonal in each cell.
fn square() -> Mesh {
    let points = (0..25).map(|k| [f64::from(k % 5), f64::from(k / 5)]).collect();
    let cells = (0..20u32).filter(|k| k % 5 < 4);
    let triangles = cells.flat_map(|k| [[k, k + 1, k + 6], [k, k + 6, k + 5]]).collect();
    Mesh { points, triangles, ..Mesh::default() }
}

#[test]
fn a_boundary_vertex_beyond_the_other_side_crosses_it() {
    let mut mesh = square();
    assert!(found(&mesh, 10).is_empty());
    // The middle vertex of the lower side passes through the upper side.
    mesh.points[2] = [1.5, 9.0];
    let expected = [[[1, 2], [21, 22]], [[2, 3], [22, 23]]];
    assert_eq!(found(&mesh, 10), expected.map(|edges| Crossing { edges }));
    assert_eq!(found(&mesh, 1).len(), 1);
    // Along the other axis.
    mesh.points.iter_mut().for_each(|p| p.swap(0, 1));
    assert_eq!(found(&mesh, 10), expected.map(|edges| Crossing { edges }));
}

#[test]
fn free_vertices_and_edges_that_touch_do_not_cross() {
    let mut mesh = square();
    mesh.points[12] = [40.0, 7.0];
    assert!(found(&mesh, 10).is_empty());
    // Onto the upper side: between two vertices, and onto a vertex.
    for place in [[1.5, 4.0], [2.0, 4.0]] {
        let mut mesh = square();
        mesh.points[2] = place;
        assert!(found(&mesh, 10).is_empty(), "{place:?}");
    }
    // A fixed inner vertex contributes only edges to other vertices that are not free.
    let mut mesh = square();
    mesh.fixed = vec![6];
    mesh.points[6] = [1.5, 9.0];
    // The edge from 15 to 21 cuts a corner.
    let expected = [
        [[0, 6], [15, 21]],
        [[0, 6], [20, 21]],
        [[1, 6], [21, 22]],
        [[5, 6], [15, 21]],
        [[5, 6], [20, 21]],
    ];
    assert_eq!(found(&mesh, 100), expected.map(|edges| Crossing { edges }));
}

#[test]
fn pairs_are_those_of_a_search_through_all() {
    let mut random = SplitMix64::new(3);
    for _ in 0..20 {
        let mut mesh = support::lattice(7, 4);
        let held = support::check::held(&mesh);
        for (p, _) in mesh.points.iter_mut().zip(&held).filter(|(_, held)| **held) {
            *p = [random.unit(), random.unit()];
        }
        let topology = Topology::by_area(&mesh).unwrap();
        let ends = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        let mut edges: Vec<[u32; 2]> = mesh
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .filter(|edge| edge.iter().all(|&v| !topology.free()[v as usize]))
            .map(ends)
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let area = |a: u32, b: u32, c: u32| {
            let [a, b, c] = [a, b, c].map(|v| mesh.points[v as usize]);
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        let mut expected = Vec::new();
        for (i, &one) in edges.iter().enumerate() {
            for &other in
                edges[i + 1..].iter().filter(|other| !one.iter().any(|v| other.contains(v)))
            {
                let parts =
                    |[a, b]: [u32; 2], [c, d]: [u32; 2]| area(a, b, c) * area(a, b, d) < 0.0;
                if parts(one, other) && parts(other, one) {
                    expected.push(Crossing { edges: [one, other] });
                }
            }
        }
        assert!(expected.len() > 10);
        assert_eq!(found(&mesh, usize::MAX), expected);
    }
}

#[test]
fn there_must_be_a_point_for_each_vertex() {
    let mesh = square();
    let topology = Topology::new(&mesh).unwrap();
    let result = topology.crossings(&mesh.points[1..], 10);
    assert!(matches!(result, Err(MeshError::PointCount { .. })), "{result:?}");
}
