//! Pairs of corresponding vertices, as in a periodic model.

/// A motion of the plane, translation or rotation, as the rows of the matrix that maps (x, y, 1) to the moved point.
pub type Motion = [[f64; 3]; 2];

/// Pairs of vertices, related by a single motion that takes the first vertex of each pair to the second.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Periodic {
    /// The pairs, in any order.
    pub pairs: Vec<[u32; 2]>,
    /// The motion, if the caller knows it. `None`, or a motion that does not fit most pairs, is replaced by a motion
    /// computed from the pairs.
    pub motion: Option<Motion>,
}
