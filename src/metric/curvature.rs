//! The derivatives of a function of a triangle by its two invariants, in one form for all metrics, and the Hessian of a
//! triangle by displacements of its three corners.
//!
//! A triangle z0, z1, z2 has the conformal part C = z0 + w̄ z1 + w z2 and the anticonformal part D = z0 + w z1 + w̄ z2 in
//! complex numbers, with w = exp(2πi/3). Its excess is |D|²/√3, its doubled area (|C|² - |D|²)/(2√3). So both invariants,
//! and all derivatives, follow from C and D.

use crate::metric::corner::Corner;
use crate::metric::dual::Real;
use crate::metric::slopes::Derivatives;
use crate::metric::table::{AnyFormulas, Metric, OfInvariants};

/// √3/2, the imaginary part of w.
pub(crate) const H: f64 = 0.866_025_403_784_438_6;
/// 1/√3.
const W: f64 = 0.577_350_269_189_625_8;

/// A vector of the plane, or a complex number.
type Vector<T> = [T; 2];

/// Least divisor in place of zero, far below any quantity of a triangle in normalized units.
const TINY: f64 = 1e-150;

/// The second derivatives of q² of a triangle by displacements of its corners, as numbers of its parts C and D.
///
/// A displacement changes C by c and D by d. The Hessian is t_c |c|² + t_d |d|² + m_cc (C·c)² + 2 m_cd (C·c)(D·d) +
/// m_dd (D·d)².
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curvature<T = f64> {
    /// The conformal part C of the triangle.
    pub(crate) conformal: Vector<T>,
    /// The anticonformal part D of the triangle.
    pub(crate) anticonformal: Vector<T>,
    /// The factors t_c and t_d. The gradient of q² by C and D is t_c C and t_d D.
    pub(crate) own: [T; 2],
    /// The factors m_cc, m_cd and m_dd.
    pub(crate) mixed: [T; 3],
    /// Three rows (X, Y) such that the sum of the squares of X·c + Y·d is a positive semidefinite part of the Hessian:
    /// the Hessian without the second derivative of the area, which cancels between neighbors where the derivative by the
    /// area is equal. Where this part is indefinite, which convex functions of map and area exclude, the curvature along
    /// D is raised.
    pub(crate) rows: [[Vector<T>; 2]; 3],
}

impl<T: Real> Curvature<T> {
    #[inline(always)]
    fn of(corner: &Corner<T>, by: &Derivatives<T>) -> Self {
        let ([ax, ay], [bx, by_]) = (corner.a, corner.b);
        // w̄ a + w b and w a + w̄ b.
        let (middle, half) =
            ([(ax + bx) * -0.5, (ay + by_) * -0.5], [(ax - bx) * H, (ay - by_) * H]);
        let conformal = [middle[0] + half[1], middle[1] - half[0]];
        let anticonformal = [middle[0] - half[1], middle[1] + half[0]];
        let along = by.area * W;
        let own = [along, by.excess * (2.0 * W) - along];
        let third = by.area_area * (1.0 / 3.0);
        let cross = by.excess_area * (2.0 / 3.0);
        let mixed = [third, cross - third, by.excess_excess * (4.0 / 3.0) - cross * 2.0 + third];
        let rows = Self::rows(by, conformal, anticonformal);
        Self { conformal, anticonformal, own, mixed, rows }
    }

    /// Returns the rows of the positive semidefinite part. By the change of the area, a, and the change of |D|, r, the
    /// part is χ_AA a² + 2 χ_EA (2/√3) |D| a r + (2/√3 χ_E + 4/3 |D|² χ_EE) r², and 2/√3 χ_E t² with t the change of D
    /// across D.
    #[inline(always)]
    fn rows(by: &Derivatives<T>, c: Vector<T>, d: Vector<T>) -> [[Vector<T>; 2]; 3] {
        let zero = d[0].constant(0.0);
        // The direction of D, some direction if D is zero.
        let ahead = d[0] + TINY;
        let square = ahead * ahead + d[1] * d[1];
        let length = square.sqrt();
        let unit = [ahead / length, d[1] / length];
        let curvature = by.area_area.max(zero);
        let first = curvature.sqrt();
        let least = curvature.max(zero.constant(TINY));
        let second = length * by.excess_area * first / least * (2.0 * W);
        let along = by.excess * (2.0 * W);
        let rest = along + square * by.excess_excess * (4.0 / 3.0) - second * second;
        let (third, across) = (rest.max(zero).sqrt(), along.max(zero).sqrt());
        let area = first * W;
        [
            [
                [area * c[0], area * c[1]],
                [second * unit[0] - area * d[0], second * unit[1] - area * d[1]],
            ],
            [[zero; 2], [third * unit[0], third * unit[1]]],
            [[zero; 2], [zero - across * unit[1], across * unit[0]]],
        ]
    }
}

impl Curvature {
    /// Returns the second derivatives of q² times a weight.
    pub(crate) fn times(self, weight: f64) -> Self {
        let root = weight.sqrt();
        Self {
            own: self.own.map(|x| x * weight),
            mixed: self.mixed.map(|x| x * weight),
            rows: self.rows.map(|row| row.map(|part| part.map(|x| x * root))),
            ..self
        }
    }
}

/// A metric with Hessians of triangles by their corners.
pub(crate) trait Curved: Copy + Send + Sync {
    /// Returns the derivatives of q² of a triangle in the form of the metrics.
    fn curvature<T: Real>(self, corner: &Corner<T>) -> Curvature<T>;
}

impl Curved for OfInvariants {
    #[inline(always)]
    fn curvature<T: Real>(self, corner: &Corner<T>) -> Curvature<T> {
        Curvature::of(corner, &self.derivatives(&corner.invariants()))
    }
}

/// The metric [`Imr`](Metric::Imr), known at compile time.
#[derive(Clone, Copy)]
pub(crate) struct OfImr;

impl Curved for OfImr {
    #[inline(always)]
    fn curvature<T: Real>(self, corner: &Corner<T>) -> Curvature<T> {
        OfInvariants::Imr.curvature(corner)
    }
}

impl Metric {
    /// Returns the formulas of a metric with Hessians of triangles. `None` for EDGE and ACUTE, which are no functions of
    /// the invariants.
    pub(crate) fn curved(self) -> Option<OfInvariants> {
        match self.formulas() {
            AnyFormulas::Invariants(formulas) => Some(formulas),
            AnyFormulas::Edges(_) | AnyFormulas::Cotangents(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::{Formulas, Ideal};

    /// Displacements of the three corners of a triangle.
    type Move = [Vector<f64>; 3];

    fn corner(z: Move) -> Corner<f64> {
        let edge = |k: usize| [z[k][0] - z[0][0], z[k][1] - z[0][1]];
        Corner { a: edge(1), b: edge(2), ideal: Ideal { size_weight: 1.3, ..Ideal::of_area(0.7) } }
    }

    /// Returns the changes of C and D by a displacement.
    fn parts(p: Move) -> [Vector<f64>; 2] {
        let none = OfImr.curvature(&corner(p));
        let Curvature { conformal, anticonformal, .. } = none;
        [conformal, anticonformal]
    }

    fn dot(a: Vector<f64>, b: Vector<f64>) -> f64 {
        a[0] * b[0] + a[1] * b[1]
    }

    fn moved(z: Move, p: Move, by: f64) -> Move {
        std::array::from_fn(|k| [z[k][0] + by * p[k][0], z[k][1] + by * p[k][1]])
    }

    const TRIANGLES: [Move; 4] = [
        [[0.1, 0.2], [1.3, 0.1], [0.7, 1.2]],
        [[0.0, 0.0], [1.0, 0.0], [0.5, 0.1]],
        [[5.0, 2.0], [5.2, 2.0], [5.3, 4.0]],
        [[0.0, 0.0], [2.0, 0.0], [1.0, 1.732_050_8]],
    ];
    const MOVES: [Move; 3] = [
        [[0.3, -0.1], [0.2, 0.7], [-0.4, 0.5]],
        [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]],
        [[-0.2, 0.9], [0.1, 0.1], [0.6, -0.3]],
    ];

    #[test]
    fn gradient_and_hessian_of_a_triangle_are_differences_of_its_value() {
        for formulas in Metric::ALL.iter().filter_map(|metric| metric.curved()) {
            for (z, p) in TRIANGLES.iter().flat_map(|z| MOVES.iter().map(move |p| (*z, *p))) {
                let value = |by: f64| formulas.excess(&corner(moved(z, p, by)));
                let (short, here) = (1e-4, value(0.0));
                let slope = (value(short) - value(-short)) / (2.0 * short);
                let bend = (value(short) - 2.0 * here + value(-short)) / (short * short);
                let Curvature { conformal, anticonformal, own, mixed, .. } =
                    formulas.curvature(&corner(z));
                let [c, d] = parts(p);
                let (along_c, along_d) = (dot(conformal, c), dot(anticonformal, d));
                let gradient = own[0] * along_c + own[1] * along_d;
                let hessian = own[0] * dot(c, c)
                    + own[1] * dot(d, d)
                    + mixed[0] * along_c * along_c
                    + 2.0 * mixed[1] * along_c * along_d
                    + mixed[2] * along_d * along_d;
                let scale = gradient.abs() + hessian.abs() + 1.0;
                assert!(
                    (gradient - slope).abs() < 1e-5 * scale,
                    "{formulas:?}: {gradient} {slope}"
                );
                assert!((hessian - bend).abs() < 1e-4 * scale, "{formulas:?}: {hessian} {bend}");
            }
        }
    }

    /// The rows differ from the Hessian by the second derivative of the area alone, for metrics that are convex in map
    /// and area, and are never less.
    #[test]
    fn the_rows_are_the_hessian_without_the_second_derivative_of_the_area() {
        for metric in Metric::ALL.iter().filter(|metric| **metric != Metric::Area) {
            let Some(formulas) = metric.curved() else { continue };
            for (z, p) in TRIANGLES.iter().flat_map(|z| MOVES.iter().map(move |p| (*z, *p))) {
                let Curvature { conformal, anticonformal, own, mixed, rows } =
                    formulas.curvature(&corner(z));
                let [c, d] = parts(p);
                let (along_c, along_d) = (dot(conformal, c), dot(anticonformal, d));
                let wanted = (own[0] + own[1]) * dot(d, d)
                    + mixed[0] * along_c * along_c
                    + 2.0 * mixed[1] * along_c * along_d
                    + mixed[2] * along_d * along_d;
                let row = |[x, y]: &[Vector<f64>; 2]| (dot(*x, c) + dot(*y, d)).powi(2);
                let sum: f64 = rows.iter().map(row).sum();
                // D of a nearly ideal triangle keeps half of its digits.
                let scale = 1e-6 * sum.max(1.0);
                assert!(sum >= wanted - scale, "{metric:?}: {sum} {wanted}");
                if *metric != Metric::ShapeSize {
                    assert!(sum <= wanted + scale, "{metric:?}: {sum} {wanted}");
                }
            }
        }
    }
}
