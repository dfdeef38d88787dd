//! The numbers of a triangle in a Newton step: its Hessian, its target map, and forces on its corners.

use fearless_simd::prelude::*;

use super::scalar::{Scalar, narrowed};
use crate::metric::{Curvature, H, Real, TargetMap};
use crate::patch::lanes::Lanes;

/// The Hessian of a triangle: see [`Curvature`]. Lengths are in units of |C|, so that the numbers keep their digits for
/// triangles of any stretching.
#[derive(Clone, Copy, Default)]
pub(super) struct Terms<T> {
    pub(super) conformal: [T; 2],
    pub(super) anticonformal: [T; 2],
    pub(super) own: [T; 2],
    pub(super) mixed: [T; 3],
}

/// The target map of a triangle: a displacement p becomes s p + t p̄ in complex numbers, with real s.
#[derive(Clone, Copy)]
pub(super) struct Map<T> {
    pub(super) scale: T,
    pub(super) stretch: [T; 2],
}

impl Map<f64> {
    pub(super) fn of(map: &TargetMap<f64>) -> Self {
        let [xx, xy, yy] = map.0;
        Self { scale: 0.5 * (xx + yy), stretch: [0.5 * (xx - yy), xy] }
    }
}

impl<T: Scalar> Map<T> {
    /// Transforms the changes of C and D by a displacement to those of the transformed triangle: C' = s C + t D̄ and D' =
    /// s D + t C̄. The same map leads back from forces on C' and D' to forces on C and D.
    #[inline(always)]
    pub(super) fn apply(&self, c: [T; 2], d: [T; 2]) -> [[T; 2]; 2] {
        let Self { scale, stretch: [x, y] } = *self;
        [
            [scale * c[0] + x * d[0] + y * d[1], scale * c[1] + y * d[0] - x * d[1]],
            [scale * d[0] + x * c[0] + y * c[1], scale * d[1] + y * c[0] - x * c[1]],
        ]
    }

    pub(super) fn narrowed<U: Scalar>(&self) -> Map<U> {
        Map { scale: U::of(self.scale.wide()), stretch: self.stretch.map(|x| U::of(x.wide())) }
    }
}

impl<R: Real> Terms<R> {
    /// Returns the terms of a triangle with lengths in units of |C|.
    #[inline(always)]
    pub(super) fn of(curvature: &Curvature<R>) -> Self {
        let Curvature { conformal: c, anticonformal: d, own, mixed, .. } = *curvature;
        let square = c[0] * c[0] + c[1] * c[1];
        let by = square.constant(1.0) / square.sqrt();
        Self {
            conformal: [c[0] * by, c[1] * by],
            anticonformal: [d[0] * by, d[1] * by],
            own,
            mixed: [mixed[0] * square, mixed[1] * square, mixed[2] * square],
        }
    }
}

impl<S: Simd> Terms<Lanes<S>> {
    /// Returns the terms in one lane.
    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> Terms<f64> {
        let Self { conformal, anticonformal, own, mixed } = self;
        Terms {
            conformal: of_lane(conformal, lane),
            anticonformal: of_lane(anticonformal, lane),
            own: of_lane(own, lane),
            mixed: of_lane(mixed, lane),
        }
    }
}

impl Terms<f64> {
    #[inline(always)]
    pub(super) fn narrowed<T: Scalar>(self) -> Terms<T> {
        let Self { conformal, anticonformal, own, mixed } = self;
        Terms {
            conformal: narrowed(conformal),
            anticonformal: narrowed(anticonformal),
            own: narrowed(own),
            mixed: narrowed(mixed),
        }
    }
}

/// Returns the numbers in one lane.
#[inline(always)]
pub(super) fn of_lane<S: Simd, const N: usize>(four: &[Lanes<S>; N], lane: usize) -> [f64; N] {
    let mut found = [0.0; N];
    let mut k = 0;
    while k < N {
        found[k] = four[k][lane];
        k += 1;
    }
    found
}

/// Returns the forces on the three corners of a triangle, given those on C and D: F + G, w F + w̄ G and w̄ F + w G.
#[inline(always)]
pub(super) fn at_corners<R: Real>([c, d]: [[R; 2]; 2]) -> [[R; 2]; 3] {
    let sum = [c[0] + d[0], c[1] + d[1]];
    let turned = [(c[1] - d[1]) * -H, (c[0] - d[0]) * H];
    let half = [sum[0] * 0.5, sum[1] * 0.5];
    [
        sum,
        [turned[0] - half[0], turned[1] - half[1]],
        [turned[0] * -1.0 - half[0], turned[1] * -1.0 - half[1]],
    ]
}

/// Returns the sums over three rows of the products at corner `k`, as xx, xy, yy.
#[inline(always)]
pub(super) fn squares_at<R: Real>(rows: &[[[R; 2]; 3]; 3], k: usize) -> [R; 3] {
    let ([a, b], [c, d], [e, f]) = (rows[0][k], rows[1][k], rows[2][k]);
    [a * a + c * c + e * e, a * b + c * d + e * f, b * b + d * d + f * f]
}

/// Returns the forces on the vertices of a corner of a quadrilateral, given those on the vertices of its sheared triangle. The
/// third vertex of the triangle is p + (q - p)/2 + √3/2 (r - p) for the vertices p, q and r.
#[inline(always)]
pub(super) fn before_shear<T: Scalar>([p, q, r]: [[T; 2]; 3]) -> [[T; 2]; 3] {
    let (half, h, rest) = (T::of(0.5), T::of(H), T::of(0.5 - H));
    [
        [p[0] + rest * r[0], p[1] + rest * r[1]],
        [q[0] + half * r[0], q[1] + half * r[1]],
        [h * r[0], h * r[1]],
    ]
}

/// Returns the displacements of the vertices of the sheared triangle of a corner, given those of the corner's vertices.
#[inline(always)]
pub(super) fn sheared<T: Scalar>([p, q, r]: [[T; 2]; 3]) -> [[T; 2]; 3] {
    let (half, h, rest) = (T::of(0.5), T::of(H), T::of(0.5 - H));
    let third = [0, 1].map(|k| rest * p[k] + half * q[k] + h * r[k]);
    [p, q, third]
}
