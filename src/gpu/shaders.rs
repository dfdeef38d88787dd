//! The kernels: one table of what there is, and the composition of their WGSL.

use std::fmt::Write;

use super::layout::{FINISH_WORKGROUP, HELD, HISTORY, INVERTED, SLOTS, WORKGROUP};
use crate::metric::Metric;
use crate::plan::{Derivatives, NOISE, Stop, line_search};

const COMMON: &str = include_str!("../../shaders/common.wgsl");
const PAIRS: &str = include_str!("../../shaders/pairs.wgsl");
const CONTROL: &str = include_str!("../../shaders/control.wgsl");
const PATCH: &str = include_str!("../../shaders/patch.wgsl");
const NEWTON: &str = include_str!("../../shaders/newton.wgsl");
const FINITE_DIFFERENCE: &str = include_str!("../../shaders/finite_difference.wgsl");
const OBJECTIVE: &str = include_str!("../../shaders/objective.wgsl");
const FINISH: &str = include_str!("../../shaders/finish.wgsl");
const KEEP_BEST: &str = include_str!("../../shaders/keep_best.wgsl");
const EXCHANGE: &str = include_str!("../../shaders/exchange.wgsl");
const IMPORT: &str = include_str!("../../shaders/import.wgsl");
const EXPORT: &str = include_str!("../../shaders/export.wgsl");
const PUBLISH: &str = include_str!("../../shaders/publish.wgsl");

/// A compute kernel: one WGSL module in core WebGPU, with the bindings of its [`Interface`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Newton steps on the free vertices of one color.
    Sweep(Metric, Derivatives),
    /// Partial sums of the objectives of these metrics.
    Objective(Vec<Metric>),
    /// Completes the sums of these metrics, and judges.
    Finish(Vec<Metric>),
    /// Keeps the positions if they are the best so far.
    KeepBest,
    /// Takes positions from an application's vertex buffer.
    Import,
    /// Writes positions to an application's vertex buffer.
    Export,
    /// Writes objectives to an application's buffer.
    Publish,
}

/// What a kernel binds as group 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interface {
    /// A run on a mesh: `shaders/common.wgsl`.
    Run,
    /// A mesh and a vertex buffer: `shaders/exchange.wgsl`.
    Exchange,
    /// A run's history and a buffer: `shaders/publish.wgsl`.
    Publish,
}

impl Kernel {
    /// The name of the entry point.
    pub fn entry_point(&self) -> &'static str {
        match self {
            Kernel::Sweep(..) => "sweep",
            Kernel::Objective(_) => "objective",
            Kernel::Finish(_) => "finish",
            Kernel::KeepBest => "keep_best",
            Kernel::Import => "import_positions",
            Kernel::Export => "export_positions",
            Kernel::Publish => "publish",
        }
    }

    /// What it binds.
    pub fn interface(&self) -> Interface {
        match self {
            Kernel::Import | Kernel::Export => Interface::Exchange,
            Kernel::Publish => Interface::Publish,
            _ => Interface::Run,
        }
    }

    /// A label for tools such as RenderDoc.
    pub fn label(&self) -> String {
        match self {
            Kernel::Sweep(metric, Derivatives::Analytic) => format!("gpu-smooth sweep {metric}"),
            Kernel::Sweep(metric, Derivatives::FiniteDifference) => {
                format!("gpu-smooth sweep {metric}, finite differences")
            }
            _ => format!("gpu-smooth {}", self.entry_point()),
        }
    }

    /// The complete WGSL module.
    pub fn wgsl(&self) -> String {
        let mut source = constants();
        match self.interface() {
            Interface::Run => {
                [COMMON, CONTROL, PAIRS].iter().for_each(|part| source.push_str(part))
            }
            Interface::Exchange => [PAIRS, EXCHANGE].iter().for_each(|part| source.push_str(part)),
            Interface::Publish => source.push_str(CONTROL),
        }
        match self {
            Kernel::Sweep(metric, derivatives) => {
                source.push_str(PATCH);
                source.push_str(&active_metric(*metric, *derivatives));
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
        }
        source
    }
}

/// Constants shared with Rust.
fn constants() -> String {
    let mut text = String::new();
    for (name, value) in [
        ("WORKGROUP", WORKGROUP),
        ("FINISH_WORKGROUP", FINISH_WORKGROUP),
        ("HISTORY", HISTORY),
        ("SLOTS", SLOTS as u32),
        ("INVERTED", INVERTED),
        ("HELD", HELD),
        ("HISTORY_LENGTH", HISTORY * SLOTS as u32),
        ("TRIALS", line_search::TRIALS),
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
        ("DIFFERENCE", line_search::DIFFERENCE),
        ("SLACK", line_search::SLACK),
        ("NOISE", NOISE),
    ] {
        let _ = writeln!(text, "const {name}: f32 = {value:?}f;");
    }
    text
}

/// The metric a sweep minimizes, under the names newton.wgsl calls.
fn active_metric(metric: Metric, derivatives: Derivatives) -> String {
    let properties = metric.properties();
    let name = metric.name();
    let guard = properties.shape_guard * (1.0 - line_search::GUARD_RESERVE);
    let mut text = properties.wgsl.to_owned();
    let _ = write!(
        text,
        "
const METRIC: u32 = {index}u;
const EIGENVALUE_FLOOR: f32 = {floor:?}f;
const IDEAL_SQUARED: f32 = {ideal:?}f;
const QUADRATIC: bool = {quadratic};
const GUARDED: bool = {guarded};
const SHAPE_GUARD: f32 = {guard:?}f;
const SETTLED: f32 = {settled:?}f;
fn metric_model(t: Corner) -> f32 {{ return {name}_model(t); }}
",
        index = metric as u32,
        floor = properties.eigenvalue_floor,
        ideal = metric.ideal_squared(),
        quadratic = properties.quadratic,
        guarded = guard.is_finite(),
        guard = if guard.is_finite() { guard } else { 0.0 },
        settled = match derivatives {
            Derivatives::Analytic => line_search::SETTLED,
            Derivatives::FiniteDifference => 0.0,
        },
    );
    match derivatives {
        Derivatives::Analytic => {
            let _ = write!(
                text,
                "fn metric_derivatives(t: Corner, width: f32) -> Derivatives {{ return {name}_derivatives(t); }}
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

/// The formulas of the tracked metrics, evaluated together, and whether the triangle is inverted.
fn tracked_metrics(metrics: &[Metric]) -> String {
    let mut text: String = metrics.iter().map(|m| m.properties().wgsl).collect();
    let mut calls: Vec<String> = metrics.iter().map(|m| format!("{m}_excess(t)")).collect();
    calls.push("select(0.0, 1.0, doubled_area(t) <= 0.0)".to_owned());
    let _ = write!(
        text,
        "const TRACKED: u32 = {count}u;
fn tracked_values(t: Corner) -> array<f32, TRACKED> {{
    return array<f32, TRACKED>({calls});
}}
",
        count = calls.len(),
        calls = calls.join(", ")
    );
    text
}

/// Which slots the tracked sums belong to.
fn tracked_slots(metrics: &[Metric]) -> String {
    let slots: Vec<String> = metrics
        .iter()
        .map(|&m| m as u32)
        .chain([INVERTED])
        .map(|slot| format!("{slot}u"))
        .collect();
    format!(
        "const TRACKED: u32 = {count}u;
const TRACKED_SLOTS = array<u32, {count}>({slots});
",
        count = slots.len(),
        slots = slots.join(", ")
    )
}
