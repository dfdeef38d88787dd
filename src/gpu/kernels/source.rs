//! The WGSL of each kernel, composed from the files in `shaders/`.

use std::fmt::Write;

use crate::gpu::kernels::form::{MeshForm, Positions};
use crate::gpu::kernels::row::{Composition, Source};
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{
    ALTITUDE_ERROR, AT_DISC, BISECTIONS, CURVE_ERROR, FINISH_WORKGROUP, HELD, HIDDEN, HISTORY,
    INVERTED, MIN_NORMAL, MOST_METRICS, MOST_SUMMED, NO_GUARD, OFF_CURVE, SEARCH_TRIALS,
    SHARED_STRUCTS, SLOT_VECTORS, SLOTS, STEP_TRIALS, TINY, WORKGROUP, WORST,
};
use crate::layout::{MapKind, OPPOSITE};
use crate::metric::Metric;
use crate::metric::smoothing::PENALTY;
use crate::options::Derivatives;
use crate::patch::MIN_CIRCLE_CURVATURE;
use crate::patch::search_rule::{
    FLAT_EXPONENT, FLAT_RATIO, MIN_FLAT_SUM, SUFFICIENT_DECREASE, SearchRule,
};
use crate::run::Stop;
use crate::run::multilevel::search::{CLOSE, MAX_FIRST_LENGTH};
use crate::run::multilevel::{MIN_FIRST_LENGTH, NONE, OF_QUADRILATERALS, SMOOTHING};
use crate::run::secant::MIN_CURVATURE;
use crate::run::truncated::{ErrorBound, StepRequest, StepSearch, aggregation};
use crate::run::{JITTER, MIN_SCALE, NOISE, line_search, regularization};
use crate::slide::{FREEZES_AFTER, HALVINGS, MAX_STEP_SHARE};

const POSITIONS: &str = include_str!("../../../shaders/positions.wgsl");
const POSITIONS_IN_TWO: &str = include_str!("../../../shaders/positions_in_two.wgsl");
const NO_MAPS: &str = include_str!("../../../shaders/no_maps.wgsl");
const TARGET_MAPS: &str = include_str!("../../../shaders/target_maps.wgsl");
const LOCAL_MAPS: &str = include_str!("../../../shaders/local_maps.wgsl");
const MAPS: &str = include_str!("../../../shaders/maps.wgsl");
const NO_BOUNDS: &str = include_str!("../../../shaders/no_bounds.wgsl");
const BOUNDS: &str = include_str!("../../../shaders/bounds.wgsl");
const INVARIANTS: &str = include_str!("../../../shaders/invariants.wgsl");
const ANGLES: &str = include_str!("../../../shaders/angles.wgsl");
const OPPOSITE_ANGLES: &str = include_str!("../../../shaders/opposite_angles.wgsl");
const PENALTY_SOURCE: &str = include_str!("../../../shaders/penalty.wgsl");
const QUADRILATERALS: &str = include_str!("../../../shaders/quadrilaterals.wgsl");
const FINITE_DIFFERENCE: &str = include_str!("../../../shaders/finite_difference.wgsl");

impl Kernel {
    /// Returns the complete WGSL module.
    #[doc(hidden)]
    pub fn wgsl(&self) -> String {
        self.composed(Positions::Whole.into())
    }

    /// Returns the complete WGSL module for a mesh with too many positions for one binding, in two bindings of high and
    /// low parts.
    #[doc(hidden)]
    pub fn wgsl_for_large_meshes(&self) -> String {
        self.composed(Positions::InTwo.into())
    }

    /// Returns the complete WGSL module for a mesh with targets.
    #[doc(hidden)]
    pub fn wgsl_for_targets(&self) -> String {
        self.composed(MeshForm { maps: MapKind::Targets, ..Positions::Whole.into() })
    }

    /// Returns the complete WGSL module for a strongly stretched mesh.
    #[doc(hidden)]
    pub fn wgsl_for_stretched_meshes(&self) -> String {
        self.composed(MeshForm { maps: MapKind::Local, ..Positions::Whole.into() })
    }

    /// Returns the complete WGSL module for a mesh whose free vertices are bounded.
    #[doc(hidden)]
    pub fn wgsl_for_bounded_meshes(&self) -> String {
        self.composed(MeshForm { is_bounded: true, ..Positions::Whole.into() })
    }

    /// Returns the complete WGSL module for a mesh with quadrilaterals.
    #[doc(hidden)]
    pub fn wgsl_for_quadrilaterals(&self) -> String {
        self.composed(MeshForm { has_quadrilaterals: true, ..Positions::Whole.into() })
    }

    /// Composes the WGSL module: constants, structs and bindings that Rust declares, then the files of the bind layout,
    /// the access to positions, maps and bounds, and the sources of the kernel's row.
    pub(crate) fn composed(&self, form: MeshForm) -> String {
        let has_quadrilaterals = form.has_quadrilaterals && self.row().sees_quadrilaterals;
        let mut source = constants(has_quadrilaterals);
        let layout = self.layout();
        let structs = SHARED_STRUCTS.iter().filter(|shared| layout.has_type(shared.name));
        source.extend(structs.map(|shared| shared.wgsl));
        source.push_str(&layout.declarations(form.positions));
        source.extend(layout.files().iter().copied());
        if layout.has_positions() {
            source.push_str(match form.positions {
                Positions::Whole => POSITIONS,
                Positions::InTwo => POSITIONS_IN_TWO,
            });
        }
        if self.row().sees_maps {
            source.push_str(match form.maps {
                MapKind::None => NO_MAPS,
                MapKind::Targets => TARGET_MAPS,
                MapKind::Local => LOCAL_MAPS,
            });
            source.push_str(MAPS);
        }
        if self.row().sees_bounds {
            source.push_str(if form.is_bounded { BOUNDS } else { NO_BOUNDS });
        }
        if has_quadrilaterals && layout.has_positions() {
            source.push_str(QUADRILATERALS);
        }
        let composition = Composition { has_quadrilaterals, ..self.composition() };
        for part in self.row().source {
            match part {
                Source::File(text) => source.push_str(text),
                Source::ActiveMetric => source.push_str(&active_metric(&composition)),
                Source::MetricSlopes => source.push_str(&metric_slopes(&composition)),
                Source::TrackedMetrics => source.push_str(&tracked_metrics(&composition)),
                Source::TrackedSlots => source.push_str(&tracked_slots(&composition.metrics)),
                Source::UntanglingEnergy => source.push_str(&untangling_energy()),
            }
        }
        chosen(&source, has_quadrilaterals, joins_opposite_angles(&composition))
    }
}

/// Returns whether a metric of a kernel has a term of opposite angles of quadrilaterals.
fn joins_opposite_angles(composition: &Composition) -> bool {
    let joins = |metric: &Metric| metric.joins_opposite_angles();
    composition.has_quadrilaterals && composition.metrics.iter().any(joins)
}

/// Returns a source with the lines for meshes with quadrilaterals, or for meshes without, from the lines between `#if QUADRILATERALS`
/// or `#if !QUADRILATERALS`, `#else` and `#endif`. `#if OPPOSITE_ANGLES` selects lines for metrics that join opposite angles.
fn chosen(source: &str, has_quadrilaterals: bool, joins_opposite_angles: bool) -> String {
    let mut text = String::with_capacity(source.len());
    let mut is_chosen = true;
    for line in source.split_inclusive('\n') {
        match line.trim_end() {
            "#if QUADRILATERALS" => is_chosen = has_quadrilaterals,
            "#if !QUADRILATERALS" => is_chosen = !has_quadrilaterals,
            "#if OPPOSITE_ANGLES" => is_chosen = joins_opposite_angles,
            "#else" => is_chosen = !is_chosen,
            "#endif" => is_chosen = true,
            _ if is_chosen => text.push_str(line),
            _ => {}
        }
    }
    text
}

/// Returns the WGSL declarations of constants that kernels share with Rust.
fn constants(has_quadrilaterals: bool) -> String {
    let mut text = String::new();
    let mut smoothing = SMOOTHING;
    if has_quadrilaterals {
        smoothing = OF_QUADRILATERALS;
        let _ = writeln!(text, "const OPPOSITE: u32 = {OPPOSITE}u;");
    }
    for (name, value) in [
        ("WORKGROUP", WORKGROUP),
        ("FINISH_WORKGROUP", FINISH_WORKGROUP),
        ("MOST_SUMMED", MOST_SUMMED),
        ("HISTORY", HISTORY),
        ("SLOTS", SLOTS as u32),
        ("MOST_METRICS", MOST_METRICS as u32),
        ("SLOT_VECTORS", SLOT_VECTORS as u32),
        ("INVERTED", INVERTED),
        ("WORST", WORST),
        ("MIN_NORMAL", MIN_NORMAL),
        ("HELD", HELD),
        ("NONE", NONE),
        ("TRIALS", SearchRule::SWEEP.trials),
        ("SEARCH_TRIALS", SEARCH_TRIALS),
        ("STEP_TRIALS", STEP_TRIALS),
        ("MOST_STEP_TRIALS", StepSearch::TRIALS),
        ("MOST_ITERATIONS", StepRequest::MOST_ITERATIONS),
        ("BISECTIONS", BISECTIONS),
        ("FALLS_OVER", ErrorBound::FALLS_OVER as u32),
        ("HALVINGS", HALVINGS),
        ("OFF_CURVE", OFF_CURVE),
        ("FREEZES_AFTER", FREEZES_AFTER.unsigned_abs().into()),
    ] {
        let _ = writeln!(text, "const {name}: u32 = {value}u;");
    }
    let _ = writeln!(text, "alias History = array<vec2f, {}>;", HISTORY * SLOTS as u32);
    for (stop, code) in Stop::CODES {
        let name = stop.name().to_uppercase().replace('-', "_");
        let _ = writeln!(text, "const STOP_{name}: u32 = {code}u;");
    }
    for (name, value) in [
        ("SUFFICIENT_DECREASE", SUFFICIENT_DECREASE),
        ("SHORTEN_INFEASIBLE", SearchRule::SWEEP.shorten_infeasible),
        ("SHORTEN", SearchRule::SWEEP.shorten),
        ("FLAT_EXPONENT", FLAT_EXPONENT),
        ("FLAT_RATIO", FLAT_RATIO),
        ("MIN_FLAT_SUM", MIN_FLAT_SUM),
        ("DIFFERENCE", line_search::DIFFERENCE),
        ("SLACK", SearchRule::SWEEP.slack),
        ("PENALTY", PENALTY),
        ("MIN_SQUARE", regularization::MIN_SQUARE),
        ("SQUARE_SHARE", regularization::SQUARE_SHARE),
        ("NOISE", NOISE),
        ("JITTER", JITTER),
        ("MIN_SCALE", MIN_SCALE),
        ("SMOOTHING", smoothing.into()),
        ("MIN_CURVATURE", MIN_CURVATURE),
        ("NO_GUARD", NO_GUARD),
        ("AT_DISC", AT_DISC),
        ("TINY", TINY),
        ("MIN_CIRCLE_CURVATURE", MIN_CIRCLE_CURVATURE),
        ("ALTITUDE_ERROR", ALTITUDE_ERROR),
        ("MAX_STEP_SHARE", MAX_STEP_SHARE),
        ("CURVE_ERROR", CURVE_ERROR),
        ("MIN_FIRST_LENGTH", MIN_FIRST_LENGTH),
        ("MAX_FIRST_LENGTH", MAX_FIRST_LENGTH),
        ("CLOSE", CLOSE),
        ("HIDDEN", HIDDEN),
        ("STIFFNESS", aggregation::STIFFNESS),
        ("FIRST_STEP", aggregation::CHEBYSHEV[0]),
        ("STEP_AGAIN", aggregation::CHEBYSHEV[1]),
        ("SECOND_STEP", aggregation::CHEBYSHEV[2]),
        ("LEAST_PIVOT", aggregation::LEAST_PIVOT),
        ("BELOW", ErrorBound::BELOW),
        ("FIRST_FALL", ErrorBound::FIRST_FALL),
        ("NEAR_LEAST", StepRequest::NEAR_LEAST),
    ] {
        let _ = writeln!(text, "const {name}: f32 = {value:?}f;");
    }
    text
}

/// Returns the formulas of metrics, with the functions that they call.
fn formulas(metrics: &[Metric]) -> String {
    let mut text = INVARIANTS.to_owned();
    if metrics.iter().any(|metric| metric.is_smooth() && !metric.is_of_invariants()) {
        text.push_str(ANGLES);
    }
    text.extend(metrics.iter().map(|metric| metric.properties().wgsl));
    text
}

/// Returns [`formulas`], with the term of opposite angles if a metric has the term and the kernel sees quadrilaterals.
fn formulas_of(composition: &Composition) -> String {
    let mut text = formulas(&composition.metrics);
    if joins_opposite_angles(composition) {
        text.push_str(OPPOSITE_ANGLES);
    }
    text
}

/// Returns the functions of the metric that a sweep minimizes, under the names that newton.wgsl calls.
fn active_metric(composition: &Composition) -> String {
    let Composition { metrics, derivatives, has_quadrilaterals } = composition;
    let weight = if *has_quadrilaterals { "corner_weight * " } else { "" };
    let Some(&metric) = metrics.first() else { return String::new() };
    let properties = metric.properties();
    let name = wgsl_name(metric);
    let mut text = formulas_of(composition);
    let (model, derivatives_of) = match (metric.is_of_invariants(), metric.is_smooth()) {
        (true, _) => (
            format!("{name}_value(invariants(t))"),
            format!("expansion(t, {name}_slopes(invariants(t)))"),
        ),
        (false, true) => (format!("{name}_excess(t)"), format!("{name}_derivatives(t)")),
        (false, false) => {
            text.push_str(PENALTY_SOURCE);
            ("smoothed_model(t)".to_owned(), "smoothed_derivatives(t)".to_owned())
        }
    };
    let _ = write!(
        text,
        "
const METRIC: u32 = {index}u;
const EIGENVALUE_FLOOR: f32 = {floor:?}f;
const IDEAL_SQUARED: f32 = {ideal:?}f;
const QUADRATIC: bool = {quadratic};
const SETTLED: f32 = {settled:?}f;
fn metric_model(t: Corner) -> f32 {{ return {weight}{model}; }}
",
        index = metric as u32,
        floor = properties.eigenvalue_floor,
        ideal = metric.ideal_squared(),
        quadratic = properties.quadratic,
        settled = match derivatives {
            Derivatives::Analytic => line_search::SETTLED,
            Derivatives::FiniteDifference => 0.0,
        },
    );
    match derivatives {
        Derivatives::Analytic => {
            let body = match has_quadrilaterals {
                true => format!("return weighted({derivatives_of});"),
                false => format!("return {derivatives_of};"),
            };
            let _ = write!(
                text,
                "fn metric_derivatives(t: Corner, width: f32) -> Derivatives {{ {body} }}
fn difference_width(p: Patch) -> f32 {{ return 0.0; }}
"
            );
        }
        Derivatives::FiniteDifference => {
            let displacements: Vec<String> = line_search::DISPLACEMENTS
                .iter()
                .map(|[x, y]| format!("vec2({x}.0f, {y}.0f)"))
                .collect();
            let _ = write!(
                text,
                "const DISPLACEMENTS = array<vec2<f32>, 16>({});
fn metric_derivatives(t: Corner, width: f32) -> Derivatives {{ return differences(t, width); }}
fn difference_width(p: Patch) -> f32 {{ return DIFFERENCE * least_height(p); }}
",
                displacements.join(", ")
            );
            text.push_str(FINITE_DIFFERENCE);
        }
    }
    text
}

/// Returns the function of a triangle that gives the derivatives of the metric by the invariants.
fn metric_slopes(composition: &Composition) -> String {
    let Some(&metric) = composition.metrics.first() else { return String::new() };
    let (formulas, name) = (metric.properties().wgsl, wgsl_name(metric));
    format!(
        "{INVARIANTS}{formulas}
fn metric_slopes(t: Corner) -> Slopes {{ return {name}_slopes(invariants(t)); }}
"
    )
}

/// Returns the eigenvalue floor for the energy of untangling: that of imr, as the energy is a variant of the inverse
/// mean ratio.
fn untangling_energy() -> String {
    let floor = Metric::Imr.properties().eigenvalue_floor;
    format!("const EIGENVALUE_FLOOR: f32 = {floor:?}f;\n")
}

/// Returns two functions of a triangle: `tracked_values`, which gives q² - ideal² of each metric and then 1 if the area
/// is not positive, and `shape_excess`, which gives imr² - 1.
fn tracked_metrics(composition: &Composition) -> String {
    let Composition { metrics, has_quadrilaterals, .. } = composition;
    let mut text = formulas_of(composition);
    let weight = if *has_quadrilaterals { "corner_weight * " } else { "" };
    let call = |&metric: &Metric| {
        let name = wgsl_name(metric);
        match metric.is_of_invariants() {
            true => format!("{weight}{name}_value(i)"),
            false => format!("{weight}{name}_excess(t)"),
        }
    };
    let mut calls: Vec<String> = metrics.iter().map(call).collect();
    calls.push("select(1.0, 0.0, is_positive(doubled_area(t)))".to_owned());
    let _ = write!(
        text,
        "const TRACKED: u32 = {count}u;
fn tracked_values(t: Corner) -> array<f32, TRACKED> {{
    let i = invariants(t);
    return array<f32, TRACKED>({calls});
}}
// The squared inverse mean ratio less one.
fn shape_excess(t: Corner) -> f32 {{
    let i = invariants(t);
    let m = i.excess / i.area;
    return m * (m + 2.0);
}}
",
        count = calls.len(),
        calls = calls.join(", ")
    );
    if joins_opposite_angles(composition) {
        let joins = |(i, metric): (usize, &Metric)| metric.joins_opposite_angles().then_some(i);
        let _ = writeln!(
            text,
            "
// Adds the share of two opposite corners in the term of opposite angles to the values of the metrics that have the term.
fn with_shares_of_opposite_angles(
    values: array<f32, TRACKED>,
    t: Corner,
    opposite: Corner,
) -> array<f32, TRACKED> {{
    var sums = values;
    let share = share_of_opposite_angles(t, opposite);"
        );
        for i in metrics.iter().enumerate().filter_map(joins) {
            let _ = writeln!(text, "    sums[{i}] += share;");
        }
        text.push_str("    return sums;\n}\n");
    }
    text
}

/// Returns the prefix of a metric's functions in WGSL.
fn wgsl_name(metric: Metric) -> String {
    metric.name().replace('-', "_")
}

/// Returns the WGSL constants that assign tracked sums to slots of the history.
fn tracked_slots(metrics: &[Metric]) -> String {
    let slots: Vec<String> = metrics
        .iter()
        .map(|&m| m as u32)
        .chain([INVERTED, WORST])
        .map(|slot| format!("{slot}u"))
        .collect();
    format!(
        "const TRACKED: u32 = {summed}u;
const TRACKED_SLOTS = array<u32, {count}>({slots});
",
        summed = slots.len() - 1,
        count = slots.len(),
        slots = slots.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_tells_which_kernels_differ_for_quadrilaterals() {
        for kernel in Kernel::all() {
            let differs = kernel.wgsl() != kernel.wgsl_for_quadrilaterals();
            assert_eq!(differs, kernel.row().sees_quadrilaterals, "{}", kernel.label());
            assert!(
                !kernel.wgsl().contains('#') && !kernel.wgsl_for_quadrilaterals().contains('#')
            );
        }
    }

    #[test]
    fn lines_are_chosen_between_directives() {
        let source =
            "a\n#if QUADRILATERALS\nb\n#else\nc\n#endif\nd\n#if !QUADRILATERALS\ne\n#endif\n";
        assert_eq!(chosen(source, true, false), "a\nb\nd\n");
        assert_eq!(chosen(source, false, false), "a\nc\nd\ne\n");
        let source = "#if OPPOSITE_ANGLES\na\n#else\nb\n#endif\n";
        assert_eq!([true, false].map(|joins| chosen(source, true, joins)), ["a\n", "b\n"]);
    }
}
