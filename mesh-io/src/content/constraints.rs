//! Lines, points and periodic pairs of a mesh file: what the file says of vertices besides their coordinates and triangles.

/// An affine map of the plane, for a translation or a rotation: the rows of the matrix that takes (x, y, 1) to the moved
/// point.
pub type Affine = [[f64; 3]; 2];

/// Pairs of vertices of a periodic model. One motion takes the first vertex of each pair to the second.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PeriodicPairs {
    /// The pairs, in the order of the file.
    pub pairs: Vec<[u32; 2]>,
    /// The motion, if the file gives it.
    pub motion: Option<Affine>,
}

/// Elements other than triangles, and the geometry of a model that vertices lie on, as vertices of the mesh. A program that
/// moves vertices decides by these facts which vertices may move and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constraints {
    /// Vertices of points, lines, quadrilaterals and polygons, and vertices on points and curves of the model (gmsh 4).
    /// In any order, with repeats.
    pub vertices: Vec<u32>,
    /// Line elements, segments and parts of polylines.
    pub lines: Vec<[u32; 2]>,
    /// Vertices that belong to no line alone: points and corners of the model, vertices of quadrilaterals and polygons.
    /// In any order, with repeats.
    pub anchored: Vec<u32>,
    /// Vertices that belong together in a periodic model, from gmsh's `$Periodic`.
    pub periodic: Vec<PeriodicPairs>,
    /// Motions that take vertices of the boundary to others where the file does not list the pairs, from SU2's
    /// `NPERIODIC`.
    pub motions: Vec<Affine>,
    /// Whether the file says that its model is periodic, but the pairs could not be read. Any vertices of the boundary
    /// may then be pairs.
    pub has_unread_pairs: bool,
}

/// Returns the edges between triangles of different regions, ascending.
pub(crate) fn edges_between_regions(
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
