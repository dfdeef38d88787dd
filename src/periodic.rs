//! Pairs of vertices that correspond to each other, as in a periodic model.

/// A motion of the plane, a translation or a rotation: the rows of the matrix that takes (x, y, 1) to the moved point.
pub type Motion = [[f64; 3]; 2];

/// Pairs of vertices. One motion takes the first vertex of each pair to the second.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Periodic {
    /// The pairs, in any order.
    pub pairs: Vec<[u32; 2]>,
    /// The motion, if it is known. If it is not, or if it does not fit most pairs, it is found from the pairs.
    pub motion: Option<Motion>,
}
