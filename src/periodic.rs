//! Vertices that belong together in pairs, as where a model is periodic.

/// A motion of the plane, a translation or a rotation: the rows of the matrix that takes (x, y, 1) to where a point goes.
pub type Motion = [[f64; 3]; 2];

/// Pairs of vertices of which one motion takes the first of each to the second.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Periodic {
    /// The pairs, in any order.
    pub pairs: Vec<[u32; 2]>,
    /// The motion, if it is known. If not, or if it is not that of most pairs, it is found from them.
    pub motion: Option<Motion>,
}
