//! The table of quality metrics.
//!
//! A metric is a row of the table below and two files, `NAME.rs` and `NAME.wgsl`. Everything else (command line, help,
//! shader composition, property tests, GPU-against-f64 tests, benchmarks) loops over [`Metric::ALL`].

use crate::metric::corner::{Corner, Invariants};
use crate::metric::dual::{Dual, Real};
use crate::metric::edge_slopes::{EdgeSlopes, Own};
use crate::metric::properties::Properties;
use crate::metric::slopes::{Derivatives, Slopes};
use crate::metric::smoothing::Smoothing;
use crate::metric::{
    acute, acute_size, ar, area, edge, imr, rms, shape_size, soft_size, tmop_2, tmop_80, tmop_94,
};

/// Generates the enum, the table and the formulas from one row per metric. Metrics in braces are rare: they take less
/// time to compile, and their sweeps take longer.
macro_rules! metrics {
    (
        $(#[$edge_doc:meta])*
        $edge:ident = $edge_file:ident of edges;
        $($(#[$doc:meta])* $variant:ident = $file:ident of invariants;)*
        => {
            $($(#[$rare_doc:meta])* $rare:ident = $rare_file:ident of invariants;)*
        }
        => {
            $($(#[$angle_doc:meta])* $angle:ident = $angle_file:ident of cotangents;)*
        }
    ) => {
        /// A quality metric q of a triangle. Smaller values are better. [`Metric::citation`] names the source of each
        /// metric.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Metric {
            $(#[$edge_doc])* $edge,
            $($(#[$doc])* $variant,)*
            $($(#[$rare_doc])* $rare,)*
            $($(#[$angle_doc])* $angle,)*
        }

        /// A metric that is a function of the cotangents of a triangle's angles, and of its [`Invariants`].
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum OfCotangents { $($angle,)* }

        impl OfCotangents {
            #[inline(always)]
            fn of(self) -> Metric {
                match self { $(Self::$angle => Metric::$angle,)* }
            }

            /// Returns q² - ideal².
            #[inline(always)]
            fn value<T: Real>(self, corner: &Corner<T>) -> T {
                match self { $(Self::$angle => $angle_file::excess(corner),)* }
            }

            /// Returns q² - ideal² with its derivatives by the visited vertex.
            #[inline(always)]
            fn derivatives<T: Real>(self, corner: &Corner<T>, edges: impl EdgeSlopes) -> Dual<T> {
                match self { $(Self::$angle => $angle_file::expansion(corner, edges),)* }
            }
        }

        /// A metric that is a function of a triangle's [`Invariants`].
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum OfInvariants { $($variant,)* $($rare,)* }

        impl Metric {
            /// Every metric: first Park & Shontz's metrics in the order of their Table 1, then further metrics.
            pub const ALL: &'static [Metric] = &[Metric::$edge, $(Metric::$variant,)* $(Metric::$rare,)* $(Metric::$angle,)*];

            /// Returns the metric's row of properties, for this project's own tests and benchmarks.
            #[doc(hidden)]
            pub const fn properties(self) -> &'static Properties {
                match self {
                    Metric::$edge => &$edge_file::PROPERTIES,
                    $(Metric::$variant => &$file::PROPERTIES,)*
                    $(Metric::$rare => &$rare_file::PROPERTIES,)*
                    $(Metric::$angle => &$angle_file::PROPERTIES,)*
                }
            }

            /// Returns q² - ideal² by every metric, in the order of [`Self::ALL`]. Quantities that several metrics need
            /// are computed once.
            #[inline(always)]
            pub(crate) fn every_excess<T: Real>(corner: &Corner<T>) -> [T; Self::ALL.len()] {
                let invariants = corner.invariants();
                [
                    $edge_file::excess(corner),
                    $($file::value(&invariants),)*
                    $($rare_file::value(&invariants),)*
                    $($angle_file::excess(corner),)*
                ]
            }

            /// Returns the formulas of the metric.
            #[inline(always)]
            pub(crate) const fn formulas(self) -> AnyFormulas {
                match self {
                    Metric::$edge => AnyFormulas::Edges(OfEdges),
                    $(Metric::$variant => AnyFormulas::Invariants(OfInvariants::$variant),)*
                    $(Metric::$rare => AnyFormulas::Invariants(OfInvariants::$rare),)*
                    $(Metric::$angle => AnyFormulas::Cotangents(OfCotangents::$angle),)*
                }
            }
        }

        /// Evaluates an expression that is compiled separately for each usual metric, with `$f` bound to the
        /// [`Formulas`] of the metric. Does nothing for a rare metric. `$f` is a constant, not a variable, so that
        /// closures in the expression know the metric at compile time.
        macro_rules! with_each_metric {
            ($metric:expr, $f:ident => $body:expr) => {
                match $metric {
                    $crate::metric::Metric::$edge => {
                        #[allow(non_upper_case_globals)]
                        const $f: $crate::metric::OfEdges = $crate::metric::OfEdges;
                        $body
                    }
                    $($crate::metric::Metric::$variant => {
                        #[allow(non_upper_case_globals)]
                        const $f: $crate::metric::OfInvariants = $crate::metric::OfInvariants::$variant;
                        $body
                    })*
                    $($crate::metric::Metric::$rare)|* | $($crate::metric::Metric::$angle)|* => {}
                }
            };
        }
        pub(crate) use with_each_metric;

        impl OfInvariants {
            #[inline(always)]
            fn of(self) -> Metric {
                match self { $(Self::$variant => Metric::$variant,)* $(Self::$rare => Metric::$rare,)* }
            }

            /// Returns q² - ideal².
            #[inline(always)]
            fn value<T: Real>(self, t: &Invariants<T>) -> T {
                match self {
                    $(Self::$variant => $file::value(t),)*
                    $(Self::$rare => $rare_file::value(t),)*
                }
            }

            /// Returns value, gradient and Hessian of q² - ideal² with respect to the visited vertex.
            #[inline(always)]
            fn expansion_of<T: Real>(self, corner: &Corner<T>, edges: impl EdgeSlopes) -> Dual<T> {
                let t = corner.invariants();
                match self {
                    $(Self::$variant => $file::slopes(&t).expansion(corner, edges),)*
                    $(Self::$rare => $rare_file::slopes(&t).expansion(corner, edges),)*
                }
            }

            /// Returns the derivatives of q² by excess and area.
            #[inline(always)]
            pub(super) fn derivatives<T: Real>(self, t: &Invariants<T>) -> Derivatives<T> {
                match self {
                    $(Self::$variant => $file::slopes(t).derivatives(),)*
                    $(Self::$rare => $rare_file::slopes(t).derivatives(),)*
                }
            }
        }
    };
}

metrics! {
    /// EDGE, the edge ratio Lmax/Lmin (Park & Shontz, Table 1, printed there as its inverse).
    Edge = edge of edges;
    /// AREA, the relative deviation |S - S_mean| / S_mean of the area S from the mean (Park & Shontz, Table 1).
    Area = area of invariants;
    /// RMS, the root mean square of the edge lengths, divided by that of the equilateral triangle of mean area (Park &
    /// Shontz, Table 1).
    Rms = rms of invariants;
    /// IMR, the inverse mean ratio |A W⁻¹|² / (2 det(A W⁻¹)), with A the edges of the triangle and W those of an
    /// equilateral one (Munson, Math. Program. 110, 2007).
    Imr = imr of invariants;
    /// AR, the aspect ratio √3 (L12² + L23² + L13²) / (12 S) with S the area (Park & Shontz, Table 1). Equal to IMR.
    Ar = ar of invariants;
    /// SHAPE-SIZE, |T - T⁻ᵗ| for T = A W⁻¹, with A the edges of the triangle and W those of the equilateral one of mean
    /// area (Knupp et al., SIAM J. Sci. Comp. 41, 2019, metric 7).
    ShapeSize = shape_size of invariants;
    => {
    /// SOFT-SIZE, √(μ₂ + 0.4 μ₅₆), of shape first, μ₂ = |T|² / 2τ - 1, and size second, μ₅₆ = (τ - 1)² / 2τ, with T as
    /// in SHAPE-SIZE and τ = det T (Knupp et al., SIAM J. Sci. Comp. 41, 2019, metrics 2 and 56).
    SoftSize = soft_size of invariants;
    /// TMOP-80, √((1 - γ) μ₂ + γ μ₇₇) with γ = 1/2, of shape, μ₂ = |T|² / 2τ - 1, and size, μ₇₇ = (τ - 1/τ)² / 2, in
    /// equal parts, with T as in SHAPE-SIZE and τ = det T (Knupp et al., SIAM J. Sci. Comp. 41, 2019, metric 80).
    Tmop80 = tmop_80 of invariants;
    /// TMOP-94, √(μ₂ + 1.5 μ₅₆), of shape, μ₂ = |T|² / 2τ - 1, and size, μ₅₆ = (τ - 1)² / 2τ, with T as in SHAPE-SIZE
    /// and τ = det T (Knupp et al., SIAM J. Sci. Comp. 41, 2019, metric 94).
    Tmop94 = tmop_94 of invariants;
    /// TMOP-2, √μ₂, of shape alone, μ₂ = |T|² / 2τ - 1, with T and τ as in TMOP-94 (Knupp et al., SIAM J. Sci. Comp. 41,
    /// 2019, metric 2). μ₂ is the inverse mean ratio less one.
    Tmop2 = tmop_2 of invariants;
    }
    => {
    /// ACUTE, the inverse mean ratio with penalties on angles above 78.7 and below 37.6 degrees: √(imr² + 300 Σ ψ(0.2 -
    /// cot) + 30 Σ ψ(cot - 1.3)), with the sums over the three angles and ψ(x) = x³ / 0.6 for x from 0 to 0.2, and a
    /// quadratic beyond.
    Acute = acute of cotangents;
    /// ACUTE-SIZE, SOFT-SIZE with the penalties on angles of ACUTE.
    AcuteSize = acute_size of cotangents;
    }
}

/// The metric EDGE, a function of the edge lengths of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OfEdges;

/// The formulas of any metric. Hot loops are compiled for all variants together, and look up a metric of the
/// invariants at run time. A compilation for every metric would take minutes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum AnyFormulas {
    Edges(OfEdges),
    Invariants(OfInvariants),
    Cotangents(OfCotangents),
}

/// The functions of a metric that engines compute.
pub(crate) trait Formulas: Copy + Sync {
    /// Returns the metric, a constant at compile time if the type fixes the formulas.
    fn metric(self) -> Metric;

    /// Returns the inverse mean ratio of a triangle with positive area, as numerator and denominator; the denominator
    /// is the doubled area. The ratio is computed from quantities that the metric uses too, so that the compiler can
    /// share them.
    fn inverse_mean_ratio<T: Real>(self, corner: &Corner<T>) -> (T, T);

    /// Returns q² - ideal². Sums of this difference keep their digits on good meshes.
    fn excess<T: Real>(self, corner: &Corner<T>) -> T;

    /// Returns the function that Newton's method minimizes: [`Self::excess`] if q² is smooth, else a smooth model of
    /// it.
    fn model<T: Real>(self, corner: &Corner<T>, smoothing: Smoothing) -> T;

    /// Returns value, gradient and Hessian of [`Self::model`] with respect to the visited vertex, by the hand-written
    /// derivatives. `edges` has the slopes of the edges of `corner` by the position of the vertex.
    fn expansion<T: Real>(
        self,
        corner: &Corner<T>,
        edges: impl EdgeSlopes,
        smoothing: Smoothing,
    ) -> Dual<T>;
}

impl Formulas for OfEdges {
    #[inline(always)]
    fn metric(self) -> Metric {
        Metric::Edge
    }

    #[inline(always)]
    fn inverse_mean_ratio<T: Real>(self, corner: &Corner<T>) -> (T, T) {
        (corner.squared_length_sum() * (3f64.sqrt() / 6.0), corner.doubled_area())
    }

    #[inline(always)]
    fn excess<T: Real>(self, corner: &Corner<T>) -> T {
        edge::excess(corner)
    }

    #[inline(always)]
    fn model<T: Real>(self, corner: &Corner<T>, smoothing: Smoothing) -> T {
        let norm = edge::model(corner, smoothing.sharpness);
        if smoothing.is_penalized() { norm + smoothing.penalty(corner) } else { norm }
    }

    #[inline(always)]
    fn expansion<T: Real>(
        self,
        corner: &Corner<T>,
        edges: impl EdgeSlopes,
        smoothing: Smoothing,
    ) -> Dual<T> {
        let norm = edge::expansion(corner, edges, smoothing.sharpness);
        if smoothing.is_penalized() {
            norm + smoothing.penalty_expansion(corner, edges)
        } else {
            norm
        }
    }
}

impl Formulas for OfInvariants {
    #[inline(always)]
    fn metric(self) -> Metric {
        self.of()
    }

    #[inline(always)]
    fn inverse_mean_ratio<T: Real>(self, corner: &Corner<T>) -> (T, T) {
        let t = corner.invariants();
        (t.excess + t.area, t.area)
    }

    #[inline(always)]
    fn excess<T: Real>(self, corner: &Corner<T>) -> T {
        self.value(&corner.invariants())
    }

    #[inline(always)]
    fn model<T: Real>(self, corner: &Corner<T>, _: Smoothing) -> T {
        self.excess(corner)
    }

    #[inline(always)]
    fn expansion<T: Real>(
        self,
        corner: &Corner<T>,
        edges: impl EdgeSlopes,
        _: Smoothing,
    ) -> Dual<T> {
        self.expansion_of(corner, edges)
    }
}

impl Formulas for OfCotangents {
    #[inline(always)]
    fn metric(self) -> Metric {
        self.of()
    }

    #[inline(always)]
    fn inverse_mean_ratio<T: Real>(self, corner: &Corner<T>) -> (T, T) {
        OfEdges.inverse_mean_ratio(corner)
    }

    #[inline(always)]
    fn excess<T: Real>(self, corner: &Corner<T>) -> T {
        self.value(corner)
    }

    #[inline(always)]
    fn model<T: Real>(self, corner: &Corner<T>, _: Smoothing) -> T {
        self.value(corner)
    }

    #[inline(always)]
    fn expansion<T: Real>(
        self,
        corner: &Corner<T>,
        edges: impl EdgeSlopes,
        _: Smoothing,
    ) -> Dual<T> {
        self.derivatives(corner, edges)
    }
}

/// Formulas that look up the metric for each triangle.
impl Formulas for AnyFormulas {
    #[inline(always)]
    fn metric(self) -> Metric {
        match self {
            AnyFormulas::Edges(f) => f.metric(),
            AnyFormulas::Invariants(f) => f.metric(),
            AnyFormulas::Cotangents(f) => f.metric(),
        }
    }

    #[inline(always)]
    fn inverse_mean_ratio<T: Real>(self, corner: &Corner<T>) -> (T, T) {
        OfEdges.inverse_mean_ratio(corner)
    }

    #[inline(always)]
    fn excess<T: Real>(self, corner: &Corner<T>) -> T {
        corner.a[0].apart(
            #[inline(always)]
            || match self {
                AnyFormulas::Edges(f) => f.excess(corner),
                AnyFormulas::Invariants(f) => f.excess(corner),
                AnyFormulas::Cotangents(f) => f.excess(corner),
            },
        )
    }

    #[inline(always)]
    fn model<T: Real>(self, corner: &Corner<T>, smoothing: Smoothing) -> T {
        corner.a[0].apart(
            #[inline(always)]
            || match self {
                AnyFormulas::Edges(f) => f.model(corner, smoothing),
                AnyFormulas::Invariants(f) => f.model(corner, smoothing),
                AnyFormulas::Cotangents(f) => f.model(corner, smoothing),
            },
        )
    }

    #[inline(always)]
    fn expansion<T: Real>(
        self,
        corner: &Corner<T>,
        edges: impl EdgeSlopes,
        smoothing: Smoothing,
    ) -> Dual<T> {
        corner.a[0].apart(
            #[inline(always)]
            || match self {
                AnyFormulas::Edges(f) => f.expansion(corner, edges, smoothing),
                AnyFormulas::Invariants(f) => f.expansion(corner, edges, smoothing),
                AnyFormulas::Cotangents(f) => f.expansion(corner, edges, smoothing),
            },
        )
    }
}

impl Metric {
    /// Returns the name on the command line.
    pub const fn name(self) -> &'static str {
        self.properties().name
    }

    /// Returns the formula of q as text. L are edge lengths, S is the area.
    pub const fn formula(self) -> &'static str {
        self.properties().formula
    }

    /// Returns the publication that defines the metric.
    pub const fn citation(self) -> &'static str {
        self.properties().citation
    }

    /// Returns a text on the purpose of the metric, and its effect on shapes.
    pub const fn purpose(self) -> &'static str {
        self.properties().purpose
    }

    /// Returns q of an equilateral triangle of mean area, the least value of q by all metrics but RMS.
    pub const fn ideal(self) -> f64 {
        self.properties().ideal
    }

    /// Returns the over-relaxation of sweeps by this metric alone, used if
    /// [`Relaxed::omega`](crate::options::Relaxed::omega) is `None`.
    pub const fn omega(self) -> f64 {
        self.properties().omega
    }

    /// Returns the largest inverse mean ratio that a step by this metric may leave, unless the patch had a larger ratio
    /// before. Infinite for a metric with a barrier.
    pub const fn shape_guard(self) -> f64 {
        self.properties().shape_guard
    }

    /// Returns whether q grows to infinity as the area of a triangle goes to zero.
    pub const fn has_barrier(self) -> bool {
        self.properties().barrier
    }

    /// Returns whether q is independent of the size of a triangle.
    pub const fn is_scale_invariant(self) -> bool {
        self.properties().scale_invariant
    }

    /// Returns whether q² has a term of size, which [`Targets::size_weight`](crate::Targets::size_weight) multiplies.
    pub const fn has_size_weight(self) -> bool {
        self.properties().has_size_weight
    }

    /// Returns whether sweeps by this metric alone can be corrected from coarser levels; see
    /// [`Method::Multilevel`](crate::Method::Multilevel).
    pub const fn supports_multilevel(self) -> bool {
        self.properties().is_corrected
    }

    /// Returns the lower limit of f. `mean_varies` tells whether the mean size of the elements changes in a run.
    pub(crate) const fn least_objective(self, mean_varies: bool) -> f64 {
        let least = self.properties().least;
        if mean_varies { least * least } else { self.ideal_squared() }
    }

    /// Returns q² of the ideal triangle, which [`Self::excess`] subtracts.
    pub const fn ideal_squared(self) -> f64 {
        let ideal = self.properties().ideal;
        ideal * ideal
    }

    /// Returns whether q² is smooth, so that Newton's method minimizes q² directly. False for EDGE alone.
    pub const fn is_smooth(self) -> bool {
        !matches!(self.formulas(), AnyFormulas::Edges(_))
    }

    /// Returns whether q² is a function of the [`Invariants`], and so has Hessians of triangles by their corners. False
    /// for EDGE and ACUTE.
    #[cfg(feature = "gpu")]
    pub(crate) const fn is_of_invariants(self) -> bool {
        matches!(self.formulas(), AnyFormulas::Invariants(_))
    }

    /// Returns whether q² of a quadrilateral has a term that joins opposite angles, beside the mean over the corners; see
    /// src/metric/opposite_angles.rs. True for ACUTE and ACUTE-SIZE.
    #[inline(always)]
    pub(crate) const fn joins_opposite_angles(self) -> bool {
        matches!(self.formulas(), AnyFormulas::Cotangents(_))
    }

    /// Returns q² - ideal². Sums of this difference keep their digits on good meshes.
    #[doc(hidden)]
    pub fn excess<T: Real>(self, corner: &Corner<T>) -> T {
        self.formulas().excess(corner)
    }

    /// Returns the function that Newton's method minimizes: [`Self::excess`] for smooth metrics. For EDGE, which is not
    /// smooth, the function is a p-norm with exponent k = 2^`sharpness`, minus 1.
    #[doc(hidden)]
    pub fn model<T: Real>(self, corner: &Corner<T>, sharpness: u32) -> T {
        self.formulas().model(corner, Smoothing::of(sharpness))
    }

    /// Returns value, gradient and Hessian of [`Self::model`] with respect to the vertex from which the edges of
    /// `corner` start, by the hand-written derivatives of the CPU engine.
    #[doc(hidden)]
    pub fn expansion<T: Real>(self, corner: &Corner<T>, sharpness: u32) -> Dual<T> {
        self.formulas().expansion(corner, Own, Smoothing::of(sharpness))
    }

    /// Returns value, gradient and Hessian of [`Self::model`] with respect to the vertex from which the edges of
    /// `corner` start, by dual numbers. Tests compare the hand-written derivatives with this function.
    #[doc(hidden)]
    pub fn derivatives<T: Real>(self, corner: &Corner<T>, sharpness: u32) -> Dual<T> {
        // If the vertex moves by d, both edges change by -d.
        let ([ax, ay], [bx, by]) = (corner.a, corner.b);
        let a = [Dual::variable(ax, 0, -1.0), Dual::variable(ay, 1, -1.0)];
        let b = [Dual::variable(bx, 0, -1.0), Dual::variable(by, 1, -1.0)];
        let dual = Corner { a, b, ideal: corner.ideal };
        self.model(&dual, sharpness)
    }

    /// Returns q. Infinite for a flat or inverted triangle if the metric has a barrier.
    pub fn quality(self, corner: &Corner<f64>) -> f64 {
        let is_positive = corner.doubled_area() > 0.0;
        if self.properties().barrier && !is_positive {
            return f64::INFINITY;
        }
        (self.excess(corner) + self.ideal_squared()).sqrt()
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

/// The text does not name a metric.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no metric is called '{0}'; there are {names}", names = names())]
pub struct UnknownMetric(pub String);

/// Returns the names of all metrics, separated by commas, for the error message.
fn names() -> String {
    Metric::ALL.iter().map(|m| m.name()).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::Ideal;

    #[test]
    fn all_metrics_evaluated_at_once_equal_each_evaluated_alone() {
        let corner = Corner { a: [1.0, 0.2], b: [0.3, 1.4], ideal: Ideal::of_area(0.8) };
        let together = Metric::every_excess(&corner);
        for (&metric, excess) in Metric::ALL.iter().zip(together) {
            assert_eq!(excess, metric.excess(&corner), "{metric}");
        }
    }
}
