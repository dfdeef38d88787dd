//! The quality metrics, one row each.
//!
//! A metric is one row of the table below and one file `shaders/metric/NAME.wgsl`; everything else
//! (command line, help, shader composition, property tests, GPU-against-f64 tests, benchmarks)
//! loops over [`Metric::ALL`].

use crate::dual::{Dual, Real};

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
    fn squared_length_sum(&self) -> T {
        let [a, b, c] = self.squared_lengths();
        a + b + c
    }

    /// Twice the signed area.
    #[inline(always)]
    pub fn doubled_area(&self) -> T {
        self.a[0] * self.b[1] - self.a[1] * self.b[0]
    }
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

/// Generates the enum, the table and the formulas from one row per metric.
macro_rules! metrics {
    ($( $(#[$doc:meta])* $variant:ident = $name:literal {
        properties { $($field:ident: $value:expr,)* }
        excess($t:ident) $excess:block
        model($u:ident, $sharpness:ident) $model:block
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
                    wgsl: include_str!(concat!("../shaders/metric/", $name, ".wgsl")),
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
            let [mut least, mut most, other] = t.squared_lengths();
            if least.value() > most.value() { (least, most) = (most, least); }
            if other.value() < least.value() { least = other; }
            if other.value() > most.value() { most = other; }
            (most - least) / least
        }
        model(t, sharpness) {
            // The p-norm of the edge pairs: (max/min) [mean A mean B]^(1/k) with A = (L/max)^k and
            // B = (min/L)^k, both from ratios below one. Scaling by max and min changes nothing,
            // so they may enter as constants.
            let lengths = t.squared_lengths();
            let values = lengths.map(Real::value);
            let most = values[0].max(values[1]).max(values[2]);
            let least = values[0].min(values[1]).min(values[2]);
            let (mut a, mut b) = (T::from(0.0), T::from(0.0));
            for length in lengths {
                let (mut up, mut down) = (length / T::from(most), T::from(least) / length);
                for _ in 0..sharpness {
                    up = up * up;
                    down = down * down;
                }
                a = a + up;
                b = b + down;
            }
            let mut root = a * b / T::from(9.0);
            for _ in 0..sharpness { root = root.sqrt(); }
            root * T::from(most / least) - T::from(1.0)
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
            let q = t.doubled_area() / T::from(2.0 * t.mean_area) - T::from(1.0);
            q * q
        }
        model(t, sharpness) { let _ = sharpness; Metric::Area.excess(t) }
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
            t.squared_length_sum() / T::from(12.0 * t.mean_area / 3f64.sqrt()) - T::from(1.0)
        }
        model(t, sharpness) { let _ = sharpness; Metric::Rms.excess(t) }
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
            let w = T::from(1.0 / 3f64.sqrt());
            let two = T::from(2.0);
            let ([t00, t10], [bx, by]) = (t.a, t.b);
            let (t01, t11) = ((two * bx - t00) * w, (two * by - t10) * w);
            let (u, v) = (t00 - t11, t01 + t10);
            let less_one = (u * u + v * v) / (two * (t00 * t11 - t01 * t10));
            less_one * (less_one + two)
        }
        model(t, sharpness) { let _ = sharpness; Metric::Imr.excess(t) }
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
            let q = t.squared_length_sum() * T::from(3f64.sqrt() / 6.0) / t.doubled_area();
            (q - T::from(1.0)) * (q + T::from(1.0))
        }
        model(t, sharpness) { let _ = sharpness; Metric::Ar.excess(t) }
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
    pub fn derivatives(self, corner: &Corner<f64>, sharpness: u32) -> Dual {
        // Moving the vertex by d changes both edges by -d.
        let edge = |e: [f64; 2]| [Dual::variable(e[0], 0, -1.0), Dual::variable(e[1], 1, -1.0)];
        let dual = Corner { a: edge(corner.a), b: edge(corner.b), mean_area: corner.mean_area };
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
