//! Bounds on the free vertices of a run, which every sweep and correction keeps.

/// Bounds on the positions of free vertices and on the altitudes of triangles, in coordinates of the mesh, at the scale of
/// normalized positions.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bounds {
    /// Radius of the disc around the given position of each free vertex, which the vertex may not leave. `None` for no
    /// discs.
    pub(crate) radii: Option<Vec<f64>>,
    /// Lower limit of altitudes: no triangle may become lower than both the limit and its altitude before. 0 for no
    /// limit.
    pub(crate) least_altitude: f64,
}
