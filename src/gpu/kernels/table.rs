//! The table of the kernels there are, and what each binds.

use crate::metric::Metric;
use crate::run::{Derivatives, Plan};

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
    /// The gradient of Σ q² at the free vertices.
    Gradient(Metric),
    /// The same, smoothed.
    SmoothGradient,
    /// From the free vertices to the aggregates of the first coarse level.
    HandDown,
    /// And back.
    HandUp,
    /// A matrix times a vector, plus a vector.
    Apply,
    /// A smoothing step on a coarse level.
    Chebyshev,
    /// The solution on the coarsest level.
    Direct,
    /// Partial sums of the objective along a correction.
    Along(Metric),
    /// Completes these sums.
    Total,
    /// Moves the vertices along a correction.
    Take,
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
    /// A mesh that is corrected: `shaders/levels/fine.wgsl`.
    Fine,
    /// Between a mesh and the first coarse level: `shaders/levels/transfer.wgsl`.
    Transfer,
    /// The coarse levels: `shaders/levels/coarse.wgsl`.
    Coarse,
}

impl Interface {
    pub(crate) const ALL: [Self; 6] = [
        Interface::Run,
        Interface::Exchange,
        Interface::Publish,
        Interface::Fine,
        Interface::Transfer,
        Interface::Coarse,
    ];

    /// How its kernels see the positions: as one if not at all.
    pub(crate) fn sees(self, positions: Positions) -> Positions {
        match self {
            Interface::Run | Interface::Exchange | Interface::Fine => positions,
            Interface::Publish | Interface::Transfer | Interface::Coarse => Positions::Whole,
        }
    }
}

/// How kernels see the positions of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Positions {
    /// As one binding.
    Whole,
    /// High parts and low parts by themselves, where a device binds less than the buffer at once.
    InTwo,
}

impl Positions {
    pub(crate) const ALL: [Self; 2] = [Positions::Whole, Positions::InTwo];

    /// Those of so many vertices.
    pub(crate) fn of(vertices: usize, limits: &wgpu::Limits) -> Self {
        let bytes = (vertices as u64).saturating_mul(size_of::<[f32; 4]>() as u64);
        let fits = bytes <= limits.max_storage_buffer_binding_size;
        if fits { Positions::Whole } else { Positions::InTwo }
    }
}

impl Kernel {
    /// Every kernel that a plan and what belongs to it may need, on an application's device or in a run.
    pub(crate) fn needed_by(plan: &Plan) -> Vec<Kernel> {
        let sweeps =
            plan.scheme.metrics().iter().map(|&m| Kernel::Sweep(m, plan.derivatives[m as usize]));
        let mut kernels: Vec<_> = sweeps.collect();
        kernels.extend([Kernel::Objective(plan.tracked()), Kernel::Finish(plan.tracked())]);
        kernels.extend([Kernel::KeepBest, Kernel::Import, Kernel::Export, Kernel::Publish]);
        kernels
    }

    /// Every kernel that corrections from coarser levels take.
    pub(crate) fn of_levels(metric: Metric) -> Vec<Kernel> {
        let of_metric = [Kernel::Gradient(metric), Kernel::Along(metric)];
        let others = [
            Kernel::SmoothGradient,
            Kernel::HandDown,
            Kernel::HandUp,
            Kernel::Apply,
            Kernel::Chebyshev,
            Kernel::Direct,
            Kernel::Total,
            Kernel::Take,
        ];
        of_metric.into_iter().chain(others).collect()
    }

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
            Kernel::Gradient(_) => "find_gradient",
            Kernel::SmoothGradient => "smooth_gradient",
            Kernel::HandDown => "hand_down",
            Kernel::HandUp => "hand_up",
            Kernel::Apply => "apply",
            Kernel::Chebyshev => "chebyshev",
            Kernel::Direct => "direct",
            Kernel::Along(_) => "along",
            Kernel::Total => "total",
            Kernel::Take => "take",
        }
    }

    /// What it binds.
    pub fn interface(&self) -> Interface {
        match self {
            Kernel::Import | Kernel::Export => Interface::Exchange,
            Kernel::Publish => Interface::Publish,
            Kernel::Sweep(..) | Kernel::Objective(_) | Kernel::Finish(_) | Kernel::KeepBest => {
                Interface::Run
            }
            Kernel::Gradient(_) | Kernel::Along(_) | Kernel::Take => Interface::Fine,
            Kernel::SmoothGradient | Kernel::HandDown | Kernel::HandUp => Interface::Transfer,
            Kernel::Apply | Kernel::Chebyshev | Kernel::Direct | Kernel::Total => Interface::Coarse,
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
}
