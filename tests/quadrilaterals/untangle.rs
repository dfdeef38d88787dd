//! Untangling of quadrilaterals.

use gpu_smooth::{Mesh, Options, Topology, Untangle, topology};
use support::quadrilaterals::{mixed, perturbed, squares};

use crate::{corners, doubled_area, f, is_convex, run};

/// Returns the number of corners that are not convex.
fn concave(mesh: &Mesh, points: &[[f64; 2]]) -> usize {
    corners(mesh).into_iter().filter(|&corner| doubled_area(points, corner) <= 0.0).count()
}

#[test]
fn tangled_quadrilaterals_are_untangled() {
    for (lattice, most) in
        [(squares(10), 1.0), (squares(10), 4.0), (mixed(10), 1.0), (mixed(14), 6.0)]
    {
        let mesh = perturbed(&lattice, most);
        let untangled = Untangle::new(&mesh).run().unwrap();
        assert_eq!(untangled.bad_before, concave(&mesh, &mesh.points), "{most}");
        assert!(untangled.is_feasible() && is_convex(&mesh, &untangled.points), "{most}");
        let free = Topology::by_area(&mesh).unwrap().free().to_vec();
        let stays = |v: usize| free[v] || untangled.points[v] == mesh.points[v];
        assert!((0..free.len()).all(stays));
        let smoothed = run(&Mesh { points: untangled.points, ..mesh.clone() }, &Options::default());
        assert!(f(&mesh, &smoothed.points) < 1.5);
    }
}

/// All free vertices of a mesh without triangles counted as far outside of the mesh, and were moved to means of their neighbors.
#[test]
fn vertices_far_from_a_concave_corner_stay() {
    let mut mesh = squares(20);
    let vertex = 5 * 21 + 5;
    mesh.points[vertex] = [6.4, 6.3];
    let untangled = Untangle::new(&mesh).run().unwrap();
    assert!(untangled.is_feasible());
    let moved = (0..mesh.points.len()).filter(|&v| untangled.points[v] != mesh.points[v]);
    assert!(moved.clone().count() < 60, "{} vertices moved", moved.count());
}

#[test]
fn corners_of_fixed_vertices_that_are_not_convex_are_hopeless() {
    let mut mesh = squares(4);
    // The corner at the vertex 0 of the first quadrilateral has fixed vertices alone.
    mesh.points[0] = [1.2, 1.2];
    let untangled = Untangle::new(&mesh).run().unwrap();
    let corner = |bad: &topology::BadQuadrilateral| (bad.quadrilateral, bad.vertices[bad.corner]);
    assert_eq!(untangled.hopeless_quadrilaterals.iter().map(corner).collect::<Vec<_>>(), [(0, 0)]);
}
