//! The quality metrics, one row each.
//!
//! A metric is one row of the table below and one file `shaders/metric/NAME.wgsl`; everything else
//! (command line, help, shader composition, property tests, GPU-against-f64 tests, benchmarks)
//! loops over [`Metric::ALL`].

use crate::metric::{Dual, Real};

/// A triangle as its metric sees it: the edge vectors from one vertex to the other two, in
/// counter-clockwise order, and what is constant over the mesh.
#[derive(Clone, Copy, Debug)]
pub struct Corner<T> {
    /// Edge vector to the next vertex, counter-clockwise.
    pub a: [T; 2],
    /// Edge vector to the vertex after that.
    pub b: [T; 2],
    /// Mean area of the mesh's triangles, in the square of the edges' unit.
    pub mean_area: f64,
}

impl<T: Real> Corner<T> {
    /// Squared lengths of the edges a, b and b - a.
    #[inline(always)]
    fn squared_lengths(&self) -> [T; 3] {
        let ([ax, ay], [bx, by]) = (self.a, self.b);
        let (cx, cy) = (bx - ax, by - ay);
        [ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy]
    }

    #[inline(always)]
    pub(crate) fn squared_length_sum(&self) -> T {
        let [a, b, c] = self.squared_lengths();
        a + b + c
    }

    /// Twice the signed area.
    #[inline(always)]
    pub fn doubled_area(&self) -> T {
        self.a[0] * self.b[1] - self.a[1] * self.b[0]
    }
}

/// How the parts of a metric change as the vertex moves that the edges start from.
impl<T: Real> Corner<T> {
    /// Gradient of the doubled area, which is linear.
    #[inline(always)]
    fn area_gradient(&self) -> [T; 2] {
        [self.a[1] - self.b[1], self.b[0] - self.a[0]]
    }

    /// Gradient of the sum of squared lengths; its Hessian is 4 times the identity.
    #[inline(always)]
    fn length_sum_gradient(&self) -> [T; 2] {
        [(self.a[0] + self.b[0]) * -2.0, (self.a[1] + self.b[1]) * -2.0]
    }

    /// Derivatives of n / (doubled area): from that quotient, one over the doubled area, ∇n, and a
    /// Hessian of n that is `curvature` times the identity.
    #[inline(always)]
    fn quotient(&self, value: T, inverse: T, gradient: [T; 2], curvature: f64) -> Dual<T> {
        let area = self.area_gradient();
        let dx = (gradient[0] - value * area[0]) * inverse;
        let dy = (gradient[1] - value * area[1]) * inverse;
        let [xx, xy, yy] = symmetric([dx, dy], area);
        let own = inverse * curvature;
        let hessian = [own - xx * inverse, xy * inverse * -1.0, own - yy * inverse];
        Dual { value, gradient: [dx, dy], hessian }
    }
}

/// xx, xy, yy of u vᵀ + v uᵀ.
#[inline(always)]
fn symmetric<T: Real>(u: [T; 2], v: [T; 2]) -> [T; 3] {
    [u[0] * v[0] * 2.0, u[0] * v[1] + u[1] * v[0], u[1] * v[1] * 2.0]
}

/// Constants of a metric: what is known about it, and how its Newton step is safeguarded.
#[derive(Clone, Copy, Debug)]
pub struct Properties {
    /// The name on the command line and of the WGSL file.
    pub name: &'static str,
    /// The formula, for people.
    pub formula: &'static str,
    /// Where the metric comes from.
    pub citation: &'static str,
    /// What it is good for and what it does to shapes.
    pub purpose: &'static str,
    /// Whether q grows to infinity as a triangle's area goes to zero.
    pub barrier: bool,
    /// q of an equilateral triangle of the mean area, the least value.
    pub ideal: f64,
    /// Whether q is the same for a similar triangle of another size.
    pub scale_invariant: bool,
    /// Whether the objective is quadratic in one vertex, so that one Newton step is exact and its
    /// decrease needs no test.
    pub quadratic: bool,
    /// Eigenvalues of the patch Hessian are raised to this share of the largest.
    pub eigenvalue_floor: f64,
    /// The shape guard: a step is refused if it leaves a triangle whose inverse mean ratio is above
    /// this and above the patch's worst before the step. Infinite where the barrier does that work.
    pub shape_guard: f64,
    /// The over-relaxation that suits it.
    pub omega: f64,
    /// The graph Laplacian that stands in for the objective's Hessian in a coarse correction, if one does.
    pub stiffness: Option<Stiffness>,
    /// The WGSL file's text.
    pub wgsl: &'static str,
}

/// The weight of an edge in the graph Laplacian that comes near the Hessian of Σ q² on a good mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness {
    /// This over the mean doubled area of the triangles around.
    BySize(f64),
    /// This over the mean doubled area of all triangles.
    Uniform(f64),
}

/// The block in brackets, or the expression after them if they are empty.
macro_rules! given_or {
    ([] $otherwise:expr) => {
        $otherwise
    };
    ([$given:block] $otherwise:expr) => {
        $given
    };
}

/// Generates the enum, the table and the formulas from one row per metric.
macro_rules! metrics {
    ($( $(#[$doc:meta])* $variant:ident = $name:literal {
        properties { $($field:ident: $value:expr,)* }
        excess($t:ident) $excess:block
        model($u:ident, $sharpness:ident) $model:block
        $( derivatives($w:ident, $power:ident) $derivatives:block )?
    } )*) => {
        /// A quality metric q of a triangle; smaller is better.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Metric { $( $(#[$doc])* $variant, )* }

        impl Metric {
            /// Every metric, in the order of the paper's Table 1.
            pub const ALL: &'static [Metric] = &[$(Metric::$variant),*];

            /// The metric's constants.
            pub const fn properties(self) -> &'static Properties {
                match self { $( Metric::$variant => &const { Properties {
                    name: $name,
                    wgsl: include_str!(concat!("../../shaders/metric/", $name, ".wgsl")),
                    $($field: $value),*
                } }, )* }
            }

            /// q² less its ideal value, so that sums of it keep their digits on good meshes.
            #[inline(always)]
            pub fn excess<T: Real>(self, corner: &Corner<T>) -> T {
                match self { $( Metric::$variant => { let $t = corner; $excess } )* }
            }

            /// What Newton minimizes in place of [`Self::excess`]: the same, but for EDGE, which is
            /// not smooth. There it is the p-norm with k = 2^`sharpness`.
            #[inline(always)]
            pub fn model<T: Real>(self, corner: &Corner<T>, sharpness: u32) -> T {
                match self { $( Metric::$variant => {
                    let ($u, $sharpness) = (corner, sharpness);
                    $model
                } )* }
            }
        }

        impl Metric {
            /// What [`Self::derivatives`] is, by the formulas in the metric's row where it has any:
            /// for the CPU engine, which has no time for dual numbers.
            #[inline(always)]
            pub fn expansion<T: Real>(self, corner: &Corner<T>, sharpness: u32) -> Dual<T> {
                match self { $( Metric::$variant => {
                    $( let ($w, $power) = (corner, sharpness); )?
                    given_or!([$($derivatives)?] self.derivatives(corner, sharpness))
                } )* }
            }
        }

        /// Evaluates an expression with `$m` bound to a constant of the metric, so that the
        /// compiler specializes the inner loops.
        macro_rules! specialize {
            ($metric:expr, $m:ident => $body:expr) => {
                match $metric { $( $crate::Metric::$variant => {
                    const $m: $crate::Metric = $crate::Metric::$variant;
                    $body
                } )* }
            };
        }
        pub(crate) use specialize;
    };
}

const SQRT_3: f64 = 1.732_050_807_568_877_2;

metrics! {
    /// Edge ratio Lmax/Lmin.
    Edge = "edge" {
        properties {
            formula: "Lmax / Lmin",
            citation: "Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comp. 23 (2001); Park & Shontz, Table 1 (printed there as its inverse)",
            purpose: "evens out edge lengths; knows no barrier, so flat triangles with three long edges are held off by the shape guard only",
            barrier: false,
            ideal: 1.0,
            scale_invariant: true,
            quadratic: false,
            eigenvalue_floor: 0.1,
            shape_guard: 30.0,
            omega: 1.5,
            stiffness: None,
        }
        excess(t) {
            let [a, b, c] = t.squared_lengths();
            let (least, most) = (a.min(b).min(c), a.max(b).max(c));
            (most - least) / least
        }
        model(t, sharpness) {
            // The p-norm of the edge pairs: (max/min) [mean A mean B]^(1/k) with A = (L/max)^k and
            // B = (min/L)^k, both from ratios below one. Scaling by max and min changes nothing,
            // so they may enter as constants.
            let [la, lb, lc] = t.squared_lengths();
            let most = la.max(lb).max(lc).fixed();
            let least = la.min(lb).min(lc).fixed();
            let (mut a0, mut a1, mut a2) = (la / most, lb / most, lc / most);
            let (mut b0, mut b1, mut b2) = (least / la, least / lb, least / lc);
            for _ in 0..sharpness {
                (a0, a1, a2) = (a0 * a0, a1 * a1, a2 * a2);
                (b0, b1, b2) = (b0 * b0, b1 * b1, b2 * b2);
            }
            let (a, b) = (a0 + a1 + a2, b0 + b1 + b2);
            let mut root = a * b * (1.0 / 9.0);
            for _ in 0..sharpness { root = root.sqrt(); }
            root * (most / least) - 1.0
        }
        derivatives(t, sharpness) {
            let [la, lb, lc] = t.squared_lengths();
            let (most, least) = (la.max(lb).max(lc), la.min(lb).min(lc));
            let one = la.constant(1.0);
            let (ia, ib, ic) = (one / la, one / lb, one / lc);
            let over = one / most;
            let (mut a0, mut a1, mut a2) = (la * over, lb * over, lc * over);
            let (mut b0, mut b1, mut b2) = (least * ia, least * ib, least * ic);
            for _ in 0..sharpness {
                (a0, a1, a2) = (a0 * a0, a1 * a1, a2 * a2);
                (b0, b1, b2) = (b0 * b0, b1 * b1, b2 * b2);
            }
            let (a, b) = (a0 + a1 + a2, b0 + b1 + b2);
            let mut root = a * b * (1.0 / 9.0);
            for _ in 0..sharpness { root = root.sqrt(); }
            let q = root * (most * (least.constant(1.0) / least));

            // Shares of the two edges that move in both sums, and u = ∇L/L of these edges.
            let shares = one / (a * b);
            let (wa, wb) = (b * shares, a * shares);
            let (wa0, wa1, wb0, wb1) = (a0 * wa, a1 * wa, b0 * wb, b1 * wb);
            let (ta, tb) = (ia * -2.0, ib * -2.0);
            let (u, v) = ([t.a[0] * ta, t.a[1] * ta], [t.b[0] * tb, t.b[1] * tb]);
            let mean_a = [u[0] * wa0 + v[0] * wa1, u[1] * wa0 + v[1] * wa1];
            let mean_b = [u[0] * wb0 + v[0] * wb1, u[1] * wb0 + v[1] * wb1];
            let (gx, gy) = (mean_a[0] - mean_b[0], mean_a[1] - mean_b[1]);
            // Hessian of the logarithm: the edges' own curvature, (2 - L u uᵀ)/L, and how their
            // shares shift, k times the spread of u over the edges.
            let k = f64::from(1u32 << sharpness);
            let (net_a, net_b) = (wa0 - wb0, wa1 - wb1);
            let (more_a, more_b) = ((wa0 + wb0) * k - net_a, (wa1 + wb1) * k - net_b);
            let own = (net_a * ia + net_b * ib) * 2.0;
            let xx = u[0] * u[0] * more_a + v[0] * v[0] * more_b
                - (mean_a[0] * mean_a[0] + mean_b[0] * mean_b[0]) * k;
            let xy = u[0] * u[1] * more_a + v[0] * v[1] * more_b
                - (mean_a[0] * mean_a[1] + mean_b[0] * mean_b[1]) * k;
            let yy = u[1] * u[1] * more_a + v[1] * v[1] * more_b
                - (mean_a[1] * mean_a[1] + mean_b[1] * mean_b[1]) * k;
            Dual {
                value: q - 1.0,
                gradient: [q * gx, q * gy],
                hessian: [q * (xx + own + gx * gx), q * (xy + gx * gy), q * (yy + own + gy * gy)],
            }
        }
    }

    /// Relative deviation of the area from the mean.
    Area = "area" {
        properties {
            formula: "|S - S_mean| / S_mean",
            citation: "Wang & Marek-Sadowska, DATE '03 (2003); Park & Shontz, Table 1, divided by the mean so that it has no dimension",
            purpose: "evens out areas and pays no attention to shape: angles of a few degrees are common, bounded by the shape guard only",
            barrier: false,
            ideal: 0.0,
            scale_invariant: false,
            quadratic: true,
            eigenvalue_floor: 1e-3,
            shape_guard: 30.0,
            omega: 1.9,
            stiffness: None,
        }
        excess(t) {
            let q = t.doubled_area() * (0.5 / t.mean_area) - 1.0;
            q * q
        }
        model(t, _sharpness) { Metric::Area.excess(t) }
        derivatives(t, _sharpness) {
            let scale = 0.5 / t.mean_area;
            let q = t.doubled_area() * scale - 1.0;
            let [x, y] = t.area_gradient();
            let dq = [x * scale, y * scale];
            let twice = q * 2.0;
            Dual { value: q * q, gradient: [twice * dq[0], twice * dq[1]], hessian: symmetric(dq, dq) }
        }
    }

    /// Root mean square of the edge lengths, over that of the equilateral triangle of mean area.
    Rms = "rms" {
        properties {
            formula: "sqrt((L12² + L23² + L13²) / 3) / L0, L0² = 4 S_mean / sqrt(3)",
            citation: "Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comp. 23 (2001); Park & Shontz, Table 1, divided by L0 so that it is 1 at best",
            purpose: "shortens edges: good shapes and evened-out sizes; each vertex moves to the mean of its neighbors (Laplacian smoothing that cannot invert)",
            barrier: false,
            ideal: 1.0,
            scale_invariant: false,
            quadratic: true,
            eigenvalue_floor: 1e-3,
            shape_guard: 1e3,
            omega: 1.9,
            stiffness: Some(Stiffness::Uniform(2.0 / SQRT_3)),
        }
        excess(t) {
            t.squared_length_sum() * (3f64.sqrt() / (12.0 * t.mean_area)) - 1.0
        }
        model(t, _sharpness) { Metric::Rms.excess(t) }
        derivatives(t, _sharpness) {
            let scale = 3f64.sqrt() / (12.0 * t.mean_area);
            let value = t.squared_length_sum() * scale - 1.0;
            let [x, y] = t.length_sum_gradient();
            let (constant, zero) = (value.constant(4.0 * scale), value.constant(0.0));
            Dual { value, gradient: [x * scale, y * scale], hessian: [constant, zero, constant] }
        }
    }

    /// Inverse mean ratio ‖A W⁻¹‖² / (2 det(A W⁻¹)), W equilateral.
    Imr = "imr" {
        properties {
            formula: "|A W⁻¹|² / (2 det(A W⁻¹)), W equilateral",
            citation: "Munson, Mesh shape-quality optimization using the inverse mean-ratio metric, Math. Program. 110 (2007)",
            purpose: "the all-round choice: well-shaped triangles whatever their size, gradation kept, and a barrier against inversion",
            barrier: true,
            ideal: 1.0,
            scale_invariant: true,
            quadratic: false,
            eigenvalue_floor: 1e-3,
            shape_guard: f64::INFINITY,
            omega: 1.9,
            stiffness: Some(Stiffness::BySize(4.0 / SQRT_3)),
        }
        excess(t) {
            // T = A W⁻¹ = [a, (2b - a)/√3]. |T|² - 2 det T is a sum of squares, so q - 1 has no
            // cancellation, and q² - 1 = (q - 1)(q - 1 + 2).
            let w = 1.0 / 3f64.sqrt();
            let ([t00, t10], [bx, by]) = (t.a, t.b);
            let (t01, t11) = ((bx * 2.0 - t00) * w, (by * 2.0 - t10) * w);
            let (u, v) = (t00 - t11, t01 + t10);
            let less_one = (u * u + v * v) / ((t00 * t11 - t01 * t10) * 2.0);
            less_one * (less_one + 2.0)
        }
        model(t, _sharpness) { Metric::Imr.excess(t) }
        derivatives(t, _sharpness) {
            // m = q - 1 = (u² + v²)/4w over the doubled area, with w = 1/√3.
            let w = 1.0 / 3f64.sqrt();
            let scale = 0.25 / w;
            let ([ax, ay], [bx, by]) = (t.a, t.b);
            let (u, v) = (ax - (by * 2.0 - ay) * w, (bx * 2.0 - ax) * w + ay);
            let inverse = ax.constant(1.0) / t.doubled_area();
            let m = (u * u + v * v) * scale * inverse;
            // ∇u = (-1, w) and ∇v = (-w, -1), so u² + v² has 2(1 + w²) = 8/3 times the identity
            // for its Hessian.
            let numerator = [(u + v * w) * (-2.0 * scale), (u * w - v) * (2.0 * scale)];
            t.quotient(m, inverse, numerator, 8.0 / 3.0 * scale).into_square(m * (m + 2.0), m + 1.0)
        }
    }

    /// Aspect ratio √3 (L12² + L23² + L13²) / (12 S).
    Ar = "ar" {
        properties {
            formula: "sqrt(3) (L12² + L23² + L13²) / (12 S)",
            citation: "Dompierre et al., An analysis of simplex shape measures for anisotropic meshes, CMAME 194 (2005); Park & Shontz, Table 1",
            purpose: "equal to imr for every triangle; kept apart because the paper times both",
            barrier: true,
            ideal: 1.0,
            scale_invariant: true,
            quadratic: false,
            eigenvalue_floor: 1e-3,
            shape_guard: f64::INFINITY,
            omega: 1.9,
            stiffness: Some(Stiffness::BySize(4.0 / SQRT_3)),
        }
        excess(t) {
            let q = t.squared_length_sum() * (3f64.sqrt() / 6.0) / t.doubled_area();
            (q - 1.0) * (q + 1.0)
        }
        model(t, _sharpness) { Metric::Ar.excess(t) }
        derivatives(t, _sharpness) {
            let scale = 3f64.sqrt() / 6.0;
            let inverse = t.a[0].constant(1.0) / t.doubled_area();
            let q = t.squared_length_sum() * scale * inverse;
            let [x, y] = t.length_sum_gradient();
            t.quotient(q, inverse, [x * scale, y * scale], 4.0 * scale)
                .into_square((q - 1.0) * (q + 1.0), q)
        }
    }
}

impl Metric {
    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        self.properties().name
    }

    /// q² of the ideal triangle: what [`Self::excess`] leaves out.
    pub const fn ideal_squared(self) -> f64 {
        let ideal = self.properties().ideal;
        ideal * ideal
    }

    /// q itself, infinite for a triangle without area if the metric has a barrier.
    pub fn quality(self, corner: &Corner<f64>) -> f64 {
        if self.properties().barrier && corner.doubled_area() <= 0.0 {
            return f64::INFINITY;
        }
        (self.excess(corner) + self.ideal_squared()).sqrt()
    }

    /// Value, gradient and Hessian of [`Self::model`] with respect to the vertex the edges of
    /// `corner` start from.
    #[inline(always)]
    pub fn derivatives<T: Real>(self, corner: &Corner<T>, sharpness: u32) -> Dual<T> {
        // Moving the vertex by d changes both edges by -d.
        let ([ax, ay], [bx, by]) = (corner.a, corner.b);
        let a = [Dual::variable(ax, 0, -1.0), Dual::variable(ay, 1, -1.0)];
        let b = [Dual::variable(bx, 0, -1.0), Dual::variable(by, 1, -1.0)];
        let dual = Corner { a, b, mean_area: corner.mean_area };
        self.model(&dual, sharpness)
    }
}

impl std::fmt::Display for Metric {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Metric {
    type Err = UnknownMetric;
    fn from_str(text: &str) -> Result<Self, UnknownMetric> {
        let found = Metric::ALL.iter().find(|m| m.name().eq_ignore_ascii_case(text.trim()));
        found.copied().ok_or_else(|| UnknownMetric(text.trim().to_owned()))
    }
}

/// No metric has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no metric is called '{0}'; there are {names}", names = names())]
pub struct UnknownMetric(pub String);

fn names() -> String {
    Metric::ALL.iter().map(|m| m.name()).collect::<Vec<_>>().join(", ")
}
