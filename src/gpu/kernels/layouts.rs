//! The bind layouts of kernels, each list of bindings declared once for Rust and WGSL.

use std::fmt::Write;

use crate::gpu::kernels::form::Positions;

/// A binding of group 0.
pub(crate) struct Binding {
    /// The name of the variable in WGSL and of the field in Rust.
    pub(crate) name: &'static str,
    pub(crate) access: Access,
    /// The type in WGSL. Empty for positions, whose type depends on the form of the mesh.
    ty: &'static str,
    /// Comment lines in WGSL.
    comment: &'static str,
}

/// The access of kernels to a binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Access {
    /// A uniform.
    Uniform,
    /// A uniform at a dynamic offset.
    DynamicUniform,
    /// A storage buffer that is read.
    Read,
    /// A storage buffer that is read and written.
    ReadWrite,
    /// The positions of a mesh, which are read and written.
    Positions,
}

impl Access {
    /// Returns the type of the binding in a bind group layout.
    pub(crate) fn ty(self) -> wgpu::BindingType {
        let (ty, has_dynamic_offset) = match self {
            Access::Uniform => (wgpu::BufferBindingType::Uniform, false),
            Access::DynamicUniform => (wgpu::BufferBindingType::Uniform, true),
            Access::Read => (wgpu::BufferBindingType::Storage { read_only: true }, false),
            Access::ReadWrite | Access::Positions => {
                (wgpu::BufferBindingType::Storage { read_only: false }, false)
            }
        };
        wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None }
    }

    fn is_storage(self) -> bool {
        !matches!(self, Access::Uniform | Access::DynamicUniform)
    }
}

/// The positions of a mesh, as kernels bind them.
pub(crate) struct BoundPositions<'a> {
    /// The whole buffer of positions, or the high parts if positions take two bindings.
    pub(crate) whole_or_high: wgpu::BindingResource<'a>,
    /// The low parts if positions take two bindings. This binding follows all others.
    pub(crate) low: Option<wgpu::BindingResource<'a>>,
}

/// The resources of one bind layout, by name.
pub(crate) trait Bindings<'a> {
    /// The layout that the resources belong to.
    const LAYOUT: BindLayout;

    /// Returns the resources in the order of the layout.
    fn resources(self) -> Vec<wgpu::BindingResource<'a>>;
}

/// A field of [`Bindings`].
trait Field<'a> {
    /// Returns the resource. If positions take two bindings, appends the low parts to `low`.
    fn resource(self, low: &mut Vec<wgpu::BindingResource<'a>>) -> wgpu::BindingResource<'a>;
}

impl<'a> Field<'a> for wgpu::BindingResource<'a> {
    fn resource(self, _: &mut Vec<wgpu::BindingResource<'a>>) -> wgpu::BindingResource<'a> {
        self
    }
}

impl<'a> Field<'a> for BoundPositions<'a> {
    fn resource(self, low: &mut Vec<wgpu::BindingResource<'a>>) -> wgpu::BindingResource<'a> {
        low.extend(self.low);
        self.whole_or_high
    }
}

/// The type of a field of [`Bindings`].
macro_rules! field {
    (Positions $a:lifetime) => { BoundPositions<$a> };
    ($access:ident $a:lifetime) => { wgpu::BindingResource<$a> };
}

/// Declares bind layouts. Each has a variant of [`BindLayout`], a struct of resources that callers fill, the WGSL files
/// that all its kernels share, and its bindings in order: name, [`Access`] and type in WGSL.
macro_rules! bind_layouts {
    ($(
        $(#[doc = $doc:literal])*
        $layout:ident, $bindings:ident, [$($file:literal),*] {
            $($(#[doc = $comment:literal])* $name:ident: $access:ident $($ty:ty)?,)*
        }
    )*) => {
        /// The bindings of a kernel, all in group 0.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum BindLayout { $($(#[doc = $doc])* $layout,)* }

        impl BindLayout {
            pub(crate) const ALL: &[Self] = &[$(BindLayout::$layout),*];

            /// Returns the bindings in order, without the low parts of positions, whose binding follows all others.
            pub(crate) fn bindings(self) -> &'static [Binding] {
                match self {
                    $(BindLayout::$layout => &[$(Binding {
                        name: stringify!($name),
                        access: Access::$access,
                        ty: concat!($(stringify!($ty))?),
                        comment: concat!($("//", $comment, "\n"),*),
                    }),*],)*
                }
            }

            /// Returns the WGSL files that all kernels of the layout share, without the bindings.
            pub(crate) fn files(self) -> &'static [&'static str] {
                match self {
                    $(BindLayout::$layout => {
                        &[$(include_str!(concat!("../../../shaders/", $file))),*]
                    })*
                }
            }
        }

        $(
            $(#[doc = $doc])*
            pub(crate) struct $bindings<'a> {
                $($(#[doc = $comment])* pub(crate) $name: field!($access 'a),)*
            }

            impl<'a> Bindings<'a> for $bindings<'a> {
                const LAYOUT: BindLayout = BindLayout::$layout;

                fn resources(self) -> Vec<wgpu::BindingResource<'a>> {
                    let mut low = Vec::new();
                    let mut resources = vec![$(self.$name.resource(&mut low)),*];
                    resources.append(&mut low);
                    resources
                }
            }
        )*
    };
}

bind_layouts! {
    /// A run on a mesh.
    Run, RunBindings, ["params.wgsl", "common.wgsl", "pairs.wgsl"] {
        params: Uniform Params,
        part: DynamicUniform Part,
        positions: Positions,
        /// Start of each free vertex's one-ring. The bit HELD is set if the vertex must stay.
        ring_start: Read array<u32>,
        ring: Read array<u32>,
        triangles: Read array<u32>,
        partial_sums: ReadWrite array<vec2f>,
        control: ReadWrite Control,
        best_positions: ReadWrite array<vec4f>,
    }

    /// A run on a mesh with vertices that slide along curves.
    Slide, SlideBindings, ["params.wgsl", "pairs.wgsl", "patch.wgsl"] {
        params: Uniform Params,
        part: DynamicUniform Part,
        positions: Positions,
        control: Read Control,
        /// The sliding vertices by color, each with its partner.
        sliding: Read array<SlidingVertex>,
        /// The given vertices of all curves, curve by curve.
        knots: Read array<Knot>,
        /// The other two vertices of each triangle around a sliding vertex, counter-clockwise.
        corners: Read array<vec2u>,
        /// The present parameters of all vertices of curves.
        places: ReadWrite array<CurvePlace>,
        best_places: ReadWrite array<CurvePlace>,
    }

    /// A mesh and a vertex buffer of an application.
    Exchange, ExchangeBindings, ["pairs.wgsl", "exchange.wgsl"] {
        exchange: Uniform Exchange,
        positions: Positions,
        /// The application's number of each vertex.
        numbers: Read array<u32>,
        vertex_buffer: ReadWrite array<f32>,
        /// Two counters: changes of the mesh by kernels; changes of pins, and restarts, by the host.
        changes: ReadWrite array<atomic<u32>, 2>,
    }

    /// A run's history and a buffer of an application.
    WriteObjective, WriteObjectiveBindings, [] {
        publish_to: Uniform WriteObjective,
        /// The control of the evaluation.
        control: Read Control,
        /// The control of the sweeps.
        sweeps: Read Control,
        /// Two counters: changes of the mesh by kernels; changes of pins, and restarts, by the host.
        changes: Read array<u32, 2>,
        destination: ReadWrite array<u32>,
    }

    /// The control of judged sweeps, and the changes of a mesh.
    RestartIfChanged, RestartBindings, ["judged/common.wgsl"] {
        control: ReadWrite Control,
        /// Two counters: changes of the mesh by kernels; changes of pins, and restarts, by the host.
        changes: Read array<u32, 2>,
    }

    /// A mesh, and the last valid positions of its vertices.
    Restore, RestoreBindings, ["pairs.wgsl"] {
        restore: Uniform Restore,
        positions: Positions,
        valid_positions: ReadWrite array<vec4f>,
        /// Holds the number of inverted triangles from an evaluation encoded just before.
        control: Read Control,
        /// Two counters: changes of the mesh by kernels; changes of pins, and restarts, by the host.
        changes: ReadWrite array<atomic<u32>, 2>,
    }

    /// Held vertices of a mesh, and a mask of an application.
    Mask, MaskBindings, [] {
        to_hold: Uniform Mask,
        /// Start of each free vertex's one-ring. The bit HELD is set if the vertex must stay.
        ring_start: ReadWrite array<u32>,
        /// The application's number of each vertex.
        numbers: Read array<u32>,
        /// One bit for each vertex, set where the host holds it.
        pins: Read array<u32>,
        mask: Read array<u32>,
        /// Two counters: changes of the mesh by kernels; changes of pins, and restarts, by the host.
        changes: ReadWrite array<atomic<u32>, 2>,
    }

    /// Sliding vertices of a mesh, and a mask of an application.
    SlidingMask, SlidingMaskBindings, [] {
        to_hold: Uniform Mask,
        /// The sliding vertices by color, each with its partner.
        sliding: ReadWrite array<SlidingVertex>,
        /// The application's number of each vertex.
        numbers: Read array<u32>,
        mask: Read array<u32>,
        /// Two counters: changes of the mesh by kernels; changes of pins, and restarts, by the host.
        changes: ReadWrite array<atomic<u32>, 2>,
    }

    /// A mesh, and the vertices that an application moves toward targets.
    Move, MoveBindings, ["pairs.wgsl", "patch.wgsl", "clamp/common.wgsl"] {
        movement: Uniform Movement,
        positions: Positions,
        /// Six numbers for each triangle: its three vertices, counter-clockwise, then for each vertex the index in
        /// `ways`, or NONE if the vertex stays.
        corners: Read array<u32>,
        /// Pairs of a moving vertex and the index of the vertex's target.
        ways: Read array<vec2u>,
        targets: Read array<f32>,
        shares: ReadWrite array<f32>,
        /// Two counters: changes of the mesh by kernels; changes of pins, and restarts, by the host.
        changes: ReadWrite array<atomic<u32>, 2>,
    }

    /// A mesh and its inverted triangles.
    Untangle, UntangleBindings, [
        "params.wgsl", "untangle/common.wgsl", "pairs.wgsl", "patch.wgsl"
    ] {
        params: Uniform Params,
        part: DynamicUniform UntanglePart,
        positions: Positions,
        /// Start of each free vertex's one-ring. The bit HELD is set if the vertex must stay.
        ring_start: Read array<u32>,
        ring: Read array<u32>,
        triangles: Read array<u32>,
        tangle: ReadWrite Tangle,
        vertices: ReadWrite array<TangledVertex>,
        /// Two counters: changes of the mesh by kernels; changes of pins, and restarts, by the host.
        changes: ReadWrite array<u32, 2>,
    }

    /// A mesh, and two vectors on its free vertices: the gradient and the correction.
    Fine, FineBindings, [
        "params.wgsl", "levels/rings.wgsl", "search/places.wgsl", "pairs.wgsl", "patch.wgsl"
    ] {
        params: Uniform Params,
        op: DynamicUniform FineOp,
        positions: Positions,
        /// Start of each free vertex's one-ring. The bit HELD is set if the vertex must stay.
        ring_start: Read array<u32>,
        ring: Read array<u32>,
        triangles: Read array<u32>,
        gradient: ReadWrite array<vec2f>,
        direction: ReadWrite array<vec2f>,
        vectors: ReadWrite array<vec2f>,
    }

    /// The free vertices of a mesh, and the first coarse level.
    Transfer, TransferBindings, [
        "params.wgsl", "levels/rings.wgsl", "search/places.wgsl", "levels/transfer.wgsl",
        "pairs.wgsl"
    ] {
        params: Uniform Params,
        op: DynamicUniform TransferOp,
        /// Start of each free vertex's one-ring. The bit HELD is set if the vertex must stay.
        ring_start: Read array<u32>,
        ring: Read array<u32>,
        structure: Read array<u32>,
        values: Read array<f32>,
        gradient: ReadWrite array<vec2f>,
        direction: ReadWrite array<vec2f>,
        vectors: ReadWrite array<vec2f>,
    }

    /// Matrices and vectors of the coarse levels.
    Coarse, CoarseBindings, [
        "params.wgsl", "search/places.wgsl", "levels/coarse.wgsl", "pairs.wgsl"
    ] {
        params: Uniform Params,
        op: DynamicUniform CoarseOp,
        structure: Read array<u32>,
        values: Read array<f32>,
        vectors: ReadWrite array<vec2f>,
    }

    /// The control of an application's sweeps, and the state of a line search along a correction.
    Search, SearchBindings, [
        "params.wgsl", "search/places.wgsl", "search/common.wgsl", "pairs.wgsl"
    ] {
        params: Uniform Params,
        control: Read Control,
        vectors: ReadWrite array<vec2f>,
    }

    /// The secant pairs of a mesh. src/run/secant.rs explains their use.
    Secants, SecantsBindings, ["params.wgsl", "pairs.wgsl", "patch.wgsl", "secants/common.wgsl"] {
        params: Uniform Params,
        op: DynamicUniform SecantOp,
        positions: Positions,
        gradient: ReadWrite array<vec2f>,
        direction: ReadWrite array<vec2f>,
        /// Moves of the free vertices from one correction to the next. For an open pair: the positions' high parts at
        /// the start of the pair.
        steps: ReadWrite array<vec2f>,
        /// Changes of the gradient from one correction to the next. For an open pair: minus the gradient at the start
        /// of the pair.
        changes: ReadWrite array<vec2f>,
        /// The low parts of the vertices' positions at the start of the open pair.
        low_starts: ReadWrite array<vec2f>,
        /// The scalars of the pairs, followed by the partial sums.
        sums: ReadWrite array<vec2f>,
    }

    /// A mesh, its Hessian at the free vertices, and the places of the free vertices in their aggregates.
    Hessian, HessianBindings, ["params.wgsl", "levels/rings.wgsl", "pairs.wgsl", "patch.wgsl"] {
        params: Uniform Params,
        op: DynamicUniform StepOp,
        positions: Positions,
        /// Start of each free vertex's one-ring. The bit HELD is set if the vertex must stay.
        ring_start: Read array<u32>,
        ring: Read array<u32>,
        structure: Read array<u32>,
        /// For each entry of the one-rings, the Hessian's 2x2 block of both vertices, column by column.
        entries: ReadWrite array<vec4f>,
        fine: ReadWrite array<vec2f>,
        rows: ReadWrite array<vec4f>,
    }

    /// The vectors of conjugate gradients on the free vertices, the Hessian, and the first level of aggregates.
    Solution, SolutionBindings, [
        "params.wgsl", "levels/rings.wgsl", "pairs.wgsl", "truncated/blocks.wgsl"
    ] {
        params: Uniform Params,
        op: DynamicUniform StepOp,
        /// Start of each free vertex's one-ring. The bit HELD is set if the vertex must stay.
        ring_start: Read array<u32>,
        ring: Read array<u32>,
        structure: Read array<u32>,
        /// For each entry of the one-rings, the Hessian's 2x2 block of both vertices, column by column.
        entries: Read array<vec4f>,
        fine: ReadWrite array<vec2f>,
        rows: ReadWrite array<vec4f>,
        state: ReadWrite StepState,
    }

    /// A mesh, and its Hessian at the sliding vertices.
    SlideHessian, SlideHessianBindings, ["params.wgsl", "pairs.wgsl", "patch.wgsl"] {
        params: Uniform Params,
        op: DynamicUniform StepOp,
        positions: Positions,
        structure: Read array<u32>,
        /// The Hessian's 2x2 blocks, column by column.
        entries: ReadWrite array<vec4f>,
        fine: ReadWrite array<vec2f>,
        lines: Read array<StepLine>,
    }

    /// The vectors of conjugate gradients at the sliding vertices.
    SlideSolution, SlideSolutionBindings, ["params.wgsl", "pairs.wgsl"] {
        params: Uniform Params,
        op: DynamicUniform StepOp,
        structure: Read array<u32>,
        /// The Hessian's 2x2 blocks, column by column.
        entries: Read array<vec4f>,
        fine: ReadWrite array<vec2f>,
        rows: Read array<vec4f>,
        lines: Read array<StepLine>,
        state: Read StepState,
    }

    /// The levels of aggregates of a Newton step.
    Lattice, LatticeBindings, [
        "params.wgsl", "pairs.wgsl", "patch.wgsl", "truncated/blocks.wgsl", "truncated/lattice.wgsl"
    ] {
        params: Uniform Params,
        op: DynamicUniform LatticeOp,
        structure: Read array<u32>,
        rows: ReadWrite array<vec4f>,
        state: Read StepState,
    }

    /// The state of a Newton step, and that of the trials along it.
    Trials, TrialsBindings, ["params.wgsl", "search/places.wgsl", "pairs.wgsl"] {
        params: Uniform Params,
        vectors: ReadWrite array<vec2f>,
        state: ReadWrite StepState,
    }

    /// Inputs and results of a check of the adapter's arithmetic.
    Arithmetic, ArithmeticBindings, ["params.wgsl", "pairs.wgsl", "patch.wgsl"] {
        params: Uniform Params,
        inputs: Read array<ArithmeticInput>,
        results: ReadWrite array<ArithmeticResult>,
    }
}

impl BindLayout {
    /// Returns whether kernels of this layout bind the positions of a mesh.
    pub(crate) fn has_positions(self) -> bool {
        self.bindings().iter().any(|binding| binding.access == Access::Positions)
    }

    /// Returns the form in which kernels of this layout bind positions, for a mesh that needs the form `positions`.
    /// Layouts without positions have one form only, [`Positions::Whole`].
    pub(crate) fn sees(self, positions: Positions) -> Positions {
        if self.has_positions() { positions } else { Positions::Whole }
    }

    /// Returns the access of each binding in order, including the binding of low parts.
    pub(crate) fn accesses(self, positions: Positions) -> Vec<Access> {
        let mut accesses: Vec<Access> = self.bindings().iter().map(|b| b.access).collect();
        if self.sees(positions) == Positions::InTwo {
            accesses.push(Access::Positions);
        }
        accesses
    }

    /// Returns whether a binding has the WGSL type `name`, or is an array of this type.
    pub(crate) fn has_type(self, name: &str) -> bool {
        let names = |ty: &'static str| ty.split(|c: char| !c.is_alphanumeric());
        self.bindings().iter().any(|binding| names(binding.ty).any(|found| found == name))
    }

    /// Returns the declarations of the bindings in WGSL.
    pub(crate) fn declarations(self, positions: Positions) -> String {
        let mut text = String::new();
        for (number, Binding { name, access, ty, comment }) in self.bindings().iter().enumerate() {
            let (space, name, ty) = match (access, positions) {
                (Access::Uniform | Access::DynamicUniform, _) => ("uniform", *name, *ty),
                (Access::Read, _) => ("storage, read", *name, *ty),
                (Access::ReadWrite, _) => ("storage, read_write", *name, *ty),
                (Access::Positions, Positions::Whole) => {
                    ("storage, read_write", *name, "array<vec4f>")
                }
                (Access::Positions, Positions::InTwo) => {
                    let low = self.bindings().len();
                    let declaration = "var<storage, read_write> low_positions: array<vec2f>;";
                    let _ = writeln!(text, "@group(0) @binding({low}) {declaration}");
                    ("storage, read_write", "high_positions", "array<vec2f>")
                }
            };
            let _ =
                writeln!(text, "{comment}@group(0) @binding({number}) var<{space}> {name}: {ty};");
        }
        text
    }
}

/// Returns the largest number of storage buffers that a kernel binds.
pub(crate) fn storage_bindings(positions: Positions) -> u32 {
    let count = |layout: &BindLayout| {
        layout.accesses(positions).iter().filter(|access| access.is_storage()).count() as u32
    };
    BindLayout::ALL.iter().map(count).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn storage_bindings_fit_the_default_limits() {
        let declared = wgpu::Limits::default().max_storage_buffers_per_shader_stage;
        assert_eq!(Positions::ALL.map(storage_bindings), [7, 8]);
        assert!(storage_bindings(Positions::InTwo) <= declared);
    }
}
