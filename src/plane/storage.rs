//! Positions as they are stored.

use crate::plane::Plane;
use crate::precision::Precision;

/// The form in which the positions of a result are stored: as coordinates of a precision, or as vertices of a tilted plane by
/// their coordinates in space.
#[derive(Clone, Copy)]
pub(crate) struct Storage<'p> {
    precision: Precision,
    tilted: Option<&'p Plane>,
}

impl<'p> Storage<'p> {
    /// Returns the storage of vertices in a plane of space, or in the plane of x and y. `precision` is that of
    /// coordinates in the plane of two axes.
    pub(crate) fn new(precision: Precision, plane: Option<&'p Plane>) -> Self {
        Self { precision, tilted: plane.filter(|plane| plane.is_tilted()) }
    }

    /// Returns the stored position of vertex `v` of the mesh near `point`. A stored position is returned unchanged.
    pub(crate) fn rounded(self, v: usize, point: [f64; 2]) -> [f64; 2] {
        match self.tilted {
            Some(plane) => plane.settled(v, point),
            None => point.map(|x| self.precision.rounded(x)),
        }
    }

    /// Returns a bound on the rounding error of coordinates up to the absolute value `size`.
    pub(crate) fn error(self, size: f64) -> f64 {
        match self.tilted {
            Some(plane) => plane.rounding(),
            None => self.precision.error(size),
        }
    }

    /// Returns whether every position is stored without a rounding error.
    pub(crate) fn is_exact(self) -> bool {
        self.tilted.is_none() && matches!(self.precision, Precision::Double)
    }
}
