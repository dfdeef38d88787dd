//! The term of ACUTE that joins opposite angles of a quadrilateral. A quadrilateral whose opposite angles add up to 180
//! degrees has its vertices on a circle, so that its edges are orthogonal to the segments between circumcenters.

use crate::metric::angles;
use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};
use crate::metric::edge_slopes::{EdgeSlopes, Given};

/// Factor of the products of the cotangents of opposite angles in q² of a quadrilateral. With the squared cotangents at
/// its corners, the products form 100 (cot A + cot C)² + 100 (cot B + cot D)² for the angles A, B, C and D.
const WEIGHT: f64 = 200.0;

/// Returns the term of a quadrilateral, given the cotangents of its angles in order.
#[inline(always)]
pub(crate) fn of_cotangents<T: Real>([a, b, c, d]: [T; 4]) -> T {
    (a * c + b * d) * WEIGHT
}

/// Returns the cotangent of the angle at a corner of a quadrilateral, given the corner as [`Corner::of_right_angle`] returns it.
#[inline(always)]
pub(crate) fn cotangent<T: Real>(corner: &Corner<T>) -> T {
    let [cotangent, _, _] = corner.before_shear().cotangents();
    cotangent
}

/// Returns [`cotangent`] with its derivatives by the visited vertex. `edges` has
/// the slopes of the edges by the position of the vertex.
#[inline(always)]
pub(crate) fn cotangent_expansion<T: Real>(corner: &Corner<T>, edges: impl EdgeSlopes) -> Dual<T> {
    angles::cotangent(&corner.before_shear(), Given::before_shear(edges))
}
