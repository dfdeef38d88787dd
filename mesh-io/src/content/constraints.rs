//! Facts of a mesh file that constrain its vertices: lines, points, model geometry, periodic pairs and motions.

/// Affine map of the plane, for a translation or a rotation: the two rows of the matrix whose product with (x, y, 1) is
/// the moved point.
pub type Affine = [[f64; 3]; 2];

/// Pairs of vertices of a periodic model, with the motion that maps the first vertex of each pair to the second.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PeriodicPairs {
    /// First and second vertex of each pair as 0-based indices, in the order of the file.
    pub pairs: Vec<[u32; 2]>,
    /// Motion from first to second vertices; `None` if the file gives pairs alone.
    pub motion: Option<Affine>,
}

/// Vertices and edges on elements other than triangles and on the geometry of a model, and the periodicity of the mesh.
/// A program decides from these facts which vertices may move, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constraints {
    /// Vertices of points, lines, quadrilaterals and polygons, vertices on points and curves of the model (gmsh 4), and
    /// vertices of ghosts: elements and points that belong to another piece of a partitioned mesh. In any order, with
    /// repeats.
    pub vertices: Vec<u32>,
    /// Edges of line elements, segments and polylines, as pairs of vertices.
    pub lines: Vec<[u32; 2]>,
    /// Vertices constrained by more than lines: vertices of points, quadrilaterals and polygons, vertices on points of
    /// the model (gmsh 4), vertices of ghosts, vertices that several pieces of a VTK XML file have in common, and the
    /// listed vertex of a periodic pair whose other node is missing. In any order, with repeats.
    pub anchored: Vec<u32>,
    /// Periodic pairs from gmsh's `$Periodic` and from a CGNS zone that is connected to itself, in lists of pairs with a
    /// common motion.
    pub periodic: Vec<PeriodicPairs>,
    /// Pairs of vertices that face each other on the two banks of a weir of ADCIRC, in order along each weir. Models
    /// compute the flow over the weir between the vertices of a pair.
    pub weirs: Vec<Vec<[u32; 2]>>,
    /// Motions that map boundary vertices to their periodic partners where the file lists no pairs, from SU2's
    /// `NPERIODIC`, or from CGNS connectivities of faces.
    pub motions: Vec<Affine>,
    /// Whether the file declares a periodic model whose pairs could not be read. Any boundary vertex may then have a
    /// periodic partner.
    pub has_unread_pairs: bool,
}

/// Returns the edges between triangles of different regions, ascending, the smaller vertex of each edge first.
/// `regions` has the region of each triangle; a shorter list leaves further triangles out. `triangles` have vertices
/// below `vertices`, zero-based.
///
/// # Panics
/// Panics if a triangle has a vertex that is not below `vertices`.
pub fn edges_between_regions<R: Copy + Ord>(
    regions: &[R],
    triangles: &[[u32; 3]],
    vertices: usize,
) -> Vec<[u32; 2]> {
    // Marks the vertices at which regions meet. Most vertices stay unmarked, which leaves few edges to sort.
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
