//! The kernels: their entry points, labels and bindings.

use crate::metric::Metric;
use crate::run::{Derivatives, Plan};

/// A compute kernel: one WGSL module in core WebGPU, with the bindings of its [`Interface`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Newton steps on the free vertices of one color.
    Sweep(Metric, Derivatives),
    /// Partial sums of the objectives of these metrics over the triangles.
    Objective(Vec<Metric>),
    /// Completes the sums of [`Objective`](Self::Objective) and decides whether the run ends.
    Finish(Vec<Metric>),
    /// Keeps a copy of the positions if they are the best so far.
    KeepBest,
    /// Reads positions from an application's vertex buffer.
    Import,
    /// Writes positions to an application's vertex buffer.
    Export,
    /// Writes objectives to an application's buffer.
    Publish,
    /// Makes judged sweeps begin again if an application has changed the mesh.
    Reopen,
    /// Lets judged sweeps continue after [`Reopen`](Self::Reopen) and the evaluation that follows it.
    Resume,
    /// Saves the positions of a valid mesh, and restores the saved ones if the mesh is not valid.
    RestoreLastValid,
    /// Holds vertices by a mask of the application.
    HoldByMask,
    /// Finds the share of its way that an application's move can go before a triangle gets inverted or too flat.
    FindShare,
    /// Moves vertices by the share that [`FindShare`](Self::FindShare) has found.
    MoveVertices,
    /// Finds the triangles that are inverted, and the most inverted one.
    FindInverted,
    /// Begins an untangling sweep if [`FindInverted`](Self::FindInverted) has found inverted triangles.
    Regularize,
    /// Newton steps that untangle, on the free vertices of one color.
    Untangle,
    /// The gradient of Σ q² at the free vertices.
    Gradient(Metric),
    /// Smooths the result of [`Gradient`](Self::Gradient) over the one-rings, before [`Restrict`](Self::Restrict).
    SmoothGradient,
    /// Sums the smoothed gradient over each aggregate: from the free vertices to the first coarse level.
    Restrict,
    /// Interpolates the coarse solution: from the first coarse level to a correction of the free vertices.
    Prolong,
    /// A matrix times a vector, plus a vector, on a coarse level.
    MatrixVector,
    /// One step of Chebyshev's iteration on a coarse level.
    Chebyshev,
    /// Solves on the coarsest level, by the inverse matrix times the right-hand side.
    CoarsestSolve,
    /// Partial sums of the objective before and after a step along the correction, and of its slope along it.
    ObjectiveAlongCorrection(Metric),
    /// Completes the sums of [`ObjectiveAlongCorrection`](Self::ObjectiveAlongCorrection).
    SumAlongCorrection,
    /// Moves the free vertices along the correction.
    MoveAlongCorrection,
    /// Finds the vertices of triangles that the correction would invert or make break the shape guard.
    FindBroken,
    /// Leaves the vertices found by [`FindBroken`](Self::FindBroken) out of the correction.
    LeaveOutBroken,
    /// Begins the line search of a correction that an application encodes.
    BeginSearch,
    /// Judges a trial of the line search that [`BeginSearch`](Self::BeginSearch) began, and chooses the next length.
    JudgeTrial,
    /// The square root of the stiffness at the free vertices, from which the coarser levels are built.
    Stiffness(Metric),
    /// Completes the open secant pair, with partial sums of its products.
    CloseSecant,
    /// Completes the sums of products of secant pairs.
    SumSecants,
    /// Subtracts what the secant pairs account for from the gradient, before the levels are applied.
    BendGradient,
    /// Partial sums of products of secant pairs with the correction.
    MultiplyCorrection,
    /// Completes a correction by the secant pairs, and opens the next pair.
    OpenSecant,
    /// Checks the arithmetic of the adapter on inputs where a compiler that reorders sums loses digits.
    CheckArithmetic,
}

/// The bindings of a kernel, all in group 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interface {
    /// A run on a mesh: `shaders/common.wgsl`.
    Run,
    /// A mesh and a vertex buffer: `shaders/exchange.wgsl`.
    Exchange,
    /// A run's history and a buffer: `shaders/publish.wgsl`.
    Publish,
    /// The control of judged sweeps, and the changes of a mesh: `shaders/judged/common.wgsl`.
    Reopen,
    /// A mesh, and its positions when it was valid: `shaders/restore.wgsl`.
    Restore,
    /// Which vertices are held, and a mask of the application: `shaders/mask.wgsl`.
    Mask,
    /// A mesh and vertices of it that an application moves: `shaders/clamp/common.wgsl`.
    Move,
    /// A mesh and its inverted triangles: `shaders/untangle/common.wgsl`.
    Untangle,
    /// A mesh, its gradient and its correction: `shaders/levels/fine.wgsl`.
    Fine,
    /// A mesh and the first coarse level: `shaders/levels/transfer.wgsl`.
    Transfer,
    /// The coarse levels: `shaders/levels/coarse.wgsl`.
    Coarse,
    /// The control of an application's sweeps, and the state of a line search: `shaders/search/common.wgsl`.
    Search,
    /// Secant pairs of a mesh: `shaders/secants/common.wgsl`.
    Secants,
    /// Inputs and results of [`Kernel::CheckArithmetic`]: `shaders/check_arithmetic.wgsl`.
    Arithmetic,
}

impl Interface {
    pub(crate) const ALL: [Self; 14] = [
        Interface::Run,
        Interface::Exchange,
        Interface::Publish,
        Interface::Reopen,
        Interface::Restore,
        Interface::Mask,
        Interface::Move,
        Interface::Untangle,
        Interface::Fine,
        Interface::Transfer,
        Interface::Coarse,
        Interface::Search,
        Interface::Secants,
        Interface::Arithmetic,
    ];

    /// How the kernels of this interface bind the positions, given the form `positions` that the mesh needs. Interfaces
    /// without positions have one form only.
    pub(crate) fn sees(self, positions: Positions) -> Positions {
        match self {
            Interface::Run
            | Interface::Exchange
            | Interface::Move
            | Interface::Restore
            | Interface::Untangle
            | Interface::Fine
            | Interface::Secants => positions,
            Interface::Publish
            | Interface::Reopen
            | Interface::Mask
            | Interface::Transfer
            | Interface::Coarse
            | Interface::Search
            | Interface::Arithmetic => Positions::Whole,
        }
    }
}

/// How kernels bind the positions of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Positions {
    /// As one binding.
    Whole,
    /// As two bindings, one of high parts and one of low parts, for a buffer larger than the device binds at once.
    InTwo,
}

impl Positions {
    pub(crate) const ALL: [Self; 2] = [Positions::Whole, Positions::InTwo];

    /// Returns the form that this number of positions takes.
    pub(crate) fn of(vertices: usize, limits: &wgpu::Limits) -> Self {
        let bytes = (vertices as u64).saturating_mul(size_of::<[f32; 4]>() as u64);
        let fits = bytes <= limits.max_storage_buffer_binding_size;
        if fits { Positions::Whole } else { Positions::InTwo }
    }
}

/// The form of a mesh on a device, for which kernels are composed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MeshForm {
    pub(crate) positions: Positions,
    /// Whether target maps follow the positions.
    pub(crate) has_targets: bool,
}

impl From<Positions> for MeshForm {
    /// The form of a mesh without targets.
    fn from(positions: Positions) -> Self {
        Self { positions, has_targets: false }
    }
}

impl Kernel {
    /// Returns the form of the mesh as far as the kernel depends on it.
    pub(crate) fn sees(&self, form: MeshForm) -> MeshForm {
        let positions = self.interface().sees(form.positions);
        MeshForm { positions, has_targets: form.has_targets && self.sees_targets() }
    }

    /// Whether the kernel uses target maps if there are any.
    pub(crate) fn sees_targets(&self) -> bool {
        matches!(
            self,
            Kernel::Sweep(..)
                | Kernel::Objective(_)
                | Kernel::Gradient(_)
                | Kernel::Stiffness(_)
                | Kernel::ObjectiveAlongCorrection(_)
                | Kernel::MoveAlongCorrection
                | Kernel::FindBroken
                | Kernel::CloseSecant
                | Kernel::FindInverted
                | Kernel::Regularize
                | Kernel::Untangle
        )
    }

    /// Lists the kernels that a run by this plan, or an application's frame, may need, without those of corrections.
    pub(crate) fn needed_by(plan: &Plan) -> Vec<Kernel> {
        let sweeps =
            plan.scheme.metrics().iter().map(|&m| Kernel::Sweep(m, plan.derivatives[m as usize]));
        let mut kernels: Vec<_> = sweeps.collect();
        kernels.extend([Kernel::Objective(plan.tracked()), Kernel::Finish(plan.tracked())]);
        kernels.extend([Kernel::KeepBest, Kernel::Import, Kernel::Export, Kernel::Publish]);
        kernels.extend([Kernel::Reopen, Kernel::Resume, Kernel::FindShare, Kernel::MoveVertices]);
        kernels.extend([Kernel::HoldByMask, Kernel::RestoreLastValid]);
        kernels.extend([Kernel::FindInverted, Kernel::Regularize, Kernel::Untangle]);
        kernels
    }

    /// Lists the kernels that corrections from coarser levels need.
    pub(crate) fn of_levels(metric: Metric) -> Vec<Kernel> {
        let of_metric = [
            Kernel::Stiffness(metric),
            Kernel::Gradient(metric),
            Kernel::ObjectiveAlongCorrection(metric),
        ];
        let others = [
            Kernel::SmoothGradient,
            Kernel::Restrict,
            Kernel::Prolong,
            Kernel::MatrixVector,
            Kernel::Chebyshev,
            Kernel::CoarsestSolve,
            Kernel::SumAlongCorrection,
            Kernel::MoveAlongCorrection,
            Kernel::FindBroken,
            Kernel::LeaveOutBroken,
            Kernel::BeginSearch,
            Kernel::JudgeTrial,
            Kernel::CloseSecant,
            Kernel::SumSecants,
            Kernel::BendGradient,
            Kernel::MultiplyCorrection,
            Kernel::OpenSecant,
        ];
        of_metric.into_iter().chain(others).collect()
    }

    /// Returns the name of the entry point.
    pub fn entry_point(&self) -> &'static str {
        match self {
            Kernel::Sweep(..) => "sweep",
            Kernel::Objective(_) => "objective",
            Kernel::Finish(_) => "finish",
            Kernel::KeepBest => "keep_best",
            Kernel::Import => "import_positions",
            Kernel::Export => "export_positions",
            Kernel::Publish => "publish",
            Kernel::Reopen => "reopen",
            Kernel::Resume => "resume",
            Kernel::RestoreLastValid => "restore_last_valid",
            Kernel::HoldByMask => "hold_by_mask",
            Kernel::FindShare => "find_share",
            Kernel::MoveVertices => "move_vertices",
            Kernel::FindInverted => "find_inverted",
            Kernel::Regularize => "regularize",
            Kernel::Untangle => "untangle",
            Kernel::Gradient(_) => "find_gradient",
            Kernel::SmoothGradient => "smooth_gradient",
            Kernel::Restrict => "restrict_gradient",
            Kernel::Prolong => "prolong_solution",
            Kernel::MatrixVector => "matrix_vector",
            Kernel::Chebyshev => "chebyshev",
            Kernel::CoarsestSolve => "coarsest_solve",
            Kernel::ObjectiveAlongCorrection(_) => "objective_along_correction",
            Kernel::SumAlongCorrection => "sum_along_correction",
            Kernel::MoveAlongCorrection => "move_along_correction",
            Kernel::FindBroken => "find_broken",
            Kernel::LeaveOutBroken => "leave_out_broken",
            Kernel::BeginSearch => "begin_search",
            Kernel::JudgeTrial => "judge_trial",
            Kernel::Stiffness(_) => "find_stiffness",
            Kernel::CloseSecant => "close_secant",
            Kernel::SumSecants => "sum_secants",
            Kernel::BendGradient => "bend_gradient",
            Kernel::MultiplyCorrection => "multiply_correction",
            Kernel::OpenSecant => "open_secant",
            Kernel::CheckArithmetic => "check_arithmetic",
        }
    }

    /// Returns the bindings of the kernel.
    pub fn interface(&self) -> Interface {
        match self {
            Kernel::Import | Kernel::Export => Interface::Exchange,
            Kernel::Publish => Interface::Publish,
            Kernel::HoldByMask => Interface::Mask,
            Kernel::RestoreLastValid => Interface::Restore,
            Kernel::Reopen | Kernel::Resume => Interface::Reopen,
            Kernel::FindShare | Kernel::MoveVertices => Interface::Move,
            Kernel::FindInverted | Kernel::Regularize | Kernel::Untangle => Interface::Untangle,
            Kernel::CheckArithmetic => Interface::Arithmetic,
            Kernel::Sweep(..) | Kernel::Objective(_) | Kernel::Finish(_) | Kernel::KeepBest => {
                Interface::Run
            }
            Kernel::BeginSearch | Kernel::JudgeTrial => Interface::Search,
            Kernel::CloseSecant
            | Kernel::SumSecants
            | Kernel::BendGradient
            | Kernel::MultiplyCorrection
            | Kernel::OpenSecant => Interface::Secants,
            Kernel::Gradient(_)
            | Kernel::Stiffness(_)
            | Kernel::ObjectiveAlongCorrection(_)
            | Kernel::MoveAlongCorrection
            | Kernel::FindBroken
            | Kernel::LeaveOutBroken => Interface::Fine,
            Kernel::SmoothGradient | Kernel::Restrict | Kernel::Prolong => Interface::Transfer,
            Kernel::MatrixVector
            | Kernel::Chebyshev
            | Kernel::CoarsestSolve
            | Kernel::SumAlongCorrection => Interface::Coarse,
        }
    }

    /// Returns a label for tools such as RenderDoc.
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
