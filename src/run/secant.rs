//! Corrections that remember: the scalars of the limited-memory BFGS method with two secant pairs.
//!
//! A secant pair is how far the free vertices moved from one correction to the next, s, and how the gradient g of Σ q²
//! changed by it, y. From two pairs and a correction M⁻¹ by the coarser levels, the two-loop recursion (Nocedal, Math.
//! Comp. 35, 1980) makes a direction that also knows what the levels do not: stretched triangles, and vertices of many.
//!
//! The direction is -(M⁻¹(g - Σ aᵢ yᵢ) + Σ cᵢ sᵢ). The functions here give aᵢ and cᵢ from inner products, pair 0 being the
//! newer. `shaders/levels/sum_secants.wgsl` states them again for a device.

/// A pair counts only if the slope along its step changed by at least this share of what it was: a smaller change is rounding.
pub(crate) const LEAST_CURVATURE: f64 = 1e-3;

/// Inner products of two secant pairs and the gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Products {
    /// s·g of each pair.
    pub(crate) along: [f64; 2],
    /// s·y of each pair; 0 stands for a pair that does not count.
    pub(crate) curvature: [f64; 2],
    /// s of the older pair times y of the newer.
    pub(crate) across: f64,
}

impl Products {
    /// The products of a new pair, with its curvature set to 0 if the pair does not count. The old pair is there if its
    /// curvature is not 0.
    pub(crate) fn new(along: [f64; 2], curvature: [f64; 2], across: f64) -> Self {
        let [new, old] = curvature;
        let slope_before = along[0] - new;
        let counts = new > LEAST_CURVATURE * slope_before.abs() && new.is_finite();
        Self { along, curvature: [if counts { new } else { 0.0 }, old], across }
    }

    /// The factors aᵢ of y in the vector that the levels are given.
    pub(crate) fn before(&self) -> [f64; 2] {
        let newer = share(self.along[0], self.curvature[0]);
        let older = share(self.along[1] - newer * self.across, self.curvature[1]);
        [newer, older]
    }

    /// The factors cᵢ of s in the direction, given the aᵢ and the products of y of each pair with what the levels make of
    /// their vector.
    pub(crate) fn after(&self, before: [f64; 2], corrected: [f64; 2]) -> [f64; 2] {
        let older = match self.curvature[1] {
            0.0 => 0.0,
            curvature => before[1] - corrected[1] / curvature,
        };
        let newer = match self.curvature[0] {
            0.0 => 0.0,
            curvature => before[0] - (corrected[0] + older * self.across) / curvature,
        };
        [newer, older]
    }
}

/// A product over a curvature, 0 if the pair does not count.
fn share(product: f64, curvature: f64) -> f64 {
    if curvature == 0.0 { 0.0 } else { product / curvature }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// The two-loop recursion with the identity for the levels, as the functions here do it.
    fn direction(pairs: [([f64; 3], [f64; 3]); 2], g: [f64; 3]) -> [f64; 3] {
        let [(s0, y0), (s1, y1)] = pairs;
        let products =
            Products::new([dot(s0, g), dot(s1, g)], [dot(s0, y0), dot(s1, y1)], dot(s1, y0));
        let a = products.before();
        let q: [f64; 3] = std::array::from_fn(|i| g[i] - a[0] * y0[i] - a[1] * y1[i]);
        let c = products.after(a, [dot(y0, q), dot(y1, q)]);
        std::array::from_fn(|i| -(q[i] + c[0] * s0[i] + c[1] * s1[i]))
    }

    #[test]
    fn the_newer_pair_is_reproduced() {
        // The secant equation: where the gradient is y of the newer pair, the direction is -s.
        let pairs = [([1.0, 0.2, -0.3], [2.0, 0.1, -0.5]), ([0.1, 1.0, 0.4], [0.3, 1.5, 0.2])];
        let found = direction(pairs, pairs[0].1);
        for (found, s) in found.iter().zip(pairs[0].0) {
            assert!((found + s).abs() < 1e-14, "{found} and {s}");
        }
    }

    #[test]
    fn two_pairs_of_a_quadratic_in_the_plane_give_newtons_step() {
        // The Hessian is diag(4, 9, 1), and the third axis is not touched. The two steps are conjugate, as the axes are.
        let pairs = [([1.0, 0.0, 0.0], [4.0, 0.0, 0.0]), ([0.0, 1.0, 0.0], [0.0, 9.0, 0.0])];
        assert_eq!(direction(pairs, [8.0, -18.0, 5.0]), [-2.0, 2.0, -5.0]);
    }

    #[test]
    fn a_pair_without_curvature_does_not_count() {
        let pair = ([1.0, 0.0, 0.0], [-4.0, 0.0, 0.0]);
        let nothing = ([0.0; 3], [0.0; 3]);
        assert_eq!(direction([pair, nothing], [8.0, -18.0, 5.0]), [-8.0, 18.0, -5.0]);
        let products = Products::new([1.0, 0.0], [f64::NAN, 0.0], 0.0);
        assert_eq!(products.curvature, [0.0, 0.0]);
    }
}
