//! The energy that untangling lowers: the inverse mean ratio with a regularized area, finite for inverted triangles.
//!
//! For a triangle with the sum of squared lengths S and the signed area A, which should have the area T, it is
//! s / χ(ε, d) with s = S / (4√3 T) and d = A / T. χ(ε, d) = (d + √(ε² + d²)) / 2 goes to max(d, 0) as ε goes to 0: a
//! barrier that rises at the area 0 while triangles beyond it still feel where it is.
//!
//! Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, *Foldover-free maps in 50 lines of code*, ACM Transactions on
//! Graphics 40 (2021), equations 2 to 5, with the shape term alone.

use glam::DVec2;

use crate::metric::descent;

/// S of an equilateral triangle in units of its area.
const IDEAL: f64 = 4.0 * 1.732_050_807_568_877_2;

/// The smallest eigenvalue of a Hessian that is left, as a share of the largest.
const EIGENVALUE_FLOOR: f64 = 1e-3;

/// χ(ε, d) and √(ε² + d²), without cancellation.
#[inline]
fn regularized(epsilon: f64, d: f64) -> (f64, f64) {
    let root = (epsilon * epsilon + d * d).sqrt();
    let chi = if d > 0.0 { 0.5 * (d + root) } else { 0.5 * epsilon * epsilon / (root - d) };
    (chi, root)
}

/// A triangle seen from one of its corners.
#[derive(Clone, Copy)]
pub(crate) struct Corner {
    /// The edges from the corner to the two others, counter-clockwise unless the triangle is inverted.
    pub(crate) edges: [DVec2; 2],
    /// The area T that the triangle should have.
    pub(crate) target: f64,
}

impl Corner {
    /// d, the signed area in units of the target.
    #[inline]
    pub(crate) fn area(&self) -> f64 {
        let [a, b] = self.edges;
        0.5 * a.perp_dot(b) / self.target
    }

    /// s, the sum of the squared lengths in units of what it is for an equilateral triangle of the target area.
    #[inline]
    fn squares(&self) -> f64 {
        let [a, b] = self.edges;
        let sum = a.length_squared() + b.length_squared() + a.distance_squared(b);
        sum / (IDEAL * self.target)
    }

    /// The energy of the triangle.
    #[inline]
    pub(crate) fn energy(&self, epsilon: f64) -> f64 {
        self.squares() / regularized(epsilon, self.area()).0
    }

    /// The energy with its derivatives by the corner's position.
    #[inline]
    pub(crate) fn expansion(&self, epsilon: f64) -> Expansion {
        let [a, b] = self.edges;
        let (chi, root) = regularized(epsilon, self.area());
        let s = self.squares();
        let unit = 1.0 / (IDEAL * self.target);
        let (ds, ss) = ((a + b) * (-2.0 * unit), 4.0 * unit);
        let dd = (b - a).perp() * (0.5 / self.target);
        // The derivatives of 1/χ by d.
        let inverse = 1.0 / chi;
        let first = -inverse / root;
        let bend = 0.5 * epsilon * epsilon / (root * root * root);
        let second = 2.0 * inverse / (root * root) - bend * inverse * inverse;
        Expansion {
            value: s * inverse,
            gradient: ds * inverse + dd * (s * first),
            hessian: [
                ss * inverse + 2.0 * first * ds.x * dd.x + s * second * dd.x * dd.x,
                first * (ds.x * dd.y + ds.y * dd.x) + s * second * dd.x * dd.y,
                ss * inverse + 2.0 * first * ds.y * dd.y + s * second * dd.y * dd.y,
            ],
        }
    }
}

/// An energy with its gradient and Hessian (xx, xy, yy) by the position of a vertex.
#[derive(Clone, Copy, Default)]
pub(crate) struct Expansion {
    pub(crate) value: f64,
    pub(crate) gradient: DVec2,
    pub(crate) hessian: [f64; 3],
}

impl Expansion {
    /// Adds the energy of another triangle at the same vertex.
    #[inline]
    pub(crate) fn add(&mut self, other: &Self) {
        self.value += other.value;
        self.gradient += other.gradient;
        for (sum, more) in self.hessian.iter_mut().zip(other.hessian) {
            *sum += more;
        }
    }

    /// The Newton direction, with eigenvalues made positive. Zero or not finite where there is none.
    pub(crate) fn descent(&self) -> DVec2 {
        descent(self.gradient, self.hessian, EIGENVALUE_FLOOR)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(at: DVec2) -> Corner {
        let [p, q] = [DVec2::new(1.0, 0.25), DVec2::new(0.5, 1.0)];
        Corner { edges: [p - at, q - at], target: 0.4 }
    }

    #[test]
    fn an_equilateral_triangle_of_the_target_area_has_energy_one() {
        let b = DVec2::new(0.5, 0.75f64.sqrt());
        let corner = Corner { edges: [DVec2::X, b], target: 0.75f64.sqrt() / 2.0 };
        assert!((corner.energy(0.0) - 1.0).abs() < 1e-15);
        assert!((corner.area() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn derivatives_are_those_of_the_energy() {
        // At a good triangle, at a flat one, and at inverted ones.
        for at in [[0.0, 0.0], [0.75, 0.625], [1.5, 1.5], [4.0, 3.0]].map(DVec2::from) {
            for epsilon in [1e-2, 0.3, 2.0] {
                let found = corner(at).expansion(epsilon);
                let energy = |d: [f64; 2]| corner(at + DVec2::from(d)).energy(epsilon);
                let gradient =
                    |d: [f64; 2]| corner(at + DVec2::from(d)).expansion(epsilon).gradient;
                let h = 1e-6;
                let close = |found: f64, expected: f64, scale: f64| {
                    assert!(
                        (found - expected).abs() < 1e-5 * scale,
                        "{found} for {expected} at {at}, {epsilon}"
                    );
                };
                assert!((found.value / energy([0.0, 0.0]) - 1.0).abs() < 1e-14);
                let scale = found.gradient.length() + found.value;
                close(found.gradient.x, (energy([h, 0.0]) - energy([-h, 0.0])) / (2.0 * h), scale);
                close(found.gradient.y, (energy([0.0, h]) - energy([0.0, -h])) / (2.0 * h), scale);
                let x = (gradient([h, 0.0]) - gradient([-h, 0.0])) / (2.0 * h);
                let y = (gradient([0.0, h]) - gradient([0.0, -h])) / (2.0 * h);
                let scale = found.hessian.iter().map(|x| x.abs()).sum();
                close(found.hessian[0], x.x, scale);
                close(found.hessian[1], x.y, scale);
                close(found.hessian[2], y.y, scale);
            }
        }
    }

    #[test]
    fn the_direction_descends_wherever_the_energy_has_a_slope() {
        for at in [[0.0, 0.0], [0.75, 0.625], [1.5, 1.5], [4.0, 3.0], [0.9, 0.1]].map(DVec2::from) {
            let found = corner(at).expansion(0.1);
            assert!(found.descent().dot(found.gradient) < 0.0);
        }
        assert_eq!(
            Expansion { hessian: [1.0, 0.0, 1.0], ..Expansion::default() }.descent(),
            DVec2::ZERO
        );
    }
}
