//! Acceleration of corrections by secant pairs: the scalars of the limited-memory BFGS method with two pairs.
//!
//! A secant pair consists of the move s of the free vertices from one correction to the next, and of the change y of
//! the gradient g of Σ q² meanwhile. From two pairs and the correction M⁻¹ of the coarser levels, the two-loop
//! recursion (Nocedal, Math. Comp. 35, 1980) computes a direction. The direction accounts for properties that the
//! levels do not represent: stretched triangles, and vertices with many neighbors.
//!
//! The direction is -(M⁻¹(g - Σ aᵢ yᵢ) + Σ cᵢ sᵢ). The functions here compute aᵢ and cᵢ from inner products, where pair
//! 0 is the newer one. `shaders/secants/sum_secants.wgsl` computes the same numbers on a device.

/// Smallest change of the slope along a pair's step, relative to the slope before, with which the pair is used. A
/// smaller change is rounding.
pub(crate) const MIN_CURVATURE: f64 = 1e-3;

/// Inner products of two secant pairs and the gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Products {
    /// s·g for each pair.
    pub(crate) along: [f64; 2],
    /// s·y for each pair; 0 for an unused pair.
    pub(crate) curvature: [f64; 2],
    /// s of the older pair times y of the newer pair.
    pub(crate) across: f64,
}

impl Products {
    /// Creates the products of two pairs. If the new pair fails the test of [`MIN_CURVATURE`], its curvature is set
    /// to 0. The curvature of the old pair is 0 if the pair does not exist or is unused.
    pub(crate) fn new(along: [f64; 2], curvature: [f64; 2], across: f64) -> Self {
        let [new, old] = curvature;
        let slope_before = along[0] - new;
        let counts = new > MIN_CURVATURE * slope_before.abs() && new.is_finite();
        Self { along, curvature: [if counts { new } else { 0.0 }, old], across }
    }

    /// Returns the factors aᵢ on yᵢ in the vector to which the levels are applied.
    pub(crate) fn before(&self) -> [f64; 2] {
        let newer = share(self.along[0], self.curvature[0]);
        let older = share(self.along[1] - newer * self.across, self.curvature[1]);
        [newer, older]
    }

    /// Returns the factors cᵢ on sᵢ in the direction. `before` has the aᵢ, and `corrected` the inner products of each
    /// yᵢ with the result of the levels.
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

/// Returns a product divided by a curvature; 0 for an unused pair.
fn share(product: f64, curvature: f64) -> f64 {
    if curvature == 0.0 { 0.0 } else { product / curvature }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// Returns the direction by the two-loop recursion with the identity as M⁻¹.
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
        // The secant equation: if the gradient is y of the newer pair, the direction is -s.
        let pairs = [([1.0, 0.2, -0.3], [2.0, 0.1, -0.5]), ([0.1, 1.0, 0.4], [0.3, 1.5, 0.2])];
        let found = direction(pairs, pairs[0].1);
        for (found, s) in found.iter().zip(pairs[0].0) {
            assert!((found + s).abs() < 1e-14, "{found} and {s}");
        }
    }

    #[test]
    fn two_pairs_of_a_quadratic_in_the_plane_give_newtons_step() {
        // The Hessian is diag(4, 9, 1), and no vertex moves along the third axis. Steps along two axes are conjugate.
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
