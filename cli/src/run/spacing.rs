//! The spacing at the walls of a mesh, before and after a run.

use gpu_smooth::Topology;
use gpu_smooth::layers::Elements;

use crate::error::CliError;
use crate::load::{LoadedMesh, wall_edges, walls};
use crate::report::SpacingReport;

/// Number of flat distances from which walls are named, unless a report is requested. To name walls takes another pass over
/// the file.
const MANY: usize = 8;

/// Returns the spacing at each wall when vertices move to the points `after`. Without `is_reported`, the list is empty if
/// nearly no triangle at a wall is flat.
pub(super) fn at_walls(
    file: &LoadedMesh,
    topology: &Topology<'_>,
    after: &[[f64; 2]],
    is_reported: bool,
) -> Result<Vec<SpacingReport>, CliError> {
    let faces = file.domain.faces_beside_mesh(&file.source);
    let points = &file.mesh().points;
    let elements = Elements { topology, points, faces: &faces, lines: &[] };
    let edges = wall_edges(file, topology);
    if !is_reported {
        let whole = elements.spacing(std::slice::from_ref(&edges), after)?;
        if whole.iter().flatten().all(|whole| whole.flat < MANY) {
            return Ok(Vec::new());
        }
    }
    let walls = walls(file, &edges)?;
    let (names, edges): (Vec<String>, Vec<_>) =
        walls.into_iter().map(|wall| (wall.name, wall.edges)).unzip();
    let spacing = elements.spacing(&edges, after)?;
    let reports = names.into_iter().zip(spacing);
    Ok(reports.filter_map(|(name, one)| Some(SpacingReport::new(name, &one?))).collect())
}
