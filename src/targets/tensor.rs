//! Symmetric tensors of the plane, and functions of their eigenvalues.

/// A symmetric tensor of the plane, as xx, xy, yy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tensor(pub(crate) [f64; 3]);

impl Tensor {
    /// Returns the identity times `x`.
    pub(crate) fn isotropic(x: f64) -> Self {
        Self([x, 0.0, x])
    }

    /// Returns A Aᵀ, where the two arguments are the columns of A.
    pub(crate) fn of_columns([[ax, ay], [bx, by]]: [[f64; 2]; 2]) -> Self {
        Self([ax * ax + bx * bx, ax * ay + bx * by, ay * ay + by * by])
    }

    /// Returns whether the tensor is finite and positive definite.
    pub(crate) fn is_positive(self) -> bool {
        let [xx, xy, yy] = self.0;
        let [low, high] = self.eigenvalues();
        xx > 0.0 && yy > 0.0 && low > 0.0 && high.is_finite() && xy.is_finite()
    }

    /// Returns the smaller and the larger eigenvalue. The smaller eigenvalue of a positive definite tensor is computed
    /// without cancellation.
    pub(crate) fn eigenvalues(self) -> [f64; 2] {
        let [xx, xy, yy] = self.0;
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let radius = half.hypot(xy);
        let high = mean + radius;
        let low = match mean > 0.0 {
            // The determinant over the larger eigenvalue; products are divided first, as they may overflow.
            true => (xx / high) * yy - (xy / high) * xy,
            false => mean - radius,
        };
        [low, high]
    }

    /// Returns the tensor with equal eigenvectors, and with `of` applied to the eigenvalues.
    fn map(self, of: impl Fn(f64) -> f64) -> Self {
        let [xx, xy, yy] = self.0;
        let half = 0.5 * (xx - yy);
        let radius = half.hypot(xy);
        let [low, high] = self.eigenvalues().map(of);
        if radius == 0.0 {
            return Self::isotropic(high);
        }
        let (mean, spread) = (0.5 * (high + low), 0.5 * (high - low) / radius);
        Self([mean + spread * half, spread * xy, mean - spread * half])
    }

    /// Returns the square root of a positive definite tensor.
    pub(crate) fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Returns the logarithm of a positive definite tensor.
    pub(crate) fn ln(self) -> Self {
        self.map(f64::ln)
    }

    /// Returns the exponential of the tensor.
    pub(crate) fn exp(self) -> Self {
        self.map(f64::exp)
    }

    /// Returns the tensor D M D, where M is this tensor and D the diagonal matrix of the two factors.
    pub(crate) fn stretched(self, [x, y]: [f64; 2]) -> Self {
        let [xx, xy, yy] = self.0;
        Self([xx * x * x, xy * x * y, yy * y * y])
    }

    /// Returns the square of the tensor.
    pub(crate) fn squared(self) -> Self {
        let [xx, xy, yy] = self.0;
        Self::of_columns([[xx, xy], [xy, yy]])
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }

    pub(crate) fn times(self, factor: f64) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Tensor, b: Tensor) {
        // Small entries beside large ones are only as precise as the digits of the large entries allow.
        let size = b.0.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for (x, y) in a.0.into_iter().zip(b.0) {
            assert!((x - y).abs() < 1e-13 * size, "{a:?} {b:?}");
        }
    }

    #[test]
    fn the_root_is_the_exponential_of_half_the_logarithm() {
        for tensor in [[2.0, 0.0, 2.0], [4.0, 1.0, 0.5], [1.0, -3.0, 10.0], [1e-8, 0.0, 1e6]] {
            let tensor = Tensor(tensor);
            assert!(tensor.is_positive());
            near(tensor.ln().times(0.5).exp(), tensor.sqrt());
            near(tensor.ln().exp(), tensor);
            near(tensor.sqrt().squared(), tensor);
        }
        near(Tensor::isotropic(9.0).sqrt(), Tensor::isotropic(3.0));
    }

    #[test]
    fn a_tensor_with_a_zero_or_negative_eigenvalue_is_not_positive() {
        for tensor in [[1.0, 1.0, 1.0], [1.0, 2.0, 1.0], [-1.0, 0.0, -1.0], [1.0, 0.0, 0.0]] {
            assert!(!Tensor(tensor).is_positive(), "{tensor:?}");
        }
        assert!(!Tensor([f64::NAN, 0.0, 1.0]).is_positive());
        assert!(!Tensor([f64::INFINITY, 0.0, 1.0]).is_positive());
    }
}
