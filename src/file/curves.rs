//! The lines along which vertices of a mesh file may slide, and the vertices that do not slide.

use crate::periodic::{Motion, Periodic};

/// Lines of a file, and vertices that are fixed for other reasons than lying on a line.
#[derive(Default)]
pub(crate) struct Curves {
    /// Line elements, segments and parts of polylines.
    pub(crate) lines: Vec<[u32; 2]>,
    /// Points, corners, vertices of quadrilaterals and polygons, and those that the user fixed. They do not slide.
    pub(crate) held: Vec<u32>,
    /// Vertices that belong together in pairs.
    pub(crate) periodic: Vec<Periodic>,
    /// Motions that take vertices of the boundary to others, without a list of the pairs.
    pub(crate) motions: Vec<Motion>,
    /// Whether there are pairs of vertices that could not be read.
    pub(crate) has_unknown_pairs: bool,
}

/// Returns the edges between triangles of different regions, ascending.
pub(crate) fn between_regions(
    regions: &[u32],
    triangles: &[[u32; 3]],
    vertices: usize,
) -> Vec<[u32; 2]> {
    // Most vertices lie in one region, and on none of these edges.
    let mut region = vec![None; vertices];
    let mut is_between = vec![false; vertices];
    for (corners, &own) in triangles.iter().zip(regions) {
        for &v in corners {
            is_between[v as usize] |= *region[v as usize].get_or_insert(own) != own;
        }
    }
    let mut edges = Vec::new();
    for (&[a, b, c], &own) in triangles.iter().zip(regions) {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if is_between[from as usize] && is_between[to as usize] {
                edges.push(([from.min(to), from.max(to)], own));
            }
        }
    }
    edges.sort_unstable();
    edges.dedup();
    let twice = edges.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    let mut between: Vec<[u32; 2]> = twice.map(|pair| pair[0].0).collect();
    between.dedup();
    between
}
