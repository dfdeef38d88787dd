//! Evaluates objectives and writes them into a buffer of the application.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::filled;
use crate::gpu::embed::BoundVertices;
use crate::gpu::embed::window::Window;
use crate::gpu::encode::Encoder;
use crate::gpu::kernels::form::Positions;
use crate::gpu::kernels::layouts::WriteObjectiveBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{MOST_METRICS, SLOTS, WriteObjective};
use crate::gpu::mesh::{Changes, MeshBuffers};
use crate::gpu::run::Dispatches;
use crate::gpu::scope::scoped_to_buffer;
use crate::layout::Problem;
use crate::metric::Metric;
use crate::parallel::pace::now;
use crate::run::{Plan, Stop};

/// Objectives and quality of a mesh at one point of a command buffer, as [`BoundObjective::encode_objective`] writes
/// them. An application casts the bytes that it reads back to this struct, or declares the struct in its shaders:
///
/// ```wgsl
/// struct ObjectiveValues {
///     inverted: u32,
///     worst_imr: f32,
///     stop: u32,
///     sweeps: u32,
///     worst_element: u32,
///     f: array<f32, 16>,
/// }
/// ```
///
/// Further metrics change neither the size nor the places of the present values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ObjectiveValues {
    /// Number of triangles, and of corners of quadrilaterals, that are inverted or flat in single precision.
    pub inverted: u32,
    /// The largest inverse mean ratio of a triangle or of a corner of a quadrilateral: at least 1, the ratio of an equilateral
    /// triangle and of a corner of a square. Infinite while `inverted` is not 0.
    pub worst_imr: f32,
    /// The code of the reason why sweeps [`until_converged`](crate::gpu::Sweeps::until_converged) have ended, so that
    /// further sweeps do nothing: 1 for [`Stop::Reached`], 2 for [`Stop::Converged`], 3 for [`Stop::Stalled`] and 4 for
    /// [`Stop::MaxSweeps`]; see [`stop`](Self::stop). 0 while sweeps continue, and for sweeps without a stop rule.
    pub stop: u32,
    /// Number of sweeps [`until_converged`](crate::gpu::Sweeps::until_converged) since their start or the last restart
    /// by a change of the mesh. Always 0 for sweeps without a stop rule.
    pub sweeps: u32,
    /// Device number of the element with the largest inverse mean ratio, or of an inverted or flat element while `inverted` is
    /// not 0. [`DeviceMesh::vertices_of`](crate::gpu::DeviceMesh::vertices_of) returns its vertices.
    pub worst_element: u32,
    /// f = (1/n) Σ q² by each metric, in the order of [`Metric::ALL`], with room for further metrics; see [`of`](Self::of).
    /// Without [`Options::track_all`](crate::Options::track_all), only the scheme's base metric is evaluated, and all other
    /// values are 0. While triangles are inverted, f by a metric with a barrier ([`Metric::has_barrier`]) is meaningless.
    pub f: [f32; MOST_METRICS],
}

impl ObjectiveValues {
    /// Returns f by a metric.
    pub fn of(&self, metric: Metric) -> f32 {
        self.f[metric as usize]
    }

    /// Returns the reason why the sweeps have ended, so that further sweeps do nothing; `None` while the sweeps go on.
    pub fn stop(&self) -> Option<Stop> {
        Stop::from_code(self.stop)
    }

    /// Returns whether the sweeps have ended by convergence: f is within
    /// [`Stopping::Tolerance`](crate::Stopping::Tolerance) of its limit, or no longer changes.
    pub fn has_converged(&self) -> bool {
        self.stop() == Some(Stop::Converged)
    }
}

/// Objectives bound to a range of an application's buffer: objectives of the device's mesh or of the vertices as drawn.
/// Created by [`Sweeps::bind_objective`](crate::gpu::Sweeps::bind_objective) or
/// [`DeviceMesh::bind_drawn_objective`](crate::gpu::DeviceMesh::bind_drawn_objective); usable after the sweeps and the
/// mesh are dropped.
pub struct BoundObjective {
    evaluation: Arc<Dispatches>,
    publish: Pipeline,
    bind_group: wgpu::BindGroup,
    /// The application's vertices, if the objectives are of the vertices as drawn. `None` for the positions of the
    /// mesh.
    drawn: Option<BoundVertices>,
}

/// Sweeps and evaluations of one scheme on one mesh.
pub(crate) struct Run {
    /// Dispatches of the sweeps and, for sweeps with a stop rule, of the evaluation after each sweep.
    pub(crate) dispatches: Arc<Dispatches>,
    /// Dispatches of evaluations that the application encodes. Sweeps with a stop rule need separate ones, as their
    /// history has exactly one evaluation per sweep.
    pub(crate) evaluation: Arc<Dispatches>,
    pub(crate) changes: Changes,
    /// Number of elements.
    pub(crate) elements: usize,
}

impl Run {
    /// Creates a run without sweeps, for evaluations alone.
    pub(crate) fn of_no_sweeps(
        gpu: &Gpu,
        problem: &Problem,
        mesh: &MeshBuffers,
        plan: Plan,
    ) -> Result<Self, GpuError> {
        let evaluation =
            now(Dispatches::new(gpu, problem, mesh, plan, Vec::new(), false)).map(Arc::new)?;
        let (changes, elements) = (mesh.changes.clone(), problem.judged_count());
        Ok(Self { dispatches: Arc::clone(&evaluation), evaluation, changes, elements })
    }

    /// Returns whether the sweeps end by the stop rule.
    pub(crate) fn is_judged(&self) -> bool {
        !Arc::ptr_eq(&self.dispatches, &self.evaluation)
    }
}

impl BoundObjective {
    /// Binds the evaluation of the mesh, or of the vertices that `drawn` imports, to the start of `values`.
    pub(crate) fn new(
        gpu: &Gpu,
        run: &Run,
        drawn: Option<BoundVertices>,
        values: wgpu::BufferSlice<'_>,
    ) -> Result<Self, GpuError> {
        let window = Window::new(gpu, values, size_of::<ObjectiveValues>() as u64)?;
        let mut ideal_squared = [[0.0; 4]; SLOTS.div_ceil(4)];
        let Run { dispatches, evaluation, changes, elements } = run;
        for metric in dispatches.plan.tracked() {
            let slot = metric as usize;
            ideal_squared[slot / 4][slot % 4] = metric.ideal_squared() as f32;
        }
        let uniform = WriteObjective {
            offset: window.offset,
            triangles: *elements as u32,
            judged: run.is_judged().into(),
            padding: 0,
            ideal_squared,
        };
        let bind_group = scoped_to_buffer(&gpu.device, || {
            let uniform = filled(gpu, "publish", &[uniform], Usage::UNIFORM);
            let bindings = WriteObjectiveBindings {
                publish_to: uniform.as_entire_binding(),
                control: evaluation.control.as_entire_binding(),
                sweeps: dispatches.control.as_entire_binding(),
                changes: changes.buffer.as_entire_binding(),
                destination: window.binding(),
            };
            gpu.pipelines.bind(&gpu.device, Positions::Whole, bindings)
        })?;
        let publish = gpu.pipelines.get(&gpu.device, &Kernel::WriteObjective, Positions::Whole)?;
        Ok(Self { evaluation: Arc::clone(evaluation), publish, bind_group, drawn })
    }

    /// Encodes an evaluation of the mesh at this point of the command buffer, and the writing of its
    /// [`ObjectiveValues`]. If the objective was made by
    /// [`DeviceMesh::bind_drawn_objective`](crate::gpu::DeviceMesh::bind_drawn_objective), the vertices that the vertex
    /// buffer then holds are evaluated instead.
    pub fn encode_objective(&self, encoder: &mut impl Encoder) {
        if let Some(drawn) = &self.drawn {
            drawn.encode_import(encoder);
        }
        let mut passes = encoder.passes("gpu-smooth objective");
        self.evaluation.encode_evaluation(&mut passes);
        passes.run(&self.publish, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use wgpu::naga;

    use super::*;

    /// Applications copy the WGSL struct in the comment of [`ObjectiveValues`] into their shaders.
    #[test]
    fn the_wgsl_struct_in_the_comment_of_objective_values_has_the_layout_of_the_struct() {
        let comment = include_str!("objective.rs").split("/// ```").nth(1).unwrap();
        let comment = comment.strip_prefix("wgsl\n").unwrap();
        let wgsl: String = comment.lines().map(|line| line.trim_start_matches("///")).collect();
        let module = naga::front::wgsl::parse_str(&wgsl).unwrap();
        let structs = module.types.iter().filter_map(|(_, ty)| match &ty.inner {
            naga::TypeInner::Struct { members, span } => Some((members, *span as usize)),
            _ => None,
        });
        let [(members, size)] = structs.collect::<Vec<_>>()[..] else { panic!("{wgsl}") };
        let named = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset as usize));
        let expected = [
            ("inverted", offset_of!(ObjectiveValues, inverted)),
            ("worst_imr", offset_of!(ObjectiveValues, worst_imr)),
            ("stop", offset_of!(ObjectiveValues, stop)),
            ("sweeps", offset_of!(ObjectiveValues, sweeps)),
            ("worst_element", offset_of!(ObjectiveValues, worst_element)),
            ("f", offset_of!(ObjectiveValues, f)),
        ];
        assert_eq!(named.collect::<Vec<_>>(), expected);
        assert_eq!(size, size_of::<ObjectiveValues>());
    }

    /// `write_objective.wgsl` writes these words.
    #[test]
    fn objective_values_are_laid_out_as_the_kernel_writes_them() {
        let words = [
            offset_of!(ObjectiveValues, inverted),
            offset_of!(ObjectiveValues, worst_imr),
            offset_of!(ObjectiveValues, stop),
            offset_of!(ObjectiveValues, sweeps),
            offset_of!(ObjectiveValues, worst_element),
            offset_of!(ObjectiveValues, f),
        ];
        assert_eq!(words.map(|offset| offset / 4), [0, 1, 2, 3, 4, 5]);
        assert_eq!(size_of::<ObjectiveValues>(), 4 * (5 + MOST_METRICS));
        const { assert!(Metric::ALL.len() <= MOST_METRICS) };
    }
}
