//! The lines and marked vertices of a mesh: boundary, edges between regions, held and slid vertices.

use gpu_smooth::Topology;

use crate::render::picture::faces::FixedFaces;

/// Lines and vertices that are drawn above triangles, by vertex index. All panels of a picture share them.
pub(crate) struct Outlines {
    /// Boundary edges, which belong to one triangle or one fixed face each.
    pub(crate) boundary: Vec<[u32; 2]>,
    /// Edges between elements of different regions.
    pub(crate) between_regions: Vec<[u32; 2]>,
    /// Fixed vertices inside the mesh that have not slid and are no corner of a fixed face, ascending.
    pub(crate) held: Vec<u32>,
    /// Vertices that slid along lines, ascending.
    pub(crate) slid: Vec<u32>,
}

impl Outlines {
    /// Collects the lines of a mesh from its fixed faces and vertices, the edges between regions, and its points before and
    /// after a run.
    pub(crate) fn of(
        topology: &Topology<'_>,
        faces: &FixedFaces,
        fixed: &[u32],
        between_regions: Vec<[u32; 2]>,
        [before, after]: [&[[f64; 2]]; 2],
    ) -> Self {
        let slid = slid(topology, before, after);
        let boundary = faces.boundary.clone();
        // Corners of fixed faces need no marks, as the faces are drawn.
        let mut is_outer = vec![false; topology.free().len()];
        let outer = boundary.as_flattened().iter().chain(faces.pieces.as_flattened());
        outer.for_each(|&v| is_outer[v as usize] = true);
        let mut held: Vec<u32> = fixed.iter().copied().filter(|&v| !is_outer[v as usize]).collect();
        held.sort_unstable();
        held.dedup();
        held.retain(|v| slid.binary_search(v).is_err());
        Self { boundary, between_regions, held, slid }
    }
}

/// Returns the vertices that moved although they are not free, ascending: vertices that slid along lines.
pub(crate) fn slid(topology: &Topology<'_>, before: &[[f64; 2]], after: &[[f64; 2]]) -> Vec<u32> {
    let states = before.iter().zip(after).zip(topology.free());
    let slid = states.map(|((was, is), is_free)| !is_free && was != is);
    (0..).zip(slid).filter(|(_, slid)| *slid).map(|(v, _)| v).collect()
}

/// Returns each edge inside a mesh once, together with one of its triangles. Some boundary edges are included.
pub(crate) fn inner_edges(triangles: &[[u32; 3]]) -> impl Iterator<Item = (usize, [u32; 2])> + '_ {
    let edges = |(t, &[a, b, c]): (usize, &[u32; 3])| [(t, [a, b]), (t, [b, c]), (t, [c, a])];
    // With consistent windings, an inner edge runs in opposite directions in its two triangles, so one has a < b.
    triangles.iter().enumerate().flat_map(edges).filter(|(_, [a, b])| a < b)
}
