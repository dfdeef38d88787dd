//! Vertices that a file holds, and that are elsewhere in the points to write.

use gpu_smooth::Topology;
use gpu_smooth::options::Precision;
use mesh_io::{MeshFile, ReadError};

use crate::domain::{Domain, SlideBy};
use crate::options::Settings;

/// Returns the first vertex that has moved in `points` although a run keeps it: a vertex on the boundary, on a line, between
/// regions, or anchored by the file. If vertices slide by `settings`, those on the boundary, on lines and between regions may have
/// moved, apart from the ends of groups. If lines are free by `settings`, their vertices may have moved. Vertices of
/// quadrilaterals may have moved as those of triangles. `stored` is the precision to which `points` are rounded. Boundary
/// vertices of a mesh without a [`Topology`] are not compared. `None` if no such vertex has moved, or if `points` does not have
/// one entry per vertex.
///
/// # Errors
/// [`ReadError`] if vertices slide and the groups of the file cannot be read.
pub fn moved_fixed_vertex(
    file: &MeshFile,
    points: &[[f64; 2]],
    stored: Precision,
    settings: &Settings,
) -> Result<Option<u32>, ReadError> {
    let before = file.points();
    let has_moved = |v: usize| before[v].map(|x| stored.rounded(x)) != points[v];
    if points.len() != before.len() || !(0..before.len()).any(has_moved) {
        return Ok(None);
    }
    let mut domain = Domain::of_elements(file);
    if settings.frees_lines {
        domain.free_lines();
    }
    let mut is_fixed = vec![false; before.len()];
    domain.mesh().fixed.iter().for_each(|&v| is_fixed[v as usize] = true);
    if let Ok(topology) = Topology::new(domain.mesh()) {
        is_fixed.iter_mut().zip(topology.free()).for_each(|(is_fixed, free)| *is_fixed |= !free);
        if settings.slides {
            let by = SlideBy { ends: file.group_ends()?, ..SlideBy::default() };
            let slide = domain.curves(before, &topology, &by).slide;
            // Groups may end at free vertices, if lines are free.
            let held: Vec<u32> = slide.held.into_iter().filter(|&v| is_fixed[v as usize]).collect();
            slide.lines.as_flattened().iter().for_each(|&v| is_fixed[v as usize] = false);
            held.iter().for_each(|&v| is_fixed[v as usize] = true);
        }
    }
    let first = (0..before.len()).find(|&v| is_fixed[v] && has_moved(v));
    Ok(first.map(|v| v as u32))
}
