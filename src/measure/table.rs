//! The table of quality measures, one row per measure. The command line, the documentation and the tests loop over
//! [`Measure::ALL`].

use crate::measure::definition::{Better, Definition, QuadrilateralDefinition};
use crate::measure::edges::{EQUILATERAL, InnerEdge, SQUARE, WorstEdges};
use crate::measure::quadrilateral::Quadrilateral;
use crate::measure::triangle::{LEAST_SKEWNESS, Triangle};
use crate::metric::Metric;

/// Returns the description of a measure that quadrilaterals have.
const fn of_quadrilateral(
    formula: &'static str,
    range: [f64; 2],
    ideal: f64,
) -> Option<QuadrilateralDefinition> {
    Some(QuadrilateralDefinition { formula, range, ideal })
}

/// Returns the value of a measure that quadrilaterals lack.
fn no_value(_: &Quadrilateral) -> f64 {
    f64::NAN
}

/// The range of a ratio whose ideal is 1.
const FROM_ONE: [f64; 2] = [1.0, f64::INFINITY];

const MESHKERNEL: &str =
    "MeshKernel 8, Deltares; a circumcenter outside of its triangle moves to the edge toward it";

const VERDICT: &str = "Stimpson, Ernst, Knupp, Pébay & Thompson, The Verdict Geometric Quality Library, SAND2007-1751 (2007)";

/// Generates the enum, its definitions and the dispatch to the formulas from one row per measure.
macro_rules! measures {
    ($($(#[$doc:meta])* $variant:ident = $value:expr, $of_quadrilateral:expr, $definition:expr;)*) => {
        /// A quality measure of an element. The ideal triangle is equilateral, and the ideal quadrilateral a square.
        ///
        /// Some measures are of triangles alone; see [`of_quadrilateral`](Self::of_quadrilateral). The other measures have a
        /// formula for quadrilaterals in [`Definition::quadrilateral`], by Verdict except for metrics. A quadrilateral that is not
        /// convex has a `scaled-jacobian` of 0 or less, a `shape` of 0, an infinite `condition` and `med-aspect-frobenius`, and a
        /// `max-angle` from 180° to 360°.
        ///
        /// Inverted and flat triangles have the values that the Verdict library gives them. Ratios and angles know no
        /// orientation, so an inverted triangle counts as its mirror image; `scaled-jacobian` becomes negative,
        /// `condition` infinite and `shape` 0. A measure that grows without bound is infinite for a flat triangle.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Measure {
            $($(#[$doc])* $variant,)*
            /// A metric that smoothing minimizes; the measure is its value q, and for a quadrilateral the root of the mean of q²
            /// over its four corner triangles. Infinite for an inverted or flat triangle, or such a corner triangle, if the
            /// metric has a barrier.
            Metric(Metric),
        }

        impl Measure {
            /// All measures except metrics, in table order.
            const OWN: &'static [Measure] = &[$(Measure::$variant,)*];

            /// Returns the description of the measure.
            pub const fn definition(self) -> Definition {
                match self {
                    $(Measure::$variant => $definition,)*
                    Measure::Metric(metric) => of_metric(metric),
                }
            }

            /// Returns the value of the measure for a triangle.
            #[inline]
            pub(crate) fn value(self, triangle: &Triangle) -> f64 {
                match self {
                    $(Measure::$variant => { let value: fn(&Triangle) -> f64 = $value; value(triangle) })*
                    Measure::Metric(metric) => triangle.metric(metric),
                }
            }

            /// Returns the value of the measure for a quadrilateral, NaN if quadrilaterals lack the measure.
            pub(crate) fn value_of_quadrilateral(self, quadrilateral: &Quadrilateral) -> f64 {
                match self {
                    $(Measure::$variant => {
                        let value: fn(&Quadrilateral) -> f64 = $of_quadrilateral;
                        value(quadrilateral)
                    })*
                    Measure::Metric(metric) => quadrilateral.metric(metric),
                }
            }
        }
    };
}

measures! {
    /// The smallest angle, in degrees.
    MinAngle = Triangle::min_angle, Quadrilateral::min_angle, Definition {
        name: "min-angle",
        formula: "the smallest angle, in degrees",
        unit: "°",
        range: [0.0, 60.0],
        ideal: 60.0,
        better: Better::Higher,
        source: VERDICT,
        quadrilateral: of_quadrilateral("the smallest inner angle, in degrees", [0.0, 90.0], 90.0),
    };
    /// The largest angle, in degrees.
    MaxAngle = Triangle::max_angle, Quadrilateral::max_angle, Definition {
        name: "max-angle",
        formula: "the largest angle, in degrees",
        unit: "°",
        range: [60.0, 180.0],
        ideal: 60.0,
        better: Better::Lower,
        source: VERDICT,
        quadrilateral: of_quadrilateral("the largest inner angle, in degrees", [90.0, 360.0], 90.0),
    };
    /// The longest edge divided by the shortest.
    EdgeRatio = Triangle::edge_ratio, Quadrilateral::edge_ratio, Definition {
        name: "edge-ratio",
        formula: "Lmax / Lmin",
        unit: "",
        range: [1.0, f64::INFINITY],
        ideal: 1.0,
        better: Better::Lower,
        source: VERDICT,
        quadrilateral: of_quadrilateral("Lmax / Lmin", FROM_ONE, 1.0),
    };
    /// The longest edge divided by the inradius, scaled to 1 for the equilateral triangle. Not the metric `ar`.
    AspectRatio = Triangle::aspect_ratio, Quadrilateral::aspect_ratio, Definition {
        name: "aspect-ratio",
        formula: "Lmax / (2√3 r) = Lmax (L1 + L2 + L3) / (4√3 S)",
        unit: "",
        range: [1.0, f64::INFINITY],
        ideal: 1.0,
        better: Better::Lower,
        source: VERDICT,
        quadrilateral: of_quadrilateral("Lmax (L1 + L2 + L3 + L4) / (4 S)", FROM_ONE, 1.0),
    };
    /// The circumradius divided by twice the inradius.
    RadiusRatio = Triangle::radius_ratio, Quadrilateral::radius_ratio, Definition {
        name: "radius-ratio",
        formula: "R / (2 r) = L1 L2 L3 (L1 + L2 + L3) / (16 S²)",
        unit: "",
        range: [1.0, f64::INFINITY],
        ideal: 1.0,
        better: Better::Lower,
        source: VERDICT,
        quadrilateral: of_quadrilateral("sqrt((L1² + L2² + L3² + L4²) max(L², D²)) / (2√2 min α)", FROM_ONE, 1.0),
    };
    /// Twice the signed area divided by the largest product of two edges, scaled to 1 for the equilateral triangle.
    /// Equal to the least sine of an angle divided by sin 60°.
    ScaledJacobian = Triangle::scaled_jacobian, Quadrilateral::scaled_jacobian, Definition {
        name: "scaled-jacobian",
        formula: "(2/√3) 2 S / max(L1 L2, L2 L3, L3 L1)",
        unit: "",
        range: [-1.0, 1.0],
        ideal: 1.0,
        better: Better::Higher,
        source: VERDICT,
        quadrilateral: of_quadrilateral("min over the corners of α / (L L')", [-1.0, 1.0], 1.0),
    };
    /// Half the condition number of the map from the equilateral triangle. Equal to the metric `imr`.
    Condition = Triangle::condition, Quadrilateral::condition, Definition {
        name: "condition",
        formula: "(L1² + L2² + L3²) / (4√3 S)",
        unit: "",
        range: [1.0, f64::INFINITY],
        ideal: 1.0,
        better: Better::Lower,
        source: VERDICT,
        quadrilateral: of_quadrilateral("max over the corners of (L² + L'²) / (2 α)", FROM_ONE, 1.0),
    };
    /// The inverse of `condition`, also called the mean ratio.
    Shape = Triangle::shape, Quadrilateral::shape, Definition {
        name: "shape",
        formula: "4√3 S / (L1² + L2² + L3²)",
        unit: "",
        range: [0.0, 1.0],
        ideal: 1.0,
        better: Better::Higher,
        source: VERDICT,
        quadrilateral: of_quadrilateral("min over the corners of 2 α / (L² + L'²)", [0.0, 1.0], 1.0),
    };
    /// The mean of `condition` over the corners of a quadrilateral. All corners of a triangle have the `condition` of the triangle,
    /// which Verdict calls its aspect Frobenius.
    MedAspectFrobenius = Triangle::condition, Quadrilateral::med_aspect_frobenius, Definition {
        name: "med-aspect-frobenius",
        formula: "(L1² + L2² + L3²) / (4√3 S)",
        unit: "",
        range: FROM_ONE,
        ideal: 1.0,
        better: Better::Lower,
        source: VERDICT,
        quadrilateral: of_quadrilateral("mean over the corners of (L² + L'²) / (2 α)", FROM_ONE, 1.0),
    };
    /// Largest deviation of an angle from 60°, or from 90° in a quadrilateral, scaled to [0, 1]: the equiangle skewness of CFD.
    Skewness = Triangle::skewness, Quadrilateral::skewness, Definition {
        name: "skewness",
        formula: "max((θmax - 60°) / 120°, (60° - θmin) / 60°)",
        unit: "",
        range: [0.0, 1.0],
        ideal: 0.0,
        better: Better::Lower,
        source: "ANSYS Fluent User's Guide, Mesh Quality: equiangle skewness; Verdict as of 2019, equiangle_skew",
        quadrilateral: of_quadrilateral("max((θmax - 90°) / 90°, (90° - θmin) / 90°)", [0.0, 1.0], 0.0),
    };
    /// The longest edge divided by the radius of the circle of equal area, 2.69 for the equilateral triangle: the skewness
    /// of SCHISM's documentation.
    SchismSkewness = Triangle::schism_skewness, no_value, Definition {
        name: "schism-skewness",
        formula: "Lmax / sqrt(S / π)",
        unit: "",
        range: [LEAST_SKEWNESS, f64::INFINITY],
        ideal: LEAST_SKEWNESS,
        better: Better::Lower,
        source: "SCHISM, grid-generation.md, Mesh quality",
        quadrilateral: None,
    };
    /// Jump of the area to a neighbor: the largest ratio of larger to smaller area among the elements across the
    /// edges. 1 for an element without neighbors.
    SizeRatio = |t| t.size_ratio, |q| q.size_ratio, Definition {
        name: "size-ratio",
        formula: "max over the neighbors N across an edge of max(S / S_N, S_N / S)",
        unit: "",
        range: [1.0, f64::INFINITY],
        ideal: 1.0,
        better: Better::Lower,
        source: "ANSYS Fluent User's Guide, Mesh Quality: cell size change, as the larger over the smaller area",
        quadrilateral: of_quadrilateral("as of a triangle", FROM_ONE, 1.0),
    };
    /// The worst orthogonality of an edge of the element; see [`InnerEdge`]. 0 for an element
    /// without neighbors.
    Orthogonality = |t| orthogonality(t.worst_edges), |q| orthogonality(q.worst_edges), Definition {
        name: "orthogonality",
        formula: "max over the neighbors of |cos| between the shared edge and the segment between both circumcenters",
        unit: "",
        range: [0.0, 1.0],
        ideal: 0.0,
        better: Better::Lower,
        source: MESHKERNEL,
        quadrilateral: of_quadrilateral("as of a triangle", [0.0, 1.0], 0.0),
    };
    /// The shortest flow link of the element; see [`InnerEdge`]. 0.877 for an element without
    /// neighbors, and 1 between squares.
    FlowLink = |t| flow_link(t.worst_edges), |q| flow_link(q.worst_edges), Definition {
        name: "flow-link",
        formula: "min over the neighbors N of the distance of both circumcenters / ((√S + √S_N) / 2)",
        unit: "",
        range: [0.0, f64::INFINITY],
        ideal: EQUILATERAL,
        better: Better::Higher,
        source: MESHKERNEL,
        quadrilateral: of_quadrilateral("as of a triangle", [0.0, f64::INFINITY], SQUARE),
    };
    /// The largest jump of the area at an edge of the element; see [`InnerEdge`]. 1 for an element
    /// without neighbors.
    Smoothness = |t| smoothness(t.worst_edges), |q| smoothness(q.worst_edges), Definition {
        name: "smoothness",
        formula: "max over the neighbors N of max(S / S_N, S_N / S), the areas of MeshKernel",
        unit: "",
        range: FROM_ONE,
        ideal: 1.0,
        better: Better::Lower,
        source: MESHKERNEL,
        quadrilateral: of_quadrilateral("as of a triangle", FROM_ONE, 1.0),
    };
}

fn orthogonality(worst: Option<WorstEdges>) -> f64 {
    worst.map_or(f64::NAN, |worst| worst.orthogonality)
}

fn flow_link(worst: Option<WorstEdges>) -> f64 {
    worst.map_or(f64::NAN, |worst| worst.flow_link)
}

fn smoothness(worst: Option<WorstEdges>) -> f64 {
    worst.map_or(f64::NAN, |worst| worst.smoothness)
}

impl InnerEdge {
    /// Returns the value of a measure; NaN if [`Measure::is_of_edges`] is false.
    pub const fn value(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Orthogonality => self.orthogonality,
            Measure::FlowLink => self.flow_link,
            Measure::Smoothness => self.smoothness,
            _ => f64::NAN,
        }
    }
}

const fn of_metric(metric: Metric) -> Definition {
    let row = metric.properties();
    // Metrics that depend on size are ideal at the mean size, and may be below the ideal for smaller elements.
    let range = [if row.scale_invariant { row.ideal } else { 0.0 }, f64::INFINITY];
    Definition {
        name: row.name,
        formula: row.formula,
        unit: "",
        range,
        ideal: row.ideal,
        better: Better::Lower,
        source: row.citation,
        quadrilateral: of_quadrilateral(
            "root of the mean of q² over the corners",
            range,
            row.ideal,
        ),
    }
}

impl Measure {
    /// Every measure: first the measures that are not metrics, then the metrics that smoothing minimizes.
    pub const ALL: &'static [Measure] = &{
        let mut all = [Measure::MinAngle; Self::OWN.len() + Metric::ALL.len()];
        let mut i = 0;
        while i < all.len() {
            all[i] = match i < Self::OWN.len() {
                true => Self::OWN[i],
                false => Measure::Metric(Metric::ALL[i - Self::OWN.len()]),
            };
            i += 1;
        }
        all
    };

    /// Returns the measure of an earlier row with equal values of all triangles, up to rounding; `None` if no earlier row has
    /// equal values. In the plane, `smoothness` equals `size-ratio` too, but not in degrees. The values of quadrilaterals may differ.
    pub const fn equal_to(self) -> Option<Measure> {
        match self {
            Measure::Metric(Metric::Edge) => Some(Measure::EdgeRatio),
            Measure::MedAspectFrobenius | Measure::Metric(Metric::Imr | Metric::Ar) => {
                Some(Measure::Condition)
            }
            _ => None,
        }
    }

    /// Returns whether quadrilaterals have the measure. If not, their value is NaN, and statistics and lists of the worst
    /// elements leave them out.
    pub const fn of_quadrilateral(self) -> bool {
        self.definition().quadrilateral.is_some()
    }

    /// Returns whether the measure of a triangle is the worst value of its edges, which [`Measured::edges`] has.
    ///
    /// [`Measured::edges`]: crate::measure::Measured::edges
    pub const fn is_of_edges(self) -> bool {
        matches!(self, Measure::Orthogonality | Measure::FlowLink | Measure::Smoothness)
    }

    /// Returns the name on the command line.
    pub const fn name(self) -> &'static str {
        self.definition().name
    }

    /// Returns whether the value `a` is worse than `b`.
    pub const fn is_worse(self, a: f64, b: f64) -> bool {
        match self.definition().better {
            Better::Higher => a < b,
            Better::Lower => a > b,
        }
    }
}

impl std::fmt::Display for Measure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Measure {
    type Err = UnknownMeasure;
    /// Parses a name of [`Measure::ALL`]. Underscores may replace hyphens, as in the names of Verdict and VTK.
    fn from_str(text: &str) -> Result<Self, UnknownMeasure> {
        let name = text.trim().to_ascii_lowercase().replace('_', "-");
        let found = Measure::ALL.iter().find(|measure| measure.name() == name);
        found.copied().ok_or_else(|| UnknownMeasure(text.trim().to_owned()))
    }
}

/// The text does not name a measure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no measure is called '{0}'; there are {names}", names = names())]
pub struct UnknownMeasure(pub String);

/// Returns the names of all measures, separated by commas, for the error message.
fn names() -> String {
    Measure::ALL.iter().map(|measure| measure.name()).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_leads_back_to_its_measure() {
        for &measure in Measure::ALL {
            assert_eq!(measure.name().parse(), Ok(measure));
            assert_eq!(measure.name().to_uppercase().replace('-', "_").parse(), Ok(measure));
        }
        let error = "roundness".parse::<Measure>().unwrap_err().to_string();
        let [first, second] = [0, 1].map(|k| Measure::ALL[k].name());
        let told = format!("no measure is called 'roundness'; there are {first}, {second}, ");
        assert!(error.starts_with(&told), "{error}");
    }

    #[test]
    fn the_ideal_is_the_good_end_of_the_range() {
        for measure in Measure::ALL {
            let Definition { range: [least, most], ideal, better, .. } = measure.definition();
            assert!(least < most);
            // A metric that sees sizes is ideal at the mean size, and may be below its ideal for a smaller triangle.
            let may_be_below = |metric: &Metric| !metric.properties().scale_invariant;
            // Links between long triangles may be longer than between equilateral ones.
            let may_pass = matches!(measure, Measure::Metric(metric) if may_be_below(metric))
                || *measure == Measure::FlowLink;
            if may_pass {
                assert!((least..most).contains(&ideal), "{measure}");
            } else {
                assert_eq!(ideal, if better == Better::Higher { most } else { least }, "{measure}");
            }
        }
    }
}
