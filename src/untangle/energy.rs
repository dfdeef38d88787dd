//! The energy that untangling lowers: the inverse mean ratio with a regularized area, finite for inverted triangles.
//!
//! The energy of a triangle is s / χ(ε, d), with s = S / (4√3 T) and d = A / T. S is the sum of the squared edge
//! lengths, A the signed area, and T the target area. χ(ε, d) = (d + √(ε² + d²)) / 2 goes to max(d, 0) as ε goes to 0.
//! A barrier then rises at the area 0, but triangles beyond the barrier still have a gradient toward positive areas.
//!
//! Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, *Foldover-free maps in 50 lines of code*, ACM Transactions on
//! Graphics 40 (2021), equations 2 to 5, with the shape term alone.

use glam::{DMat2, DVec2};

use crate::metric::{Dual, EdgeSlopes, Real};

/// S of an equilateral triangle of unit area.
const IDEAL: f64 = 4.0 * 1.732_050_807_568_877_2;

/// Returns χ(ε, d) and √(ε² + d²), without cancellation.
#[inline(always)]
fn regularized<T: Real>(epsilon: f64, d: T) -> (T, T) {
    let root = Real::sqrt(d * d + epsilon * epsilon);
    let rest = d.constant(0.5 * epsilon * epsilon) / (root + Real::max(d, d * -1.0));
    (Real::max(d, d.constant(0.0)) + rest, root)
}

/// A triangle as seen from a corner: two edges and the target area. With lanes as numbers, four triangles.
#[derive(Clone, Copy)]
pub(crate) struct Corner<T> {
    /// Edges from the corner to the other two vertices, counter-clockwise unless the triangle is inverted.
    pub(crate) edges: [[T; 2]; 2],
    /// 1 / T, the reciprocal of the target area of the triangle.
    pub(crate) inverse_target: T,
}

impl<T: Real> Corner<T> {
    /// Returns d, the signed area in units of the target area.
    #[inline(always)]
    pub(crate) fn area(&self) -> T {
        let [[ax, ay], [bx, by]] = self.edges;
        (ax * by - ay * bx) * 0.5 * self.inverse_target
    }

    /// Returns s, the sum of the squared edge lengths relative to an equilateral triangle of the target area.
    #[inline(always)]
    fn squares(&self) -> T {
        let [[ax, ay], [bx, by]] = self.edges;
        let (cx, cy) = (bx - ax, by - ay);
        let sum = (ax * ax + ay * ay) + (bx * bx + by * by) + (cx * cx + cy * cy);
        sum * self.inverse_target * (1.0 / IDEAL)
    }

    /// Returns the energy s / χ(ε, d) of the triangle.
    #[inline(always)]
    pub(crate) fn energy(&self, epsilon: f64) -> T {
        self.squares() / regularized(epsilon, self.area()).0
    }

    /// Returns the energy with its derivatives by the position of the visited vertex. `slopes` are the derivatives of
    /// the two edges by that position.
    #[inline(always)]
    pub(crate) fn expansion(&self, slopes: impl EdgeSlopes, epsilon: f64) -> Dual<T> {
        let [[ax, ay], [bx, by]] = self.edges;
        let (alpha, beta, third) = (slopes.alpha(), slopes.beta(), slopes.third());
        let (chi, root) = regularized(epsilon, self.area());
        let s = self.squares();
        let unit = self.inverse_target * (1.0 / IDEAL);
        // Half the gradient of the sum of squared lengths. If both edges have the slope α, α is a common factor.
        let (fx, fy, factor) = match third == 0.0 {
            true => (ax + bx, ay + by, 2.0 * alpha),
            false => (
                ax * alpha + bx * beta + (bx - ax) * third,
                ay * alpha + by * beta + (by - ay) * third,
                2.0,
            ),
        };
        let (sx, sy) = (fx * unit * factor, fy * unit * factor);
        let ss = unit * (2.0 * (alpha * alpha + beta * beta + third * third));
        let half = self.inverse_target * 0.5;
        let (dx, dy) = ((by * alpha - ay * beta) * half, (ax * beta - bx * alpha) * half);
        // First and second derivative of 1/χ by d.
        let one = chi.constant(1.0);
        let (inverse, inverse_root) = (one / chi, one / root);
        let first = inverse * inverse_root * -1.0;
        let bend = inverse_root * inverse_root * inverse_root * (0.5 * epsilon * epsilon);
        let second = inverse * inverse_root * inverse_root * 2.0 - bend * inverse * inverse;
        let (across, bent) = (s * first, s * second);
        let (mixed, own) = (dx * sy + dy * sx, ss * inverse);
        Dual {
            value: s * inverse,
            gradient: [sx * inverse + dx * across, sy * inverse + dy * across],
            hessian: [
                own + first * sx * dx * 2.0 + bent * dx * dx,
                first * mixed + bent * dx * dy,
                own + first * sy * dy * 2.0 + bent * dy * dy,
            ],
        }
    }
}

impl Corner<f64> {
    /// Returns the blocks of the convex part of the Hessian by the edges: first and first, first and second, second and second.
    /// [`Self::blocks`] returns the convex part by the vertices of a triangle.
    fn edge_blocks(&self, epsilon: f64) -> [DMat2; 3] {
        let [a, b] = self.edges.map(DVec2::from);
        let (chi, root) = regularized(epsilon, self.area());
        let unit = self.inverse_target * (2.0 / IDEAL);
        let of_squares = [2.0 * a - b, 2.0 * b - a].map(|slope| slope * unit);
        let of_area = [-b.perp(), a.perp()].map(|slope| slope * 0.5 * self.inverse_target);
        let (cross, square) = (-1.0 / (chi * root), 2.0 * self.squares() / (chi * root * root));
        let outer = |a: DVec2, b: DVec2| DMat2::from_cols(a * b.x, a * b.y);
        [(0, 0, 2.0), (0, 1, -1.0), (1, 1, 2.0)].map(|(i, k, weight)| {
            DMat2::from_diagonal(DVec2::splat(weight * unit / chi))
                + (outer(of_squares[i], of_area[k]) + outer(of_area[i], of_squares[k])) * cross
                + outer(of_area[i], of_area[k]) * square
        })
    }

    /// Returns blocks of the convex part of the Hessian. The rows belong to a vertex that changes the edges by the slopes `row`,
    /// and the columns of each block to a vertex with the slopes in `columns`.
    pub(crate) fn blocks_by<const N: usize>(
        &self,
        row: impl EdgeSlopes,
        columns: [impl EdgeSlopes; N],
        epsilon: f64,
    ) -> [DMat2; N] {
        let [first, mixed, second] = self.edge_blocks(epsilon);
        let back = mixed.transpose();
        columns.map(|column| {
            first * (row.alpha() * column.alpha())
                + mixed * (row.alpha() * column.beta())
                + back * (row.beta() * column.alpha())
                + second * (row.beta() * column.beta())
        })
    }

    /// Returns three blocks of the convex part of the Hessian. The rows of each block belong to the position of the
    /// corner. The columns belong to the corner, to the first other vertex and to the second other vertex, in this order.
    /// χ counts as linear in the area, and the area as linear in the positions. The energy is then a squared length over
    /// a linear function, and thus convex.
    pub(crate) fn blocks(&self, epsilon: f64) -> [DMat2; 3] {
        let [a, b] = self.edges.map(DVec2::from);
        let (chi, root) = regularized(epsilon, self.area());
        let unit = self.inverse_target * (2.0 / IDEAL);
        let of_squares = [-a - b, 2.0 * a - b, 2.0 * b - a].map(|slope| slope * unit);
        let [first, second] = [-b.perp(), a.perp()].map(|slope| slope * 0.5 * self.inverse_target);
        let of_area = [-first - second, first, second];
        // χ' = χ / √(ε² + d²).
        let (cross, square) = (-1.0 / (chi * root), 2.0 * self.squares() / (chi * root * root));
        let outer = |a: DVec2, b: DVec2| DMat2::from_cols(a * b.x, a * b.y);
        std::array::from_fn(|i| {
            let weight = if i == 0 { 2.0 } else { -1.0 };
            DMat2::from_diagonal(DVec2::splat(weight * unit / chi))
                + (outer(of_squares[0], of_area[i]) + outer(of_area[0], of_squares[i])) * cross
                + outer(of_area[0], of_area[i]) * square
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::{Given, Own};
    use crate::patch::{Direction, SearchRule, newton_direction};
    use glam::DVec2;

    fn corner(at: DVec2) -> Corner<f64> {
        let [p, q] = [DVec2::new(1.0, 0.25), DVec2::new(0.5, 1.0)];
        Corner { edges: [(p - at).to_array(), (q - at).to_array()], inverse_target: 2.5 }
    }

    #[test]
    fn an_equilateral_triangle_of_the_target_area_has_energy_one() {
        let height = 0.75f64.sqrt();
        let corner = Corner { edges: [[1.0, 0.0], [0.5, height]], inverse_target: 2.0 / height };
        assert!((corner.energy(0.0) - 1.0).abs() < 1e-15);
        assert!((corner.area() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn derivatives_are_those_of_the_energy() {
        // The visited vertex at a good triangle, at a flat triangle, and at inverted triangles.
        for at in [[0.0, 0.0], [0.75, 0.625], [1.5, 1.5], [4.0, 3.0]].map(DVec2::from) {
            for epsilon in [1e-2, 0.3, 2.0] {
                let found = corner(at).expansion(Own, epsilon);
                let energy = |d: [f64; 2]| corner(at + DVec2::from(d)).energy(epsilon);
                let gradient = |d: [f64; 2]| {
                    DVec2::from(corner(at + DVec2::from(d)).expansion(Own, epsilon).gradient)
                };
                let h = 1e-6;
                let close = |found: f64, expected: f64, scale: f64| {
                    assert!(
                        (found - expected).abs() < 1e-5 * scale,
                        "{found} for {expected} at {at}, {epsilon}"
                    );
                };
                assert!((found.value / energy([0.0, 0.0]) - 1.0).abs() < 1e-14);
                let [gx, gy] = found.gradient;
                let scale = gx.hypot(gy) + found.value;
                close(gx, (energy([h, 0.0]) - energy([-h, 0.0])) / (2.0 * h), scale);
                close(gy, (energy([0.0, h]) - energy([0.0, -h])) / (2.0 * h), scale);
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
    fn blocks_are_those_of_the_hessian_without_the_curvature_of_chi_and_the_area() {
        let at = DVec2::new(0.1, 0.2);
        let blocks = corner(at).blocks(1e-9);
        // The area is linear in the position of one vertex, and χ in a positive area.
        let [xx, xy, yy] = corner(at).expansion(Own, 1e-9).hessian;
        let expected = DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy));
        assert!(blocks[0].abs_diff_eq(expected, 1e-9 * xx), "{blocks:?}");
        for (at, epsilon) in [([0.1, 0.2], 1e-3), ([1.5, 1.5], 0.1), ([4.0, 3.0], 2.0)] {
            let blocks = corner(at.into()).blocks(epsilon);
            // Equal moves of all corners change no slope.
            let sum = blocks[0] + blocks[1] + blocks[2];
            assert!(sum.abs_diff_eq(DMat2::ZERO, 1e-9 * blocks[0].col(0).length()), "{sum}");
            let [x, y] = [blocks[0].col(0), blocks[0].col(1)];
            assert!(x.x > 0.0 && y.y > 0.0 && blocks[0].determinant() > 0.0);
        }
    }

    #[test]
    fn derivatives_by_any_slopes_are_those_of_dual_numbers() {
        let Corner { edges: [a, b], inverse_target } = corner(DVec2::new(0.1, 0.2));
        for slopes in [Given(-1.0, -1.0), Given(1.0, 0.0), Given(0.0, 1.0), Given(0.5, -1.5)] {
            let edge = |[x, y]: [f64; 2], slope: f64| {
                [Dual::variable(x, 0, slope), Dual::variable(y, 1, slope)]
            };
            let [a, b] = [edge(a, slopes.0), edge(b, slopes.1)];
            // The area is positive, and χ(0, d) = d without a maximum.
            let inverse_target = a[0].constant(inverse_target);
            let dual = Corner { edges: [a, b], inverse_target };
            let expected = dual.squares() / dual.area();
            let [a, b] = [a, b].map(|edge| edge.map(|x| x.value));
            let own = Corner { edges: [a, b], inverse_target: inverse_target.value };
            let found = own.expansion(slopes, 1e-12);
            let numbers = |d: &Dual| {
                let ([x, y], [xx, xy, yy]) = (d.gradient, d.hessian);
                [d.value, x, y, xx, xy, yy]
            };
            for (found, expected) in numbers(&found).iter().zip(numbers(&expected)) {
                let error = (found - expected).abs();
                assert!(error < 1e-10 * (1.0 + expected.abs()), "{slopes:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_direction_descends_wherever_the_energy_has_a_slope() {
        for at in [[0.0, 0.0], [0.75, 0.625], [1.5, 1.5], [4.0, 3.0], [0.9, 0.1]].map(DVec2::from) {
            let found = corner(at).expansion(Own, 0.1);
            let direction = newton_direction(&found, SearchRule::UNTANGLE.eigenvalue_floor);
            let Direction { vector, slope, descends } = direction;
            let expected = DVec2::from(vector).dot(found.gradient.into());
            assert!(descends && slope < 0.0 && (slope / expected - 1.0).abs() < 1e-12);
        }
        let flat = Dual { value: 1.0, gradient: [0.0; 2], hessian: [1.0, 0.0, 1.0] };
        assert!(!newton_direction(&flat, SearchRule::UNTANGLE.eigenvalue_floor).descends);
    }
}
