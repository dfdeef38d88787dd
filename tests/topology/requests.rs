//! Invalid requests of an application are answered with an error, not a panic.

use gpu_smooth::{
    Element, Mesh, MeshError, Quality, Smoother, Topology,
    internal::Coloring,
    topology::{certify, infeasible},
};

#[test]
fn lists_of_points_that_are_too_short_or_too_long_are_errors() {
    let mesh = support::lattice(4, 4);
    let topology = Topology::new(&mesh).unwrap();
    let smoother = Smoother::new(&mesh).unwrap();
    let expected = mesh.points.len();
    for given in [0, 1, expected - 1, expected + 1] {
        let mut points = mesh.points.clone();
        points.resize(given, [0.0; 2]);
        let error = MeshError::PointCount { expected, given };
        assert_eq!(Quality::of(&points, &topology), Err(error.clone()));
        assert_eq!(Quality::of(&points, smoother.topology()), Err(error.clone()));
        assert_eq!(smoother.certify(&mut points), Err(error.clone()));
        assert_eq!(certify(&topology, &mesh.points, &mut points), Err(error.clone()));
        assert_eq!(certify(&topology, &points, &mut mesh.points.clone()), Err(error.clone()));
        assert_eq!(topology.check_smoothable(&points), Err(error.clone()));
        assert_eq!(topology.bad_triangles(&points), Err(error.clone()));
        assert_eq!(topology.move_clamped(&mut points, &[], 8.0), Err(error.clone()));
        let text = format!("{given} points are given for the {expected} vertices of the mesh");
        assert_eq!(error.to_string(), text);
    }
}

#[test]
fn triangles_of_vertices_that_do_not_exist_are_an_error() {
    let error = infeasible(&[[0.0, 0.0], [1.0, 0.0]], &[[0, 1, 2]]);
    let expected =
        MeshError::IndexOutOfRange { element: Some(Element::Triangle(0)), vertex: 2, vertices: 2 };
    assert_eq!(error, Err(expected));
    assert_eq!(infeasible(&[], &[]), Ok(vec![]));
}

#[test]
fn vertices_that_do_not_exist_have_no_star_and_no_ring() {
    let mesh = support::lattice(4, 4);
    let topology = Topology::new(&mesh).unwrap();
    for vertex in [mesh.points.len() as u32, u32::MAX] {
        assert!(topology.star(vertex).is_empty() && topology.ring(vertex).is_empty());
    }
}

#[test]
fn a_coloring_of_another_mesh_is_not_proper() {
    let [small, large] = [support::lattice(4, 4), support::lattice(6, 6)];
    let [small, large] = [&small, &large].map(|mesh| Topology::new(mesh).unwrap());
    for (of, by) in [(&small, &large), (&large, &small)] {
        assert!(Coloring::new(of).is_proper(of) && !Coloring::new(of).is_proper(by));
    }
}

#[test]
fn a_bound_or_a_point_that_is_no_number_is_an_error() {
    let mesh = support::lattice(4, 4);
    let topology = Topology::new(&mesh).unwrap();
    let middle = topology.free().iter().position(|&free| free).unwrap() as u32;
    let to = mesh.points[middle as usize].map(|x| x + 0.1);
    let mut points = mesh.points.clone();
    let error = topology.move_clamped(&mut points, &[(middle, to)], f64::NAN);
    assert_eq!(error, Err(MeshError::BoundNotANumber));
    assert_eq!(points, mesh.points);
    let neighbor = topology.ring(middle)[0];
    for wrong in [middle, neighbor] {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut points: Vec<[f64; 2]> = mesh.points.clone();
            points[wrong as usize][0] = bad;
            let before = points.clone();
            let error = topology.move_clamped(&mut points, &[(middle, to)], 8.0);
            assert_eq!(error, Err(MeshError::NotFinite { vertex: wrong }));
            let bits = |points: &[[f64; 2]]| {
                points.as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>()
            };
            assert_eq!(bits(&points), bits(&before));
        }
    }
    // A triangle far from the moved vertices does not hinder them.
    let mut points = mesh.points.clone();
    let far = Mesh::clone(&mesh).triangles[31].into_iter().max().unwrap();
    assert!(!topology.ring(middle).contains(&far));
    points[far as usize][0] = f64::NAN;
    assert!(topology.move_clamped(&mut points, &[(middle, to)], 8.0).is_ok());
}
