//! The WGSL of each kernel, composed from the files in `shaders/`.

use std::fmt::Write;

use crate::gpu::kernels::table::{Interface, Kernel, MeshForm, Positions};
use crate::gpu::kernels::uniforms::{
    FINISH_WORKGROUP, HELD, HISTORY, INVERTED, LEAST_NORMAL, NO_GUARD, SEARCH_TRIALS, SLOTS,
    WORKGROUP, WORST,
};
use crate::metric::Metric;
use crate::metric::smoothing::PENALTY;
use crate::run::multilevel::search::{CLOSE, MOST_FIRST};
use crate::run::multilevel::{LEAST_FIRST, NONE, SMOOTHING};
use crate::run::secant::LEAST_CURVATURE;
use crate::run::{Derivatives, Stop};
use crate::run::{JITTER, LEAST_SCALE, NOISE, line_search, regularization};

const COMMON: &str = include_str!("../../../shaders/common.wgsl");
const POSITIONS: &str = include_str!("../../../shaders/positions.wgsl");
const POSITIONS_IN_TWO: &str = include_str!("../../../shaders/positions_in_two.wgsl");
const PAIRS: &str = include_str!("../../../shaders/pairs.wgsl");
const PARAMS: &str = include_str!("../../../shaders/params.wgsl");
const CONTROL: &str = include_str!("../../../shaders/control.wgsl");
const INVARIANTS: &str = include_str!("../../../shaders/invariants.wgsl");
const PATCH: &str = include_str!("../../../shaders/patch.wgsl");
const ONE_RING: &str = include_str!("../../../shaders/one_ring.wgsl");
const DESCENT: &str = include_str!("../../../shaders/descent.wgsl");
const NEWTON: &str = include_str!("../../../shaders/newton.wgsl");
const PENALTY_SOURCE: &str = include_str!("../../../shaders/penalty.wgsl");
const FINITE_DIFFERENCE: &str = include_str!("../../../shaders/finite_difference.wgsl");
const MAPS: &str = include_str!("../../../shaders/maps.wgsl");
const TARGETS: &str = include_str!("../../../shaders/targets.wgsl");
const NO_TARGETS: &str = include_str!("../../../shaders/no_targets.wgsl");
const OBJECTIVE: &str = include_str!("../../../shaders/objective.wgsl");
const FINISH: &str = include_str!("../../../shaders/finish.wgsl");
const KEEP_BEST: &str = include_str!("../../../shaders/keep_best.wgsl");
const EXCHANGE: &str = include_str!("../../../shaders/exchange.wgsl");
const IMPORT: &str = include_str!("../../../shaders/import.wgsl");
const EXPORT: &str = include_str!("../../../shaders/export.wgsl");
const PUBLISH: &str = include_str!("../../../shaders/publish.wgsl");
const JUDGED: &str = include_str!("../../../shaders/judged/common.wgsl");
const REOPEN: &str = include_str!("../../../shaders/judged/reopen.wgsl");
const RESUME: &str = include_str!("../../../shaders/judged/resume.wgsl");
const RESTORE: &str = include_str!("../../../shaders/restore.wgsl");
const MASK: &str = include_str!("../../../shaders/mask.wgsl");
const MOVEMENT: &str = include_str!("../../../shaders/clamp/common.wgsl");
const FIND_SHARE: &str = include_str!("../../../shaders/clamp/find_share.wgsl");
const MOVE_VERTICES: &str = include_str!("../../../shaders/clamp/move_vertices.wgsl");
const TANGLE: &str = include_str!("../../../shaders/untangle/common.wgsl");
const FIND_INVERTED: &str = include_str!("../../../shaders/untangle/find_inverted.wgsl");
const REGULARIZE: &str = include_str!("../../../shaders/untangle/regularize.wgsl");
const ENERGY: &str = include_str!("../../../shaders/untangle/energy.wgsl");
const UNTANGLE: &str = include_str!("../../../shaders/untangle/untangle.wgsl");
const CHECK_ARITHMETIC: &str = include_str!("../../../shaders/check_arithmetic.wgsl");

const LEVELS: &str = include_str!("../../../shaders/levels/common.wgsl");
const FINE: &str = include_str!("../../../shaders/levels/fine.wgsl");
const TRANSFER: &str = include_str!("../../../shaders/levels/transfer.wgsl");
const COARSE: &str = include_str!("../../../shaders/levels/coarse.wgsl");
const GRADIENT: &str = include_str!("../../../shaders/levels/gradient.wgsl");
const SMOOTH_GRADIENT: &str = include_str!("../../../shaders/levels/smooth_gradient.wgsl");
const RESTRICT: &str = include_str!("../../../shaders/levels/restrict.wgsl");
const NEIGHBORS: &str = include_str!("../../../shaders/levels/neighbors.wgsl");
const PROLONG: &str = include_str!("../../../shaders/levels/prolong.wgsl");
const MATRIX_VECTOR: &str = include_str!("../../../shaders/levels/matrix_vector.wgsl");
const CHEBYSHEV: &str = include_str!("../../../shaders/levels/chebyshev.wgsl");
const COARSEST_SOLVE: &str = include_str!("../../../shaders/levels/coarsest_solve.wgsl");
const OBJECTIVE_ALONG_CORRECTION: &str =
    include_str!("../../../shaders/levels/objective_along_correction.wgsl");
const SUM_ALONG_CORRECTION: &str =
    include_str!("../../../shaders/levels/sum_along_correction.wgsl");
const MOVE_ALONG_CORRECTION: &str =
    include_str!("../../../shaders/levels/move_along_correction.wgsl");
const MOVED: &str = include_str!("../../../shaders/levels/moved.wgsl");
const FIND_BROKEN: &str = include_str!("../../../shaders/levels/find_broken.wgsl");
const LEAVE_OUT_BROKEN: &str = include_str!("../../../shaders/levels/leave_out_broken.wgsl");
const AROUND: &str = include_str!("../../../shaders/levels/around.wgsl");
const ALONG: &str = include_str!("../../../shaders/levels/along.wgsl");
const STIFFNESS: &str = include_str!("../../../shaders/levels/stiffness.wgsl");

const SEARCH_PLACES: &str = include_str!("../../../shaders/search/places.wgsl");
const SEARCH: &str = include_str!("../../../shaders/search/common.wgsl");
const BEGIN_SEARCH: &str = include_str!("../../../shaders/search/begin_search.wgsl");
const JUDGE_TRIAL: &str = include_str!("../../../shaders/search/judge_trial.wgsl");

const SECANTS: &str = include_str!("../../../shaders/secants/common.wgsl");
const CLOSE_SECANT: &str = include_str!("../../../shaders/secants/close.wgsl");
const SUM_SECANTS: &str = include_str!("../../../shaders/secants/sum_secants.wgsl");
const BEND_GRADIENT: &str = include_str!("../../../shaders/secants/bend_gradient.wgsl");
const MULTIPLY_CORRECTION: &str = include_str!("../../../shaders/secants/multiply_correction.wgsl");
const OPEN_SECANT: &str = include_str!("../../../shaders/secants/open.wgsl");

impl Kernel {
    /// Returns the complete WGSL module.
    pub fn wgsl(&self) -> String {
        self.composed(Positions::Whole.into())
    }

    /// Returns the complete WGSL module for a mesh whose positions take two bindings, as they are more than the device
    /// binds at once.
    pub fn wgsl_for_large_meshes(&self) -> String {
        self.composed(Positions::InTwo.into())
    }

    /// Returns the complete WGSL module for a mesh with targets.
    pub fn wgsl_for_targets(&self) -> String {
        self.composed(MeshForm { positions: Positions::Whole, has_targets: true })
    }

    pub(crate) fn composed(&self, form: MeshForm) -> String {
        let mut source = constants();
        let (parts, bindings): (&[&str], _) = match self.interface() {
            Interface::Run => (&[PARAMS, COMMON, CONTROL, PAIRS], Some((2, 9))),
            Interface::Exchange => (&[PAIRS, EXCHANGE], Some((1, 5))),
            Interface::Publish => (&[CONTROL], None),
            Interface::Reopen => (&[CONTROL, JUDGED], None),
            Interface::Mask => (&[], None),
            Interface::Restore => (&[CONTROL, PAIRS], Some((1, 5))),
            Interface::Move => (&[PAIRS, PATCH, MOVEMENT], Some((1, 7))),
            Interface::Untangle => (&[PARAMS, TANGLE, PAIRS, PATCH], Some((2, 9))),
            Interface::Fine => (&[PARAMS, LEVELS, SEARCH_PLACES, FINE, PAIRS, PATCH], Some((2, 9))),
            Interface::Transfer => (&[PARAMS, LEVELS, SEARCH_PLACES, TRANSFER, PAIRS], None),
            Interface::Coarse => (&[PARAMS, LEVELS, SEARCH_PLACES, COARSE, PAIRS], None),
            Interface::Search => (&[PARAMS, CONTROL, SEARCH_PLACES, SEARCH, PAIRS], None),
            Interface::Secants => (&[PARAMS, PAIRS, PATCH, SECANTS], Some((2, 9))),
            Interface::Arithmetic => (&[PARAMS, PAIRS, PATCH], None),
        };
        parts.iter().for_each(|part| source.push_str(part));
        if let Some((first, second)) = bindings {
            let _ = writeln!(source, "const POSITIONS: u32 = {first}u;");
            let _ = writeln!(source, "const LOW_POSITIONS: u32 = {second}u;");
            source.push_str(match form.positions {
                Positions::Whole => POSITIONS,
                Positions::InTwo => POSITIONS_IN_TWO,
            });
        }
        if self.sees_targets() {
            source.push_str(if form.has_targets { TARGETS } else { NO_TARGETS });
            source.push_str(MAPS);
        }
        match self {
            Kernel::Sweep(metric, derivatives) => {
                source.push_str(PATCH);
                source.push_str(ONE_RING);
                source.push_str(&active_metric(*metric, *derivatives));
                source.push_str(DESCENT);
                source.push_str(NEWTON);
            }
            Kernel::Objective(metrics) => {
                source.push_str(PATCH);
                source.push_str(&tracked_metrics(metrics));
                source.push_str(OBJECTIVE);
            }
            Kernel::Finish(metrics) => {
                source.push_str(&tracked_slots(metrics));
                source.push_str(FINISH);
            }
            Kernel::KeepBest => source.push_str(KEEP_BEST),
            Kernel::Import => source.push_str(IMPORT),
            Kernel::Export => source.push_str(EXPORT),
            Kernel::Publish => source.push_str(PUBLISH),
            Kernel::Reopen => source.push_str(REOPEN),
            Kernel::Resume => source.push_str(RESUME),
            Kernel::RestoreLastValid => source.push_str(RESTORE),
            Kernel::HoldByMask => source.push_str(MASK),
            Kernel::FindShare => source.push_str(FIND_SHARE),
            Kernel::MoveVertices => source.push_str(MOVE_VERTICES),
            Kernel::FindInverted => source.push_str(FIND_INVERTED),
            Kernel::Regularize => source.push_str(REGULARIZE),
            Kernel::Untangle => {
                // The energy is a variant of the inverse mean ratio.
                let floor = Metric::Imr.properties().eigenvalue_floor;
                let _ = writeln!(source, "const EIGENVALUE_FLOOR: f32 = {floor:?}f;");
                let parts = [ONE_RING, DESCENT, ENERGY, UNTANGLE];
                parts.iter().for_each(|part| source.push_str(part));
            }
            Kernel::Gradient(metric)
            | Kernel::Stiffness(metric)
            | Kernel::ObjectiveAlongCorrection(metric) => {
                source.push_str(ONE_RING);
                source.push_str(&active_metric(*metric, Derivatives::Analytic));
                let parts: &[&str] = match self {
                    Kernel::ObjectiveAlongCorrection(_) => {
                        &[ALONG, MOVED, OBJECTIVE_ALONG_CORRECTION]
                    }
                    Kernel::Stiffness(_) => &[AROUND, STIFFNESS],
                    _ => &[AROUND, GRADIENT],
                };
                parts.iter().for_each(|part| source.push_str(part));
            }
            Kernel::BeginSearch => source.push_str(BEGIN_SEARCH),
            Kernel::JudgeTrial => source.push_str(JUDGE_TRIAL),
            Kernel::CloseSecant => source.push_str(CLOSE_SECANT),
            Kernel::SumSecants => source.push_str(SUM_SECANTS),
            Kernel::BendGradient => source.push_str(BEND_GRADIENT),
            Kernel::MultiplyCorrection => source.push_str(MULTIPLY_CORRECTION),
            Kernel::OpenSecant => source.push_str(OPEN_SECANT),
            Kernel::SmoothGradient => {
                [NEIGHBORS, SMOOTH_GRADIENT].iter().for_each(|part| source.push_str(part))
            }
            Kernel::Restrict => source.push_str(RESTRICT),
            Kernel::Prolong => [NEIGHBORS, PROLONG].iter().for_each(|part| source.push_str(part)),
            Kernel::MatrixVector => source.push_str(MATRIX_VECTOR),
            Kernel::Chebyshev => source.push_str(CHEBYSHEV),
            Kernel::CoarsestSolve => source.push_str(COARSEST_SOLVE),
            Kernel::SumAlongCorrection => source.push_str(SUM_ALONG_CORRECTION),
            Kernel::MoveAlongCorrection => {
                [ALONG, MOVE_ALONG_CORRECTION].iter().for_each(|part| source.push_str(part))
            }
            Kernel::FindBroken => {
                [ONE_RING, ALONG, MOVED, FIND_BROKEN].iter().for_each(|part| source.push_str(part))
            }
            Kernel::LeaveOutBroken => source.push_str(LEAVE_OUT_BROKEN),
            Kernel::CheckArithmetic => source.push_str(CHECK_ARITHMETIC),
        }
        source
    }
}

/// Returns the constants that kernels share with Rust.
fn constants() -> String {
    let mut text = String::new();
    for (name, value) in [
        ("WORKGROUP", WORKGROUP),
        ("FINISH_WORKGROUP", FINISH_WORKGROUP),
        ("HISTORY", HISTORY),
        ("SLOTS", SLOTS as u32),
        ("SLOT_VECTORS", SLOTS.div_ceil(4) as u32),
        ("INVERTED", INVERTED),
        ("WORST", WORST),
        ("LEAST_NORMAL", LEAST_NORMAL),
        ("HELD", HELD),
        ("NONE", NONE),
        ("HISTORY_LENGTH", HISTORY * SLOTS as u32),
        ("TRIALS", line_search::TRIALS),
        ("SEARCH_TRIALS", SEARCH_TRIALS),
    ] {
        let _ = writeln!(text, "const {name}: u32 = {value}u;");
    }
    for (stop, code) in Stop::CODES {
        let name = stop.name().to_uppercase().replace('-', "_");
        let _ = writeln!(text, "const STOP_{name}: u32 = {code}u;");
    }
    for (name, value) in [
        ("SUFFICIENT_DECREASE", line_search::SUFFICIENT_DECREASE),
        ("SHORTEN_INFEASIBLE", line_search::SHORTEN_INFEASIBLE),
        ("SHORTEN", line_search::SHORTEN),
        ("BENT", line_search::BENT),
        ("MOSTLY_FLAT", line_search::MOSTLY_FLAT),
        ("LEAST_FLAT", line_search::LEAST_FLAT),
        ("DIFFERENCE", line_search::DIFFERENCE),
        ("SLACK", line_search::SLACK),
        ("PENALTY", PENALTY),
        ("LEAST_SQUARE", regularization::LEAST_SQUARE),
        ("SQUARE_SHARE", regularization::SQUARE_SHARE),
        ("NOISE", NOISE),
        ("JITTER", JITTER),
        ("LEAST_SCALE", LEAST_SCALE),
        ("SMOOTHING", SMOOTHING.into()),
        ("LEAST_CURVATURE", LEAST_CURVATURE),
        ("NO_GUARD", NO_GUARD),
        ("LEAST_FIRST", LEAST_FIRST),
        ("MOST_FIRST", MOST_FIRST),
        ("CLOSE", CLOSE),
    ] {
        let _ = writeln!(text, "const {name}: f32 = {value:?}f;");
    }
    text
}

/// Returns the functions of the metric that a sweep minimizes, under the names that newton.wgsl calls.
fn active_metric(metric: Metric, derivatives: Derivatives) -> String {
    let properties = metric.properties();
    let name = wgsl_name(metric);
    let mut text = INVARIANTS.to_owned() + properties.wgsl;
    let (model, derivatives_of) = match metric.is_smooth() {
        true => (
            format!("{name}_value(invariants(t))"),
            format!("expansion(t, {name}_slopes(invariants(t)))"),
        ),
        false => {
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
fn metric_model(t: Corner) -> f32 {{ return {model}; }}
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
            let _ = write!(
                text,
                "fn metric_derivatives(t: Corner, width: f32) -> Derivatives {{ return {derivatives_of}; }}
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

/// Returns two functions of a triangle: `tracked_values`, which gives q² - ideal² of each metric and then 1 if the area
/// is not positive, and `shape_excess`, which gives imr² - 1.
fn tracked_metrics(metrics: &[Metric]) -> String {
    let mut text = INVARIANTS.to_owned();
    text.extend(metrics.iter().map(|m| m.properties().wgsl));
    let call = |&metric: &Metric| {
        let name = wgsl_name(metric);
        if metric.is_smooth() { format!("{name}_value(i)") } else { format!("{name}_excess(t)") }
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
    text
}

/// Returns the prefix of a metric's functions in WGSL.
fn wgsl_name(metric: Metric) -> String {
    metric.name().replace('-', "_")
}

/// Returns the slots of the history that the tracked sums belong to.
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
