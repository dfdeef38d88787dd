//! The bounds of a run, from its options: a disc around the given position of each free vertex, and a least altitude.

use crate::layout::{Bounds, Problem};
use crate::measure::mean_edges;
use crate::mesh::Mesh;
use crate::options::{Options, WorstBy};
use crate::plane::Storage;
use crate::topology::Topology;
use crate::whole::altitude::least_of;

/// Share by which the least altitude is raised, as a reserve for rounding in double precision.
const RESERVE: f64 = 1e-9;
/// Largest reserve for altitudes of rounded coordinates, as a share of the least altitude. Where coordinates are coarser,
/// vertices go back after the run.
const MAX_RESERVE: f64 = 0.01;
/// Share by which sweeps keep altitudes higher if the least altitude is improved after the sweeps. Many triangles at one
/// altitude could not be improved.
const ROOM: f64 = 0.02;

/// Returns the problem of a run with the bounds of its options, for positions as they are `stored`.
pub(crate) fn bounded(
    mut problem: Problem,
    mesh: &Mesh,
    topology: &Topology<'_>,
    options: &Options,
    stored: Storage<'_>,
) -> Problem {
    let (_, scale) = problem.normalization();
    let free = &problem.vertices()[..problem.free_count()];
    let radii = options.max_move.map(|most| {
        let all = radii(mesh, topology, most, stored);
        free.iter().map(|&v| all[v as usize] * scale).collect()
    });
    let least_altitude = if options.keep_altitude {
        limit_of_altitudes(&problem, mesh, options, stored)
    } else {
        0.0
    };
    problem.set_bounds(Bounds { radii, least_altitude });
    problem
}

/// Returns the largest distance of each vertex of the mesh from its start, in the unit of the mesh: `most` times the mean
/// edge length at the vertex, less a reserve for positions as they are `stored`.
pub(crate) fn radii(
    mesh: &Mesh,
    topology: &Topology<'_>,
    most: f64,
    stored: Storage<'_>,
) -> Vec<f64> {
    let edges = mean_edges(topology, &mesh.points);
    let bound = |([x, y], edge): (&[f64; 2], &f64)| {
        let (full, size) = (most * edge, x.abs().max(y.abs()));
        let rounding = 2.0 * stored.error(size);
        // Coordinates may become larger by the move, and so may their rounding errors. The share 1e-9 covers the
        // growth in double precision.
        let growth = 2.0 * stored.error(size + full) - rounding;
        let rounding = rounding + (growth - 1e-9 * full).max(0.0);
        (full * (1.0 - 1e-9) - rounding).max(0.0)
    };
    mesh.points.iter().zip(&edges).map(bound).collect()
}

/// Returns the limit of altitudes in sweeps, normalized: the least altitude, and a reserve for positions as they
/// are stored, or the room for improvement.
fn limit_of_altitudes(
    problem: &Problem,
    mesh: &Mesh,
    options: &Options,
    stored: Storage<'_>,
) -> f64 {
    let (least, (_, scale)) = (least_of(problem), problem.normalization());
    let size = mesh.points.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    // An altitude changes by the rounding of a vertex and of the edge on the other side.
    let rounding = 4.0 * stored.error(size) * scale;
    let reserve = match options.improve_worst {
        Some(WorstBy::Altitude) => ROOM * least,
        _ => rounding.min(MAX_RESERVE * least),
    };
    least * (1.0 + RESERVE) + reserve
}
