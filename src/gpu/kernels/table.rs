//! The table of kernels.
//!
//! A kernel is a row of the table below and its WGSL file. Source, pipelines, labels, preparation and tests loop over the table or
//! ask the row. The kernels that a run compiles before its first sweep are listed in `gpu/run/ahead.rs`.

use crate::gpu::kernels::form::MeshForm;
use crate::gpu::kernels::layouts::BindLayout;
use crate::gpu::kernels::row::{Arguments, Composition, InvariantMetric, Row, Source, User};
use crate::gpu::kernels::uniforms::{FINISH_WORKGROUP, SLOTS, WORKGROUP};
use crate::layout::MapKind;
use crate::metric::Metric;
use crate::options::Derivatives;
use crate::run::Plan;

/// A part of a kernel's source: the name of a file, or a variant of [`Source`].
macro_rules! source {
    ($file:literal) => {
        Source::File(include_str!(concat!("../../../shaders/", $file)))
    };
    ($made:ident) => {
        Source::$made
    };
}

/// Generates the enum of kernels, and the functions that read the rows. A row has the kernel's arguments and the
/// members of [`Row`].
macro_rules! kernels {
    ($(
        $(#[doc = $doc:literal])*
        $kernel:ident $(($($argument:ident: $ty:ty),+))? {
            entry_point: $entry_point:literal,
            layout: $layout:ident,
            width: $width:expr,
            sees_maps: $sees_maps:literal,
            sees_bounds: $sees_bounds:literal,
            sees_quadrilaterals: $sees_quadrilaterals:literal,
            user: $user:ident,
            source: [$($source:tt),*],
        }
    )*) => {
        /// A compute kernel: one WGSL module in core WebGPU, with the bindings of its [`BindLayout`].
        #[derive(Clone, Debug, PartialEq, Eq, Hash)]
        pub enum Kernel { $($(#[doc = $doc])* $kernel $(($($ty),+))?,)* }

        impl Kernel {
            /// Returns the row of the table.
            pub(crate) fn row(&self) -> &'static Row {
                match self {
                    $(Kernel::$kernel { .. } => const { &Row {
                        entry_point: $entry_point,
                        layout: BindLayout::$layout,
                        width: $width,
                        sees_maps: $sees_maps,
                        sees_bounds: $sees_bounds,
                        sees_quadrilaterals: $sees_quadrilaterals,
                        user: User::$user,
                        source: &[$(source!($source)),*],
                    } },)*
                }
            }

            /// Returns the arguments that the source depends on.
            pub(crate) fn composition(&self) -> Composition {
                match self {
                    $(Kernel::$kernel $(($($argument),+))? => {
                        Composition::from(($($($argument.to_owned()),+)?))
                    })*
                }
            }

            /// Lists the kernels of a plan. Without a plan, lists all kernels with the arguments that tests try.
            #[allow(unused_parens)]
            fn list(plan: Option<&Plan>) -> Vec<Kernel> {
                let mut kernels = Vec::new();
                $(
                    let arguments = <($($($ty),+)?) as Arguments>::list(plan);
                    kernels.extend(arguments.into_iter().map(|($($($argument),+)?)| {
                        Kernel::$kernel $(($($argument),+))?
                    }));
                )*
                kernels
            }
        }
    };
}

kernels! {
    /// Newton steps on the free vertices of one color.
    Sweep(metric: Metric, derivatives: Derivatives) {
        entry_point: "sweep",
        layout: Run,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: true,
        sees_quadrilaterals: true,
        user: Sweeps,
        source: ["patch.wgsl", "one_ring.wgsl", ActiveMetric, "descent.wgsl", "newton.wgsl"],
    }

    /// Partial sums of the objectives of these metrics over the triangles.
    Objective(metrics: Vec<Metric>) {
        entry_point: "objective",
        layout: Run,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Sweeps,
        source: ["patch.wgsl", TrackedMetrics, "objective.wgsl"],
    }

    /// Adds up the sums of [`Objective`](Self::Objective) over spans, where they are many.
    AddUpEvaluation(metrics: Vec<Metric>) {
        entry_point: "add_up_evaluation",
        layout: Run,
        width: FINISH_WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: [TrackedSlots, "spans.wgsl", "totals.wgsl", "add_up_evaluation.wgsl"],
    }

    /// Completes the sums of [`Objective`](Self::Objective) and decides whether the run ends.
    Finish(metrics: Vec<Metric>) {
        entry_point: "finish",
        layout: Run,
        width: FINISH_WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: [TrackedSlots, "spans.wgsl", "totals.wgsl", "finish.wgsl"],
    }

    /// Copies the positions of the free vertices if the base objective is the lowest so far.
    KeepBest {
        entry_point: "keep_best",
        layout: Run,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["keep_best.wgsl"],
    }

    /// Newton steps along curves, on the sliding vertices of one color.
    Slide(metric: Metric) {
        entry_point: "slide",
        layout: Slide,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: true,
        sees_quadrilaterals: true,
        user: Curves,
        source: [ActiveMetric, "slide/curve.wgsl", "slide/visit.wgsl"],
    }

    /// Copies the parameters of the sliding vertices if the base objective is the lowest so far.
    KeepBestPlaces {
        entry_point: "keep_best_places",
        layout: Slide,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Curves,
        source: ["slide/keep_best_places.wgsl"],
    }

    /// Takes up the places of sliding vertices that an application has moved.
    TakeUp {
        entry_point: "take_up",
        layout: Slide,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Curves,
        source: ["slide/curve.wgsl", "slide/take_up.wgsl"],
    }

    /// Holds sliding vertices by a mask of the application.
    HoldSlidingByMask {
        entry_point: "hold_sliding_by_mask",
        layout: SlidingMask,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Curves,
        source: ["slide/hold_by_mask.wgsl"],
    }

    /// Reads positions from an application's vertex buffer.
    Import {
        entry_point: "import_positions",
        layout: Exchange,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["import.wgsl"],
    }

    /// Writes positions to an application's vertex buffer.
    Export {
        entry_point: "export_positions",
        layout: Exchange,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["export.wgsl"],
    }

    /// Writes objectives to an application's buffer.
    WriteObjective {
        entry_point: "write_objective",
        layout: WriteObjective,
        width: SLOTS as u32,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["write_objective.wgsl"],
    }

    /// Restarts the stop rule of sweeps if an application has changed the mesh. Otherwise makes a run in progress skip
    /// the next evaluation.
    RestartIfChanged {
        entry_point: "restart_if_changed",
        layout: RestartIfChanged,
        width: 1,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["judged/restart_if_changed.wgsl"],
    }

    /// Lets the run continue that [`RestartIfChanged`](Self::RestartIfChanged) has made skip an evaluation.
    Resume {
        entry_point: "resume",
        layout: RestartIfChanged,
        width: 1,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["judged/resume.wgsl"],
    }

    /// Saves the positions of a valid mesh, and restores the saved ones if the mesh is not valid.
    RestoreLastValid {
        entry_point: "restore_last_valid",
        layout: Restore,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["restore.wgsl"],
    }

    /// Holds vertices by a mask of the application.
    HoldByMask {
        entry_point: "hold_by_mask",
        layout: Mask,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["mask.wgsl"],
    }

    /// Finds the share of the ways to their targets that an application's vertices can go before a triangle inverts or
    /// gets too flat.
    FindShare {
        entry_point: "find_share",
        layout: Move,
        width: FINISH_WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Sweeps,
        source: ["clamp/find_share.wgsl"],
    }

    /// Moves vertices toward their targets by the share that [`FindShare`](Self::FindShare) has found.
    MoveVertices {
        entry_point: "move_vertices",
        layout: Move,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["clamp/move_vertices.wgsl"],
    }

    /// Counts inverted and flat triangles, finds the most inverted triangle, and marks the vertices of all.
    FindInverted {
        entry_point: "find_inverted",
        layout: Untangle,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Sweeps,
        source: ["untangle/find_inverted.wgsl"],
    }

    /// Begins an untangling sweep if [`FindInverted`](Self::FindInverted) has found inverted triangles.
    Regularize {
        entry_point: "regularize",
        layout: Untangle,
        width: 1,
        sees_maps: true,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Sweeps,
        source: ["untangle/regularize.wgsl"],
    }

    /// Newton steps that untangle, on the free vertices of one color.
    Untangle {
        entry_point: "untangle",
        layout: Untangle,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Sweeps,
        source: [
            UntanglingEnergy, "one_ring.wgsl", "descent.wgsl", "untangle/energy.wgsl",
            "untangle/untangle.wgsl"
        ],
    }

    /// The gradient of Σ q² at the free vertices.
    Gradient(metric: Metric) {
        entry_point: "find_gradient",
        layout: Fine,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: true,
        sees_quadrilaterals: true,
        user: Corrections,
        source: ["one_ring.wgsl", ActiveMetric, "levels/around.wgsl", "levels/gradient.wgsl"],
    }

    /// Smooths the result of [`Gradient`](Self::Gradient) over the one-rings, before [`Restrict`](Self::Restrict).
    SmoothGradient {
        entry_point: "smooth_gradient",
        layout: Transfer,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Corrections,
        source: ["levels/neighbors.wgsl", "levels/smooth_gradient.wgsl"],
    }

    /// Sums the smoothed gradient over each aggregate: from the free vertices to the first coarse level.
    Restrict {
        entry_point: "restrict_gradient",
        layout: Transfer,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["levels/restrict.wgsl"],
    }

    /// Interpolates the coarse solution: from the first coarse level to a correction of the free vertices.
    Prolong {
        entry_point: "prolong_solution",
        layout: Transfer,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Corrections,
        source: ["levels/neighbors.wgsl", "levels/prolong.wgsl"],
    }

    /// Multiplies a vector by a matrix and adds a vector, on a coarse level.
    MatrixVector {
        entry_point: "matrix_vector",
        layout: Coarse,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["levels/matrix_vector.wgsl"],
    }

    /// One step of Chebyshev's iteration on a coarse level.
    Chebyshev {
        entry_point: "chebyshev",
        layout: Coarse,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["levels/chebyshev.wgsl"],
    }

    /// Solves on the coarsest level, by the inverse matrix times the right-hand side.
    CoarsestSolve {
        entry_point: "coarsest_solve",
        layout: Coarse,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["levels/coarsest_solve.wgsl"],
    }

    /// Partial sums of the objective before and after a step along the correction, and of its slope along it.
    ObjectiveAlongCorrection(metric: Metric) {
        entry_point: "objective_along_correction",
        layout: Fine,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: true,
        sees_quadrilaterals: true,
        user: Corrections,
        source: [
            "one_ring.wgsl", ActiveMetric, "levels/along.wgsl", "levels/moved.wgsl",
            "levels/objective_along_correction.wgsl"
        ],
    }

    /// Completes the sums of [`ObjectiveAlongCorrection`](Self::ObjectiveAlongCorrection).
    SumAlongCorrection {
        entry_point: "sum_along_correction",
        layout: Coarse,
        width: FINISH_WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["sum_of.wgsl", "levels/sum_along_correction.wgsl"],
    }

    /// Moves the free vertices along the correction.
    MoveAlongCorrection {
        entry_point: "move_along_correction",
        layout: Fine,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: true,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["levels/along.wgsl", "levels/move_along_correction.wgsl"],
    }

    /// Finds the vertices of triangles that the correction would invert or make break the shape guard.
    FindBroken {
        entry_point: "find_broken",
        layout: Fine,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: true,
        sees_quadrilaterals: true,
        user: Corrections,
        source: [
            "one_ring.wgsl", "levels/along.wgsl", "levels/moved.wgsl", "levels/find_broken.wgsl"
        ],
    }

    /// Leaves the vertices found by [`FindBroken`](Self::FindBroken) out of the correction.
    ExcludeBroken {
        entry_point: "exclude_broken",
        layout: Fine,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["levels/exclude_broken.wgsl"],
    }

    /// Begins the line search of a correction that an application encodes.
    BeginSearch {
        entry_point: "begin_search",
        layout: Search,
        width: 1,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["search/begin_search.wgsl"],
    }

    /// Judges a trial of the line search that [`BeginSearch`](Self::BeginSearch) began, and chooses the next length.
    JudgeTrial {
        entry_point: "judge_trial",
        layout: Search,
        width: 1,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["search/judge_trial.wgsl"],
    }

    /// The square root of the stiffness at the free vertices, from which the coarser levels are built.
    Stiffness(metric: Metric) {
        entry_point: "find_stiffness",
        layout: Fine,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Corrections,
        source: ["one_ring.wgsl", ActiveMetric, "levels/around.wgsl", "levels/stiffness.wgsl"],
    }

    /// Completes the open secant pair, with partial sums of its products.
    CompletePair {
        entry_point: "complete_pair",
        layout: Secants,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["secants/complete_pair.wgsl"],
    }

    /// Adds up the sums of products of secant pairs over spans, where they are many.
    AddUpSecants {
        entry_point: "add_up_secants",
        layout: Secants,
        width: FINISH_WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["spans.wgsl", "secants/partial_sum.wgsl", "sum_of.wgsl", "secants/add_up_secants.wgsl"],
    }

    /// Completes the sums of products of secant pairs.
    SumSecants {
        entry_point: "sum_secants",
        layout: Secants,
        width: FINISH_WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["spans.wgsl", "secants/partial_sum.wgsl", "sum_of.wgsl", "secants/sum_secants.wgsl"],
    }

    /// Subtracts the part that the secant pairs account for from the gradient, before the levels are applied.
    BendGradient {
        entry_point: "bend_gradient",
        layout: Secants,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["secants/bend_gradient.wgsl"],
    }

    /// Partial sums of products of secant pairs with the correction.
    MultiplyCorrection {
        entry_point: "multiply_correction",
        layout: Secants,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["secants/multiply_correction.wgsl"],
    }

    /// Completes a correction by the secant pairs, and opens the next pair.
    BeginPair {
        entry_point: "begin_pair",
        layout: Secants,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Corrections,
        source: ["secants/begin_pair.wgsl"],
    }

    /// Computes the centers and sizes of aggregates of vertices, and the places of their vertices.
    PlaceMembers {
        entry_point: "place_members",
        layout: Hessian,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["spans.wgsl", "truncated/vectors.wgsl", "truncated/place_members.wgsl"],
    }

    /// The Hessian at the free vertices, or the positive semidefinite part of it.
    FindHessian(metric: InvariantMetric) {
        entry_point: "find_hessian",
        layout: Hessian,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Steps,
        source: [
            "one_ring.wgsl", MetricSlopes, "spans.wgsl", "truncated/vectors.wgsl", "truncated/hessian_blocks.wgsl",
            "truncated/find_hessian.wgsl"
        ],
    }

    /// The Hessian at the sliding vertices, or the positive semidefinite part of it.
    FindSlideHessian(metric: InvariantMetric) {
        entry_point: "find_slide_hessian",
        layout: SlideHessian,
        width: WORKGROUP,
        sees_maps: true,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Slides,
        source: [
            MetricSlopes, "spans.wgsl", "truncated/vectors.wgsl", "truncated/hessian_blocks.wgsl",
            "truncated/slide_corners.wgsl", "truncated/find_slide_hessian.wgsl"
        ],
    }

    /// The residual at the sliding vertices, along their tangents.
    ProjectResidual {
        entry_point: "project_residual",
        layout: SlideSolution,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Slides,
        source: [
            "spans.wgsl", "truncated/vectors.wgsl", "truncated/slide_lines.wgsl", "truncated/project_residual.wgsl"
        ],
    }

    /// The preconditioned residual at the sliding vertices.
    PreconditionSlides {
        entry_point: "precondition_slides",
        layout: SlideSolution,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Slides,
        source: [
            "spans.wgsl", "truncated/vectors.wgsl", "truncated/preconditioned.wgsl", "truncated/slide_lines.wgsl",
            "truncated/precondition_slides.wgsl"
        ],
    }

    /// The product of the Hessian and the direction at the sliding vertices.
    MultiplySlides {
        entry_point: "multiply_slides",
        layout: SlideSolution,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Slides,
        source: [
            "spans.wgsl", "truncated/vectors.wgsl", "truncated/slide_corners.wgsl", "truncated/slide_lines.wgsl",
            "truncated/multiply_slides.wgsl"
        ],
    }

    /// The matrix of the first level of aggregates.
    SumOverMembers {
        entry_point: "sum_over_members",
        layout: Solution,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Steps,
        source: [
            "spans.wgsl", "truncated/vectors.wgsl", "truncated/slide_corners.wgsl", "truncated/sum_over_members.wgsl"
        ],
    }

    /// Ends an iteration of conjugate gradients, and sums the residual over the aggregates.
    Advance {
        entry_point: "advance",
        layout: Solution,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["spans.wgsl", "truncated/vectors.wgsl", "truncated/advance.wgsl"],
    }

    /// The preconditioned residual.
    Precondition {
        entry_point: "precondition",
        layout: Solution,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: [
            "spans.wgsl", "truncated/vectors.wgsl", "truncated/preconditioned.wgsl", "truncated/precondition.wgsl"
        ],
    }

    /// Adds up the sums of an inner product over spans, where they are many.
    AddUpStep {
        entry_point: "add_up_step",
        layout: Solution,
        width: FINISH_WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["spans.wgsl", "truncated/vectors.wgsl", "sum_of.wgsl", "truncated/total.wgsl", "truncated/add_up_step.wgsl"],
    }

    /// Begins an iteration of conjugate gradients.
    BeginIteration {
        entry_point: "begin_iteration",
        layout: Solution,
        width: FINISH_WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["spans.wgsl", "truncated/vectors.wgsl", "sum_of.wgsl", "truncated/total.wgsl", "truncated/begin_iteration.wgsl"],
    }

    /// The next direction of conjugate gradients.
    Turn {
        entry_point: "turn",
        layout: Solution,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["spans.wgsl", "truncated/vectors.wgsl", "truncated/turn.wgsl"],
    }

    /// The product of the Hessian and the direction.
    Multiply {
        entry_point: "multiply",
        layout: Solution,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: true,
        user: Steps,
        source: ["spans.wgsl", "truncated/vectors.wgsl", "truncated/multiply.wgsl"],
    }

    /// Judges an iteration of conjugate gradients.
    JudgeIteration {
        entry_point: "judge_iteration",
        layout: Solution,
        width: FINISH_WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["spans.wgsl", "truncated/vectors.wgsl", "sum_of.wgsl", "truncated/total.wgsl", "truncated/judge_iteration.wgsl"],
    }

    /// The centers and sizes of coarser aggregates.
    JoinAggregates {
        entry_point: "join_aggregates",
        layout: Lattice,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/join_aggregates.wgsl"],
    }

    /// The places of aggregates in coarser aggregates.
    FindShifts {
        entry_point: "find_shifts",
        layout: Lattice,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/find_shifts.wgsl"],
    }

    /// The matrix of a coarser level, from the next finer level's.
    SumBlocks {
        entry_point: "sum_blocks",
        layout: Lattice,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/sum_blocks.wgsl"],
    }

    /// Inverts the diagonal blocks of a level's matrix.
    InvertDiagonal {
        entry_point: "invert_diagonal",
        layout: Lattice,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/invert_diagonal.wgsl"],
    }

    /// The residual of a level, summed over the aggregates of the next coarser level.
    RestrictResidual {
        entry_point: "restrict_residual",
        layout: Lattice,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/restrict_residual.wgsl"],
    }

    /// Adds the motion of coarser aggregates to the solution of a level.
    ProlongMotion {
        entry_point: "prolong",
        layout: Lattice,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/prolong.wgsl"],
    }

    /// The residual of a level, and the first step of Chebyshev's method.
    SmoothResidual {
        entry_point: "smooth_residual",
        layout: Lattice,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/smooth_residual.wgsl"],
    }

    /// The second step of Chebyshev's method on a level of aggregates.
    SmoothAgain {
        entry_point: "smooth_again",
        layout: Lattice,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/smooth_again.wgsl"],
    }

    /// Begins the trials of the lengths of a Newton step.
    BeginTrials {
        entry_point: "begin_trials",
        layout: Trials,
        width: 1,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/begin_trials.wgsl"],
    }

    /// Judges a trial of the length of a Newton step.
    JudgeLength {
        entry_point: "judge_length",
        layout: Trials,
        width: 1,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Steps,
        source: ["truncated/judge_length.wgsl"],
    }

    /// Checks the arithmetic of the adapter on inputs where a compiler that reorders sums loses digits.
    CheckArithmetic {
        entry_point: "check_arithmetic",
        layout: Arithmetic,
        width: WORKGROUP,
        sees_maps: false,
        sees_bounds: false,
        sees_quadrilaterals: false,
        user: Check,
        source: ["check_arithmetic.wgsl"],
    }
}

impl Kernel {
    /// Returns all kernels. A kernel of one metric is listed for each metric; the sweep kernel with analytic
    /// derivatives and with differences. A kernel that sums objectives is listed for each metric alone and for all
    /// metrics together.
    #[doc(hidden)]
    pub fn all() -> Vec<Kernel> {
        Self::list(None)
    }

    /// Lists the kernels that a user may need for the metrics of this plan.
    pub(crate) fn needed_by(plan: &Plan, user: User) -> Vec<Kernel> {
        let mut kernels = Self::list(Some(plan));
        kernels.retain(|kernel| kernel.row().user == user);
        kernels
    }

    /// Returns `form` without the properties on which the kernel does not depend, so that meshes share pipelines.
    pub(crate) fn sees(&self, form: MeshForm) -> MeshForm {
        let positions = self.layout().sees(form.positions);
        let maps = if self.row().sees_maps { form.maps } else { MapKind::None };
        let is_bounded = form.is_bounded && self.row().sees_bounds;
        let has_quadrilaterals = form.has_quadrilaterals && self.row().sees_quadrilaterals;
        MeshForm { positions, maps, is_bounded, has_quadrilaterals }
    }

    /// Returns the name of the entry point.
    #[doc(hidden)]
    pub fn entry_point(&self) -> &'static str {
        self.row().entry_point
    }

    /// Returns the bindings of the kernel.
    #[doc(hidden)]
    pub fn layout(&self) -> BindLayout {
        self.row().layout
    }

    /// Returns the size of a workgroup, in invocations.
    #[doc(hidden)]
    pub fn workgroup_size(&self) -> u32 {
        self.row().width
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
