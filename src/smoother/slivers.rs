//! Meshes on the sphere with slivers that the Mercator projection would invert.

use std::ops::ControlFlow;

use crate::layout::{Mercator, laid_out};
use crate::mesh::Mesh;
use crate::topology::Topology;
use crate::untangle::{Untangle, Untangling, feasible_means};

/// Number of untangling sweeps after which moves near the slivers have failed. Sweeps that succeed are fewer than 30.
const MOST_SWEEPS: u32 = 100;

/// Returns a mesh in longitude and latitude in which no triangle is inverted or flat, neither in coordinates nor in the
/// projection. The free vertices near slivers that the projection would invert are moved, and all other vertices keep
/// their coordinates. If the moves fail, all free vertices are near means of their neighbors. `None` if these positions
/// have an inverted or flat triangle too. A sliver without a free vertex leads to `None`.
pub(super) fn opened(mesh: &Mesh, topology: &Topology<'_>) -> Option<Mesh> {
    let (_, projected) = Mercator::with_slivers(mesh, topology);
    let near_slivers = || {
        let untangled = Untangle::new(&projected).observe(most_sweeps).run().ok()?;
        let is_feasible = untangled.is_feasible();
        is_feasible.then_some(untangled.points)
    };
    let near_means = || {
        let problem = laid_out(&projected, topology);
        let positions = feasible_means(&problem, problem.positions())?;
        Some(problem.denormalize(&projected, &positions))
    };
    let in_degrees = |images: Vec<[f64; 2]>| {
        let mut points = mesh.points.clone();
        for ((point, was), now) in points.iter_mut().zip(&projected.points).zip(images) {
            if now != *was {
                *point = Mercator::point(now);
            }
        }
        let opened = Mesh { points, ..mesh.clone() };
        // Images of straight edges in the projection are curved too.
        let is_valid = topology.bad_triangles(&opened.points).is_ok_and(|bad| bad.is_empty())
            && topology.bad_quadrilaterals(&opened.points).is_ok_and(|bad| bad.is_empty());
        (is_valid && Mercator::of(&opened, topology).is_some()).then_some(opened)
    };
    near_slivers().and_then(in_degrees).or_else(|| near_means().and_then(in_degrees))
}

/// Ends the untangling after [`MOST_SWEEPS`] sweeps.
fn most_sweeps(state: &Untangling) -> ControlFlow<()> {
    match state.sweep < MOST_SWEEPS {
        true => ControlFlow::Continue(()),
        false => ControlFlow::Break(()),
    }
}
