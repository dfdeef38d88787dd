//! The structs that Rust and the kernels share: uniforms, and the structs in storage buffers. Each is declared once.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use crate::metric::{Metric, Smoothing};
use crate::run::SweepParams;
use crate::run::multilevel::NONE;

/// Length of the history of evaluations on the device. The host reads entries before the device overwrites them.
pub(crate) const HISTORY: u32 = 256;
/// Workgroup size of most kernels, in invocations.
pub(crate) const WORKGROUP: u32 = 64;
/// Workgroup size, in invocations, of the kernels that run in one workgroup and share sums in its memory.
pub(crate) const FINISH_WORKGROUP: u32 = 256;
/// Largest number of partial sums that one workgroup adds up. A longer list is added up in two stages: with 65,536 partial sums in
/// one workgroup, a model of an H100 let a sweep of a million vertices wait for its sums as long as for its visits.
pub(crate) const MOST_SUMMED: u32 = 4096;

/// Number of values stored for an evaluation: the sum of q² - ideal² for every metric, the number of inverted
/// triangles, and the largest imr² - 1.
pub(crate) const SLOTS: usize = Metric::ALL.len() + 2;
/// Number of metrics for which the objectives that applications read have room.
pub(crate) const MOST_METRICS: usize = 16;
/// Number of four-component vectors that hold a value for each slot.
pub(crate) const SLOT_VECTORS: usize = SLOTS.div_ceil(4);
/// Slot of the count of inverted and flat triangles.
pub(crate) const INVERTED: u32 = Metric::ALL.len() as u32;
/// Slot of the largest imr² - 1 of a triangle.
pub(crate) const WORST: u32 = INVERTED + 1;
/// Bits of the smallest positive normal float.
pub(crate) const MIN_NORMAL: u32 = 0x0080_0000;
/// The bit that is set in the ring start of a free vertex that the application holds in place. Ring starts themselves
/// are smaller.
pub(crate) const HELD: u32 = 1 << 31;
/// Shape guard that allows any step: larger than any inverse mean ratio, and finite in single precision.
pub(crate) const NO_GUARD: f64 = 1e38;
/// Distance of a vertex from the center of its disc, as a share of the radius, from which the vertex counts as at the
/// circle. In single precision, points of the circle are up to 3e-7 off.
pub(crate) const AT_DISC: f64 = 1.0 - 1e-5;
/// Error of an altitude in single precision, as a share of the longest edge. The error of an area is 3e-7 times the product
/// of two edges.
pub(crate) const ALTITUDE_ERROR: f64 = 1e-6;
/// Number of presses that marks a vertex off its curve. The vertex stays, like a vertex with too many presses.
pub(crate) const OFF_CURVE: u32 = 100;
/// Error of the distance of a given vertex from a line in single precision, as a share of the length of the line.
pub(crate) const CURVE_ERROR: f64 = 1e-6;
/// Replaces a radius of zero in divisions.
pub(crate) const TINY: f64 = 1e-30;

/// Number of lengths tried along each correction that an application encodes.
pub(crate) const SEARCH_TRIALS: u32 = 3;
/// Number of lengths tried along a Newton step in one submission, and in all.
pub(crate) const STEP_TRIALS: u32 = 2;
/// Decrease of the objective, as a share, that single precision hides from the trials of a Newton step.
pub(crate) const HIDDEN: f64 = 3e-8;
/// Number of bisections by which a device finds the smallest Ritz value, in single precision.
pub(crate) const BISECTIONS: u32 = 24;

/// Number of entries in front of the partial sums in the vectors of the levels: the totals, and the state of a line
/// search on the device, as in shaders/search/places.wgsl.
pub(crate) const SEARCH_STATE: u32 = 7;

// Names of WGSL's types, for members of the structs below.
#[allow(non_camel_case_types)]
type vec2f = [f32; 2];
#[allow(non_camel_case_types)]
type vec2u = [u32; 2];
#[allow(non_camel_case_types)]
type vec4f = [f32; 4];
#[allow(non_camel_case_types)]
type array<T, const LENGTH: usize> = [T; LENGTH];
#[allow(non_camel_case_types)]
type atomic<T> = T;
/// Values by evaluation (modulo [`HISTORY`]) and slot. WGSL declares a single array without rows.
type History = [[vec2f; SLOTS]; HISTORY as usize];

/// A struct that Rust and the kernels share.
pub(crate) struct SharedStruct {
    pub(crate) name: &'static str,
    /// The declaration in WGSL.
    pub(crate) wgsl: &'static str,
    #[cfg(test)]
    size: usize,
    /// The name and the byte offset of each member.
    #[cfg(test)]
    offsets: &'static [(&'static str, usize)],
}

/// Declares structs in Rust and in WGSL from one list of members. Member types have equal names in both languages. The
/// lists name padding, as bytes between members are not allowed in structs that are copied to a device. There is no
/// `Default`: a literal must name every member.
macro_rules! shared_structs {
    ($(
        $(#[doc = $doc:literal])*
        $name:ident {
            $($(#[doc = $member_doc:literal])* $member:ident: $ty:ty,)*
        }
    )*) => {
        $(
            $(#[doc = $doc])*
            #[derive(Clone, Copy, Debug, Pod, Zeroable)]
            #[repr(C)]
            pub(crate) struct $name {
                $($(#[doc = $member_doc])* pub(crate) $member: $ty,)*
            }
        )*

        /// All structs that Rust and the kernels share.
        pub(crate) const SHARED_STRUCTS: &[SharedStruct] = &[$(SharedStruct {
            name: stringify!($name),
            wgsl: concat!(
                $("//", $doc, "\n",)*
                "struct ", stringify!($name), " {\n",
                $(
                    $("    //", $member_doc, "\n",)*
                    "    ", stringify!($member), ": ", stringify!($ty), ",\n",
                )*
                "}\n",
            ),
            #[cfg(test)]
            size: size_of::<$name>(),
            #[cfg(test)]
            offsets: &[$((stringify!($member), std::mem::offset_of!($name, $member))),*],
        }),*];
    };
}

shared_structs! {
    /// The constants of a run.
    Params {
        /// Always zero, which the compiler cannot know; see `opaque` in pairs.wgsl.
        zero: u32,
        triangles: u32,
        /// Number of invocations of the objective kernel.
        partials: u32,
        /// Limit of the Newton steps per visit of a vertex.
        newton_steps: u32,
        /// The number of the base metric. This member and those up to `tolerance` are for the stop rule in finish.wgsl.
        base: u32,
        window: u32,
        max_sweeps: u32,
        has_goal: u32,
        /// A pair of floats: the sum of q² - ideal² over all triangles at which the run ends.
        goal_sum: vec2f,
        /// The sum of ideal² over all triangles.
        ideal_sum: f32,
        tolerance: f32,
        /// A pair of floats: the mean area rounded to single precision, and the rounding error.
        mean_area: vec2f,
        /// Index of the first map in the positions.
        maps: u32,
        /// 1 if the coarse levels work in the coordinates of the plane, 0 if in the coordinates of the maps.
        levels_in_plane: u32,
        /// Factor of the terms of size in metrics.
        size_weight: f32,
        /// Index in the positions of the first of two rows for each free vertex, which hold the center and the radius of the
        /// vertex's disc; NONE without discs.
        discs: u32,
        /// Lower limit of altitudes; 0 for no limit.
        least_altitude: f32,
        padding: u32,
        more_padding: vec2u,
    }

    /// The range of one dispatch: free vertices of one color, with the parameters of the sweep; or triangles; or free
    /// vertices of any color. `ring`, `triangles` and `best_positions` are bound from the first entry that the range
    /// needs.
    Part {
        first: u32,
        count: u32,
        omega: f32,
        /// log2 of the exponent of EDGE's p-norm.
        sharpness: u32,
        /// Up to this inverse mean ratio any step may flatten a triangle. NO_GUARD allows any ratio.
        shape_guard: f32,
        /// Offset of the binding in the buffer of one-rings, in entries.
        ring_base: u32,
        /// Limit of the factor by which a Newton step is lengthened where nearly flat triangles dominate a patch's
        /// objective; 1 for no lengthening.
        max_lengthening: f32,
        /// Reciprocal of the inverse mean ratio toward which EDGE's penalty grows; 0 without a penalty.
        inverse_penalty_guard: f32,
    }

    /// A vertex that slides along a curve, alone or with a partner on a second curve of equal parameters.
    SlidingVertex {
        /// The vertex and its partner, NONE without a partner.
        vertices: vec2u,
        /// The vertex and its neighbors on the curve, as indices in `places`. If the neighbor before has no smaller index,
        /// or the neighbor after no larger one, the neighbor is on another turn around the curve.
        place: u32,
        low: u32,
        high: u32,
        /// Index of the first knot of the curve in `knots`. The knots of the partner's curve follow.
        knots: u32,
        /// Number of knots on each curve. A closed curve repeats its first knot at the end.
        knot_count: u32,
        is_closed: u32,
        /// Number of the vertex's given position among the knots of the curve.
        own: u32,
        /// Range in `corners` of the triangles around the vertex, after which those around the partner follow.
        first_corner: u32,
        partner_corner: u32,
        last_corner: u32,
        /// Largest distance from the given position. NO_GUARD allows any distance.
        reach: f32,
        /// Not 0 if the application holds the vertex or its partner, by pins or by a mask.
        pinned: u32,
        masked: u32,
        padding: u32,
    }

    /// A given vertex of a curve, with the piece of the curve that begins at the vertex.
    Knot {
        at: vec4f,
        /// A pair of floats: the parameter.
        param: vec2f,
        /// Slopes of the cubic relative to the line to the next knot, at the two ends of the line.
        slopes: vec2f,
        /// Length of the line to the next knot.
        length: f32,
        /// Largest distance from the lines between moved vertices.
        bound: f32,
        padding: vec2u,
    }

    /// The parameter of a vertex on its curve, and the presses against its bounds.
    CurvePlace {
        /// A pair of floats: the parameter.
        param: vec2f,
        /// Index of the knot at which the piece with the parameter begins.
        piece: u32,
        /// Number of latest sweeps that pressed the vertex against a bound, negative toward smaller parameters; OFF_CURVE for
        /// a vertex that an application has moved off its curve.
        presses: i32,
    }

    /// An operation of a correction on the free vertices or triangles of the mesh. Offsets are relative to the binding.
    FineOp {
        /// Number of free vertices or triangles of this dispatch. Invocations beyond them do nothing.
        rows: u32,
        /// The free vertex or triangle of the first invocation.
        first: u32,
        /// Number of free vertices.
        free: u32,
        /// Offset of the binding in the buffer of one-rings, in entries.
        ring_base: u32,
        /// Offset in `vectors` where find_gradient writes the square roots of the present stiffness, to which the
        /// levels are fitted; NONE for levels that are not fitted.
        present_roots: u32,
        /// Offset in `vectors` where find_broken writes the correction, zero at the vertices of broken triangles.
        unbroken: u32,
        /// Offset in `vectors` where objective_along_correction writes its partial sums.
        partial_sums: u32,
        /// The step length along the correction; 0 if a line search on the device finds the length.
        length: f32,
        /// Up to this inverse mean ratio a correction may flatten a triangle. NO_GUARD allows any ratio.
        shape_guard: f32,
        /// log2 of the exponent of EDGE's p-norm.
        sharpness: u32,
        /// Reciprocal of the inverse mean ratio toward which EDGE's penalty grows; 0 without a penalty.
        inverse_penalty_guard: f32,
        padding: u32,
    }

    /// An operation between the free vertices and the first coarse level. Offsets are relative to the binding.
    TransferOp {
        /// Number of free vertices or aggregates of this dispatch. Invocations beyond them do nothing.
        rows: u32,
        /// The free vertex of the first invocation.
        first: u32,
        /// Number of free vertices.
        free: u32,
        /// Offset of the binding in the buffer of one-rings, in entries.
        ring_base: u32,
        /// Offset in `structure` of the aggregate numbers of the free vertices; NONE for a vertex in no aggregate.
        aggregate_of: u32,
        /// Offset in `structure` of the start of each aggregate's members. Starts count from `members`.
        member_starts: u32,
        /// Offset in `structure` of the members of all aggregates.
        members: u32,
        /// Offset in `values` of the root r(v) of each free vertex. The edge between v and w weighs r(v) r(w).
        roots: u32,
        /// Offset in `values` of the reciprocal diagonal of the free vertices' matrix.
        diagonal: u32,
        /// Offset in `vectors` of the square roots of the present stiffness, to which the levels are fitted; NONE for
        /// levels that are not fitted.
        present_roots: u32,
        /// Offset in `vectors` of the right-hand side of the first coarse level.
        right: u32,
        /// Offset in `vectors` of the solution of the first coarse level.
        solution: u32,
    }

    /// An operation on the vectors of a coarse level. Offsets are relative to the binding.
    CoarseOp {
        /// Number of rows or partial sums. Invocations beyond them do nothing.
        rows: u32,
        /// Offset in `structure` of the row starts, which count from `columns` and `entries`.
        starts: u32,
        /// Offset in `structure` of the column numbers of the matrix.
        columns: u32,
        /// Offset in `values` of the matrix entries, one for each column number.
        entries: u32,
        /// Offset in `values` of the reciprocal diagonal of the level's matrix.
        diagonal: u32,
        /// Offset in `vectors` of the vector to be multiplied; NONE for a vector of zeros.
        x: u32,
        /// Offset in `vectors` of the right-hand side or the vector to be added; NONE for a vector of zeros.
        right: u32,
        /// Offset in `vectors` of the last step of Chebyshev's iteration.
        last_step: u32,
        /// Offset in `vectors` of the result.
        out: u32,
        /// Factor of the last step in Chebyshev's iteration.
        last_step_factor: f32,
        /// Factor of the residual in Chebyshev's iteration.
        residual_factor: f32,
        /// Factor of the vector added to a product.
        right_factor: f32,
        /// Factor of a product of matrix and vector.
        product_factor: f32,
        /// Offset in `vectors` of the partial sums.
        partial_sums: u32,
        /// Offset in `vectors` of the four totals.
        totals: u32,
        padding: u32,
    }

    /// One operation on the secant pairs of the free vertices.
    SecantOp {
        /// Number of free vertices.
        free: u32,
        /// Offset of the newer pair in `steps` and `changes`.
        newer: u32,
        /// Offset of the older pair in `steps` and `changes`.
        older: u32,
        /// Number of pairs, 0 to 2. With one pair, only the newer exists.
        pairs: u32,
        /// Number of invocations that write partial sums.
        partials: u32,
        /// 1 if sum_secants.wgsl sums products with the correction, 0 for products with the gradient.
        is_after: u32,
        padding: vec2u,
    }

    /// An operation of a Newton step on the free vertices, or on the first level of their aggregates.
    StepOp {
        /// Number of vertices, aggregates or blocks of this dispatch. Invocations beyond them do nothing.
        rows: u32,
        /// Number of free vertices.
        vertices: u32,
        /// Offset of the binding in the buffer of one-rings, in entries.
        ring_base: u32,
        /// Distance between two vectors in `fine`.
        vector: u32,
        /// Number of invocations that write partial sums.
        partials: u32,
        /// 1 if find_hessian.wgsl computes the positive semidefinite part, 0 for the whole Hessian.
        is_positive: u32,
        /// Offset in `structure` of the aggregate of each free vertex.
        aggregate_of: u32,
        /// Offset in `structure` of the start of each aggregate's members. Starts count from `members`.
        member_starts: u32,
        /// Offset in `structure` of the members of all aggregates.
        members: u32,
        /// Offset in `structure` of the start of each row of the first level's matrix.
        starts: u32,
        /// Offset in `structure` of the column of each block.
        columns: u32,
        /// Offset in `rows` of the first level's matrix.
        blocks: u32,
        /// Offset in `rows` of the inverses of its diagonal blocks.
        inverses: u32,
        /// Offset in `rows` of the centers and sizes of the aggregates.
        extents: u32,
        /// Offset in `rows` of the first level's right-hand side.
        right: u32,
        /// Offset in `rows` of its first step of Chebyshev's method.
        step: u32,
        /// Offset in `rows` of its solution.
        solution: u32,
        /// Number of vertices that vectors have room for: the free ones, or all if vertices slide.
        movers: u32,
        /// Offset in `structure` of the first triangle of each vertex that is not free, in `corners`.
        corner_starts: u32,
        /// Offset in `structure` of the other two vertices of each triangle around a sliding vertex, counter-clockwise.
        corners: u32,
        /// Offset in `entries` of the blocks by these vertices.
        slide_entries: u32,
        /// Offset in `fine` of the tangents of all vertices that are not free.
        tangents: u32,
        padding: vec2u,
    }

    /// A sliding vertex as an unknown of a Newton step, the length of its way. The host writes the tangents of each step.
    StepLine {
        /// Unit tangent; zero for a vertex that stays.
        along: vec2f,
        /// Second derivative of the objective by the length, because of the bend of the curve.
        curvature: f32,
        /// Share of the vertex in its unknown.
        share: f32,
        /// Second derivative by the unknown because of bounds.
        of_bounds: f32,
        vertex: u32,
        /// Index in `lines` of the next vertex of the same unknown; NONE after the last one.
        next: u32,
        /// 1 for the first vertex of an unknown.
        is_first: u32,
    }

    /// An operation on a level of aggregates, or between the level and the next coarser level. Offsets are in `structure`
    /// or `rows`.
    LatticeOp {
        /// Number of aggregates or blocks of this dispatch. Invocations beyond them do nothing.
        rows: u32,
        /// Structure: the start of each row of the matrix, and the column of each block.
        starts: u32,
        columns: u32,
        /// Structure: the coarser aggregate of each aggregate, the start of each coarser aggregate's members, the members.
        aggregate_of: u32,
        member_starts: u32,
        members: u32,
        /// Rows: the matrix, and the inverses of its diagonal blocks.
        blocks: u32,
        inverses: u32,
        /// Rows: the right-hand side, the solution, the first step of Chebyshev's method, and the residual before that step.
        right: u32,
        solution: u32,
        step: u32,
        left: u32,
        /// Rows: the centers and sizes, and the places in the coarser aggregates.
        extents: u32,
        shifts: u32,
        /// The same of the next coarser level, where kernels need them.
        coarse_starts: u32,
        coarse_columns: u32,
        coarse_blocks: u32,
        coarse_inverses: u32,
        coarse_right: u32,
        coarse_solution: u32,
        coarse_step: u32,
        coarse_extents: u32,
        padding: vec2u,
    }

    /// The state of a Newton step: of conjugate gradients, and of the trials of lengths. Gains are sums over the triangles.
    StepState {
        /// Nonzero once conjugate gradients have ended.
        is_solved: u32,
        iterations: u32,
        /// 1 if conjugate gradients have met negative curvature.
        is_curved_down: u32,
        /// Nonzero once the length of the step is known.
        is_searched: u32,
        trials: u32,
        /// 1 if a tried length inverted a triangle or broke the shape guard.
        is_broken: u32,
        /// The accepted length; 0 without any.
        length: f32,
        next_length: f32,
        /// The coefficients α and β of the present iteration, and ρ.
        alpha: f32,
        beta: f32,
        rho: f32,
        model_gain: f32,
        /// Negative derivative of the objective along the step.
        descent: f32,
        /// Bound of the gain that remains to the model.
        bound: f32,
        least_ritz: f32,
        /// The node and γ of the bound, and of the bound of steps that cannot end the run.
        node: f32,
        gamma: f32,
        rough_node: f32,
        rough_gamma: f32,
        /// The request of the host (StepRequest in src/run/truncated/step.rs).
        forcing: f32,
        least_gain: f32,
        /// 1 if vertices slide.
        slides: u32,
        /// Sums of q² - ideal² before and after the step, as pairs of floats.
        here: vec2f,
        there: vec2f,
    }

    /// The state of a run. Written by finish.wgsl, and by the kernels of judged/ for sweeps that an application
    /// encodes.
    Control {
        /// 0 while the run goes on. Otherwise kernels change nothing, and the value is the code of the reason to stop,
        /// or PASSED while one evaluation is skipped.
        done: u32,
        /// Number of evaluations of the objective. The first evaluation precedes all sweeps.
        evaluated: u32,
        /// 1 if the last evaluation found the lowest base objective so far, else 0.
        improved: u32,
        best_sweep: u32,
        best_sum: vec2f,
        /// Sum of the mesh's two counters of changes when this run began.
        changes: u32,
        padding: u32,
        /// One entry for each evaluation (modulo HISTORY) and slot. The slot of a metric holds the metric's sum as a
        /// pair of floats. The slot INVERTED holds the number of triangles that are inverted or flat in single
        /// precision, also as a pair. The slot WORST holds the largest imr² - 1 in x, and in y, as bits, the number of
        /// the worst triangle plus MIN_NORMAL.
        history: History,
    }

    /// An application's vertex buffer, and the coordinates in it.
    Exchange {
        /// Always zero, which the compiler cannot know; see `opaque` in pairs.wgsl.
        zero: u32,
        vertices: u32,
        /// Offset of the first vertex in the binding, in floats.
        offset: u32,
        /// Distance between successive vertices, in floats.
        stride: u32,
        /// The normalized position is (x - center) * scale. The center is held in pairs of floats, xy + zw.
        center: vec4f,
        scale: f32,
        inverse_scale: f32,
        padding: vec2u,
    }

    /// The vertices of a dispatch that saves or restores positions.
    Restore {
        /// Always zero, which the compiler cannot know; see `opaque` in pairs.wgsl.
        zero: u32,
        /// The first vertex of this dispatch; `valid_positions` is bound from that vertex on.
        first: u32,
        /// Number of vertices of this dispatch.
        count: u32,
        padding: u32,
    }

    /// An application's mask of held vertices.
    Mask {
        /// Number of free and held vertices, after which all further vertices are on the boundary, or of sliding vertices.
        vertices: u32,
        /// Offset of the first vertex in the binding, in words.
        offset: u32,
        padding: vec2u,
    }

    /// Vertices that an application moves, and the coordinate system of their targets.
    Movement {
        /// Always zero, which the compiler cannot know; see `opaque` in pairs.wgsl.
        zero: u32,
        /// Number of vertices to be moved.
        vertices: u32,
        /// Number of triangles with a moving corner.
        triangles: u32,
        /// The bound on the inverse mean ratio of triangles.
        worst_imr: f32,
        /// Offset of the first target in the binding, in floats.
        offset: u32,
        /// Distance between successive targets, in floats.
        stride: u32,
        /// Index in `shares` of the word that receives the share of the ways.
        share: u32,
        /// The normalized target is (x - center) * scale. The center is held in pairs of floats, xy + zw.
        scale: f32,
        center: vec4f,
    }

    /// The range of one dispatch of untangling: free vertices of one color, or triangles.
    UntanglePart {
        first: u32,
        count: u32,
        /// Offset of the binding in the buffer of one-rings, in entries.
        ring_base: u32,
        /// Number of free and held vertices. All further vertices are on the boundary.
        free: u32,
        /// 1 for a call's first sweep, which examines a valid mesh too; 0 for further sweeps.
        begins: u32,
        padding: u32,
        more_padding: vec2u,
    }

    /// The inverted triangles of a mesh.
    Tangle {
        /// 1 if no triangle that sweeps can repair was found inverted or flat. Kernels then do nothing until the mesh
        /// is examined again.
        valid: u32,
        /// Number of inverted and flat triangles with a movable vertex.
        inverted: atomic<u32>,
        /// Bits of the largest ratio -area / desired area of inverted triangles. The bits of non-negative floats
        /// compare as the floats do.
        depth: atomic<u32>,
        epsilon: f32,
        /// Number of the last sweep; 1 before the first sweep.
        sweep: u32,
        /// Value of `sweep` at the start of the present tangle. Vertices marked with smaller numbers do not move.
        since: u32,
    }

    /// The state of a vertex while a mesh is untangled.
    TangledVertex {
        /// The desired area of triangles around the vertex.
        area: f32,
        /// Marks a moving vertex by a sweep's number: the last sweep before a check that found an inverted triangle at
        /// the vertex, or the sweep that added the vertex. 0 for an unmarked vertex.
        reached: atomic<u32>,
    }

    /// The place in an application's buffer that receives objectives.
    WriteObjective {
        /// Offset of the values in the binding, in words.
        offset: u32,
        triangles: u32,
        /// 1 if the sweeps end by the stop rule, and therefore have a reason to stop and a count of sweeps; else 0.
        judged: u32,
        padding: u32,
        /// ideal² of each metric, which the sums of q² - ideal² lack for each triangle; 0 for untracked metrics.
        ideal_squared: array<vec4f, SLOT_VECTORS>,
    }

    /// Two positions as pairs of floats, xy + zw.
    ArithmeticInput {
        a: vec4f,
        b: vec4f,
    }

    /// Results of check_arithmetic.wgsl for two positions.
    ArithmeticResult {
        two_sum: vec2f,
        pair_add: vec2f,
        edge: vec2f,
        /// The result of pair_difference for the x coordinates of a and b.
        difference: f32,
        /// 1 if the triangle of the origin, a and b has a positive area, else 0.
        is_positive: f32,
        advanced: vec4f,
    }
}

impl Params {
    /// Returns the constants for kernels outside of a run, which use only `zero` and the index `maps` of the first map.
    pub(crate) fn outside_runs(maps: u32) -> Self {
        Self {
            zero: 0,
            triangles: 0,
            partials: 0,
            newton_steps: 0,
            base: 0,
            window: 0,
            max_sweeps: 0,
            has_goal: 0,
            goal_sum: [0.0; 2],
            ideal_sum: 0.0,
            tolerance: 0.0,
            mean_area: [0.0; 2],
            maps,
            levels_in_plane: 0,
            size_weight: 1.0,
            discs: NONE,
            least_altitude: 0.0,
            padding: 0,
            more_padding: [0; 2],
        }
    }
}

impl Part {
    /// Returns the uniform of a dispatch that visits a range of vertices by a step.
    pub(crate) fn of_step(step: &SweepParams, vertices: &Range<u32>, ring_base: u32) -> Self {
        Self {
            first: vertices.start,
            count: vertices.end - vertices.start,
            omega: step.omega as f32,
            sharpness: step.sharpness,
            shape_guard: step.shape_guard.min(NO_GUARD) as f32,
            ring_base,
            max_lengthening: step.max_lengthening as f32,
            inverse_penalty_guard: step.penalty_guard.recip() as f32,
        }
    }
}

impl FineOp {
    /// Returns the same operation with another smoothing of EDGE.
    pub(crate) fn smoothed(self, smoothing: Smoothing) -> Self {
        let Smoothing { sharpness, penalty_guard } = smoothing;
        Self { sharpness, inverse_penalty_guard: penalty_guard.recip() as f32, ..self }
    }
}

/// Returns a double as the sum of two floats, the larger first.
pub(crate) fn pair(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

/// Returns the value of a pair of floats.
pub(crate) fn unpair([high, low]: [f32; 2]) -> f64 {
    f64::from(high) + f64::from(low)
}

/// Returns a point as pairs of floats: x and y in xy, their low parts in zw.
pub(crate) fn split(p: DVec2) -> [f32; 4] {
    let ([x, x_low], [y, y_low]) = (pair(p.x), pair(p.y));
    [x, y, x_low, y_low]
}

/// Returns the point that pairs of floats represent: the inverse of [`split`].
pub(crate) fn join([x, y, x_low, y_low]: [f32; 4]) -> DVec2 {
    DVec2::new(unpair([x, x_low]), unpair([y, y_low]))
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use wgpu::naga;

    use super::*;
    use crate::gpu::Kernel;

    /// Returns the size of a struct in naga's layout, and the name and offset of each member; `None` if the module does
    /// not declare the struct.
    fn reflected(module: &naga::Module, name: &str) -> Option<(usize, Vec<(String, usize)>)> {
        let (_, ty) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name))?;
        let naga::TypeInner::Struct { members, span } = &ty.inner else {
            panic!("{name} is no struct");
        };
        let named = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize));
        Some((*span as usize, named.collect()))
    }

    #[test]
    fn structs_are_laid_out_as_in_wgsl() {
        let parsed = |kernel: Kernel| naga::front::wgsl::parse_str(&kernel.wgsl()).unwrap();
        let modules: Vec<naga::Module> = Kernel::all().into_iter().map(parsed).collect();
        for SharedStruct { name, size, offsets, .. } in SHARED_STRUCTS {
            let named = offsets.iter().map(|&(name, offset)| (name.to_owned(), offset));
            let expected = (*size, named.collect());
            let found: Vec<_> = modules.iter().filter_map(|m| reflected(m, name)).collect();
            assert!(!found.is_empty(), "no kernel declares {name}");
            assert!(found.iter().all(|found| *found == expected), "{name}: {:?}", found[0]);
        }
    }

    #[test]
    fn a_uniform_holds_only_what_16_byte_rows_allow() {
        // In a uniform an array's elements must be multiples of 16 bytes apart.
        assert_eq!(offset_of!(WriteObjective, ideal_squared) % 16, 0);
        assert!(size_of::<Part>() <= 256, "within the least dynamic offset alignment");
    }

    #[test]
    fn pairs_of_floats_keep_48_bits() {
        for x in [1.0, -std::f64::consts::PI, 1e-3, 4_000_000.123_456_789, -1.0 / 3.0] {
            let [high, low] = pair(x);
            assert_eq!(high, x as f32);
            assert!((unpair([high, low]) - x).abs() <= x.abs() * 2f64.powi(-48), "{x}");
        }
    }
}
