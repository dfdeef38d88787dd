//! Target maps: the wanted size, stretching and orientation of elements, as linear maps.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};

/// A target map: the symmetric positive definite matrix S, as xx, xy, yy, that transforms the element wanted at a point
/// into the ideal element, the equilateral triangle of mean area. A metric measures a triangle transformed by S, T = S
/// A W⁻¹. S is a target matrix of the target-matrix optimization paradigm (Knupp et al., SIAM J. Sci. Comp. 41, 2019),
/// and the square root of the tensor of metric-based mesh adaptation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TargetMap<T>(pub(crate) [T; 3]);

impl<T: Real> TargetMap<T> {
    /// Returns the map of a triangle, the mean of the maps at its three corners.
    #[inline(always)]
    pub(crate) fn mean([a, b, c]: [[T; 3]; 3]) -> Self {
        const THIRD: f64 = 1.0 / 3.0;
        Self([
            (a[0] + b[0] + c[0]) * THIRD,
            (a[1] + b[1] + c[1]) * THIRD,
            (a[2] + b[2] + c[2]) * THIRD,
        ])
    }

    /// Returns the inverse map.
    #[inline(always)]
    pub(crate) fn inverse(&self) -> Self {
        let [xx, xy, yy] = self.0;
        let one = xx.constant(1.0) / (xx * yy - xy * xy);
        Self([yy * one, xy * one * -1.0, xx * one])
    }

    /// Returns the map scaled to determinant 1, so that areas are kept.
    #[inline(always)]
    pub(crate) fn shape(&self) -> Self {
        let [xx, xy, yy] = self.0;
        let scale = xx.constant(1.0) / (xx * yy - xy * xy).sqrt();
        Self([xx * scale, xy * scale, yy * scale])
    }

    /// Returns a vector transformed by the map.
    #[inline(always)]
    pub(crate) fn apply(&self, [x, y]: [T; 2]) -> [T; 2] {
        let [xx, xy, yy] = self.0;
        [xx * x + xy * y, xy * x + yy * y]
    }

    /// Returns a triangle transformed by the map.
    #[inline(always)]
    pub(crate) fn transform(&self, corner: &Corner<T>) -> Corner<T> {
        let (a, b) = (self.apply(corner.a), self.apply(corner.b));
        Corner { a, b, ideal: corner.ideal }
    }

    /// Returns the derivatives by a vertex of the plane, S g and S H S, from the gradient g and the Hessian H by the
    /// transformed vertex.
    #[inline(always)]
    pub(crate) fn pull_back(&self, transformed: Dual<T>) -> Dual<T> {
        let [xx, xy, yy] = transformed.hessian;
        let (first, second) = (self.apply([xx, xy]), self.apply([xy, yy]));
        // The rows of H S are multiplied by S from the left.
        let [left, right] = [self.apply([first[0], second[0]]), self.apply([first[1], second[1]])];
        Dual {
            value: transformed.value,
            gradient: self.apply(transformed.gradient),
            hessian: [left[0], left[1], right[1]],
        }
    }
}
