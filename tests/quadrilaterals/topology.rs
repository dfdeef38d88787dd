//! The topology of meshes of quadrilaterals, and the refusal of bad ones.

use gpu_smooth::{Element, Mesh, MeshError, Smoother, Topology, topology};
use support::SplitMix64;
use support::quadrilaterals::{mixed, squares};

/// Brute force: a boundary edge belongs to a single element, and a free vertex to no boundary edge.
#[test]
fn boundary_and_free_vertices_are_those_of_the_edges() {
    let mut random = SplitMix64::new(3);
    for round in 0..40 {
        let mut mesh = mixed(7);
        let share = 0.5 * f64::from(round % 10) / 10.0;
        mesh.quadrilaterals.retain(|_| random.range(0.0, 1.0) > share);
        mesh.triangles.retain(|_| random.range(0.0, 1.0) > share);
        let mut uses = std::collections::HashMap::new();
        let sides = |vertices: &[u32]| {
            let next = vertices.iter().cycle().skip(1);
            vertices.iter().zip(next).map(|(&a, &b)| [a, b]).collect::<Vec<_>>()
        };
        let elements = mesh.triangles.iter().map(|t| &t[..]);
        let elements = elements.chain(mesh.quadrilaterals.iter().map(|q| &q[..]));
        let all: Vec<[u32; 2]> = elements.flat_map(sides).collect();
        for &[a, b] in &all {
            *uses.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
        }
        let mut expected: Vec<[u32; 2]> =
            all.iter().copied().filter(|&[a, b]| uses[&[a.min(b), a.max(b)]] == 1).collect();
        expected.sort_unstable();
        let topology = Topology::new(&mesh).unwrap();
        let mut found = topology.boundary_edges();
        found.sort_unstable();
        assert_eq!(found, expected);
        let free =
            |v: u32| all.iter().any(|edge| edge[0] == v) && !expected.as_flattened().contains(&v);
        for v in 0..mesh.points.len() as u32 {
            assert_eq!(topology.free()[v as usize], free(v), "vertex {v}");
        }
        let loops: usize = topology.boundary_loops().iter().map(Vec::len).sum();
        assert_eq!(loops, expected.len());
    }
}

#[test]
fn quadrilaterals_that_are_not_convex_are_refused_with_their_corners() {
    let mut mesh = squares(3);
    // The vertex is moved through the diagonal of the upper right quadrilateral around it.
    mesh.points[5] = [1.7, 1.6];
    let refused = Smoother::new(&mesh).unwrap_err();
    let MeshError::Infeasible { triangles, quadrilaterals } = &refused else { panic!("{refused}") };
    assert!(triangles.is_empty());
    let bad: Vec<_> =
        quadrilaterals.iter().map(|q| (q.quadrilateral, q.vertices[q.corner], q.flat)).collect();
    assert_eq!(bad, [(4, 5, false)]);
    assert_eq!(
        refused.to_string(),
        "1 corner of quadrilaterals is not convex: 4 (concave at vertex 5)"
    );
    mesh.points[5] = [1.5, 1.5];
    let flat = Smoother::new(&mesh).unwrap_err().to_string();
    assert!(flat.contains("4 (flat at vertex 5)"), "{flat}");
}

#[test]
fn a_vertex_between_two_elements_is_refused_as_a_doublet() {
    // The middle vertex is between two quadrilaterals alone.
    let points = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0]];
    let quadrilaterals = vec![[0, 1, 2, 4], [0, 4, 2, 3]];
    let mesh = Mesh { points, quadrilaterals, ..Mesh::default() };
    let expected = MeshError::Doublet {
        vertex: 4,
        elements: [Element::Quadrilateral(0), Element::Quadrilateral(1)],
    };
    assert_eq!(Topology::new(&mesh).unwrap_err(), expected);
    let mixed = Mesh { triangles: vec![[2, 3, 0]], quadrilaterals: vec![[0, 1, 2, 4]], ..mesh };
    assert!(Topology::new(&mixed).is_ok());
}

#[test]
fn errors_name_quadrilaterals() {
    let mesh = squares(3);
    let with = |quadrilateral| {
        let mut mesh = mesh.clone();
        mesh.quadrilaterals[2] = quadrilateral;
        Topology::new(&mesh).unwrap_err().to_string()
    };
    assert_eq!(with([0, 1, 99, 4]), "vertex 99 does not exist: the mesh has 16, counted from 0");
    assert_eq!(with([2, 3, 2, 6]), "quadrilateral 2 uses vertex 2 twice");
    let mut three = mesh.clone();
    three.quadrilaterals.extend([[0, 1, 5, 9], [0, 1, 5, 8]]);
    let error = Topology::new(&three).unwrap_err().to_string();
    assert!(error.ends_with("belongs to 3 quadrilaterals"), "{error}");
    three.triangles.push([0, 1, 10]);
    let error = Topology::new(&three).unwrap_err().to_string();
    assert!(error.ends_with("elements"), "{error}");
}

#[test]
fn vertices_of_elements_that_are_not_convex_are_set_back() {
    let mesh = squares(4);
    let topology = Topology::new(&mesh).unwrap();
    let mut points = mesh.points.clone();
    // The first vertex makes its quadrilaterals concave, the second leaves them convex.
    points[6] = [1.6, 1.6];
    points[18] = [3.2, 2.9];
    assert_eq!(topology::certify(&topology, &mesh.points, &mut points), Ok(1));
    assert_eq!((points[6], points[18]), ([1.0, 1.0], [3.2, 2.9]));
    // A drag ends before the corner becomes flat.
    let share =
        topology.move_clamped(&mut points, &[(6, [1.0 + 0.8, 1.0 + 0.8])], f64::INFINITY).unwrap();
    assert!((share - 0.625).abs() < 1e-6, "{share}");
    assert_eq!(topology.bad_quadrilaterals(&points), Ok(vec![]));
}
