//! Sweeps that untangle a mesh, for an application's command encoder.

use std::ops::Range;

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::buffers::{filled, uniform};
use crate::gpu::embed::DeviceMesh;
use crate::gpu::encode::{Encoder, Passes};
use crate::gpu::kernels::dispatch::dispatch;
use crate::gpu::kernels::layouts::UntangleBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::kernels::uniforms::{Params, Tangle, TangledVertex, UntanglePart};
use crate::gpu::mesh::{ElementPart, Parts};
use crate::gpu::scope::scoped;
use crate::layout::{Problem, target_areas};

/// Vertices or triangles that one invocation visits, as software drivers are slow to start invocations.
const EACH: u32 = 8;

/// Sweeps that turn inverted triangles back, bound to a mesh on the device. Frames in which the application may invert
/// triangles encode them before ordinary sweeps. If no triangle is inverted or flat, untangling sweeps check the
/// triangles once and change no bit of any position.
///
/// ```no_run
/// # use gpu_smooth::{*, gpu::*};
/// # fn f(
/// #     mesh: &DeviceMesh, vertices: &BoundVertices, sweeps: &mut Sweeps, encoder: &mut wgpu::CommandEncoder,
/// # ) -> Result<(), GpuError> {
/// // Once.
/// let untangling = UntanglingSweeps::new(mesh)?;
/// // In each frame.
/// vertices.encode_import(encoder);
/// untangling.encode_untangle(encoder, 5);
/// sweeps.encode_sweeps(encoder, 3);
/// vertices.encode_export(encoder);
/// # Ok(())
/// # }
/// ```
///
/// A sweep moves vertices by Newton steps on the energy of [`Untangle`](crate::Untangle): at first the vertices of
/// inverted triangles, and in each further sweep also the vertices one edge farther off. Held vertices stay in place. A
/// triangle whose vertices are all held or on the boundary is skipped, as no sweep can repair it.
///
/// No proof guarantees that sweeps untangle every mesh that can be untangled.
/// [`ObjectiveValues::inverted`](crate::gpu::ObjectiveValues::inverted) counts the triangles that are left. Sweeps and
/// values count areas that are not positive in single precision as inverted.
pub struct UntanglingSweeps {
    /// The pipelines that search for inverted elements, in the order of the parts of elements.
    find: Vec<Pipeline>,
    regularize: Pipeline,
    untangle: Pipeline,
    /// Bind groups by part of the mesh.
    bind_groups: Vec<wgpu::BindGroup>,
    dispatches: Dispatches,
}

/// Uniforms of all dispatches, in this order: element parts in a call's first sweep, element parts in further sweeps,
/// vertex parts by color.
struct Dispatches {
    elements: Vec<ElementPart>,
    /// Color, part of the mesh and vertex range of each dispatch.
    vertices: Vec<(u32, usize, Range<u32>)>,
    /// Distance between successive uniforms, in bytes.
    stride: u32,
}

impl Dispatches {
    /// Returns the dispatches, and the bytes of their uniforms.
    fn new(problem: &Problem, parts: &Parts, alignment: u32) -> (Self, Vec<u8>) {
        let stride = alignment.max(size_of::<UntanglePart>() as u32);
        let free = problem.free_count() as u32;
        let part = |(first, count): (u32, u32), ring_base, begins| UntanglePart {
            first,
            count,
            ring_base,
            free,
            begins,
            padding: 0,
            more_padding: [0; 2],
        };
        let mut uniforms = Vec::new();
        for begins in [1, 0] {
            let of = |elements: &ElementPart| (elements.first, elements.count());
            uniforms.extend(parts.elements.iter().map(|elements| part(of(elements), 0, begins)));
        }
        let mut vertices = Vec::new();
        for (color, of_color) in (0..).zip(problem.colors()) {
            for (number, ring) in parts.rings.iter().enumerate() {
                let first = of_color.start.max(ring.vertices.start);
                let end = of_color.end.min(ring.vertices.end);
                if first < end {
                    uniforms.push(part((first, end - first), ring.entries.start, 0));
                    vertices.push((color, number, first..end));
                }
            }
        }
        let mut bytes = vec![0; uniforms.len() * stride as usize];
        for (part, chunk) in uniforms.iter().zip(bytes.chunks_exact_mut(stride as usize)) {
            chunk[..size_of::<UntanglePart>()].copy_from_slice(bytemuck::bytes_of(part));
        }
        (Self { elements: parts.elements.clone(), vertices, stride }, bytes)
    }
}

impl UntanglingSweeps {
    /// Binds untangling to a mesh on the device, at 8 more bytes per vertex. The desired areas of triangles follow the
    /// areas at upload. Only ratios of desired areas matter, and only while triangles are inverted.
    ///
    /// Compiles kernels that are not compiled yet; [`Gpu::prepare`](crate::Gpu::prepare) compiles kernels beforehand.
    /// Any thread may call this function.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`], or another [`GpuError`] if the device fails.
    pub fn new(mesh: &DeviceMesh) -> Result<Self, GpuError> {
        let DeviceMesh { gpu, problem, buffers, .. } = mesh;
        let form = buffers.parts.form();
        let pipeline = |kernel| gpu.pipelines.get(&gpu.device, &kernel, form);
        let find = buffers.parts.elements.iter().map(|elements| {
            gpu.pipelines.get(&gpu.device, &Kernel::FindInverted, elements.form(form))
        });
        let find = find.collect::<Result<Vec<_>, _>>()?;
        let [regularize, untangle] = [Kernel::Regularize, Kernel::Untangle].map(pipeline);
        let alignment = gpu.device.limits().min_uniform_buffer_offset_alignment;
        let (dispatches, parts) = Dispatches::new(problem, &buffers.parts, alignment);
        let areas = target_areas(problem, problem.positions());
        let vertices = areas.iter().map(|&area| TangledVertex { area: area as f32, reached: 0 });
        let vertices: Vec<TangledVertex> = vertices.collect();
        let maps = problem.positions().len() as u32;
        let params = Params::outside_runs(maps);
        // Vertices are marked by numbers of sweeps, from 1 on. No vertex is marked yet.
        let tangle = Tangle { valid: 0, inverted: 0, depth: 0, epsilon: 0.0, sweep: 1, since: 1 };
        let bind_groups = scoped(&gpu.device, || {
            let params = filled(gpu, "untangling params", &[params], Usage::UNIFORM);
            let parts = filled(gpu, "untangling parts", &parts, Usage::UNIFORM);
            let tangle = filled(gpu, "tangle", &[tangle], Usage::STORAGE);
            let vertices = filled(gpu, "tangled vertices", &vertices, Usage::STORAGE);
            let bind = |part| {
                let bindings = UntangleBindings {
                    params: params.as_entire_binding(),
                    part: uniform::<UntanglePart>(&parts),
                    positions: buffers.bind_positions(),
                    ring_start: buffers.ring_start.as_entire_binding(),
                    ring: buffers.bind_ring(part),
                    triangles: buffers.bind_elements(part),
                    tangle: tangle.as_entire_binding(),
                    vertices: vertices.as_entire_binding(),
                    changes: buffers.changes.buffer.as_entire_binding(),
                };
                gpu.pipelines.bind(&gpu.device, form, bindings)
            };
            (0..buffers.parts.count()).map(bind).collect()
        })?;
        Ok(Self { find, regularize: regularize?, untangle: untangle?, bind_groups, dispatches })
    }

    /// Encodes this many untangling sweeps. When the command buffer runs, the sweeps do nothing once no triangle is
    /// inverted or flat.
    ///
    /// Each sweep begins with a check of all triangles. Sweeps that find inverted triangles count as a change of the
    /// mesh: sweeps [`until_converged`](crate::gpu::Sweeps::until_converged) begin again.
    pub fn encode_untangle(&self, encoder: &mut impl Encoder, sweeps: u32) {
        let mut passes = encoder.passes("gpu-smooth untangling");
        let Dispatches { elements, vertices, .. } = &self.dispatches;
        for sweep in 0..sweeps {
            let first = if sweep == 0 { 0 } else { elements.len() };
            for (part, (elements, find)) in elements.iter().zip(&self.find).enumerate() {
                self.run(&mut passes, find, None, part, first + part, elements.count());
            }
            self.run(&mut passes, &self.regularize, None, 0, first, 1);
            for ((color, part, range), uniform) in vertices.iter().zip(2 * elements.len()..) {
                let count = range.end - range.start;
                self.run(&mut passes, &self.untangle, Some(*color), *part, uniform, count);
            }
        }
    }

    /// Encodes a dispatch that visits `invocations` vertices or triangles, [`EACH`] per invocation, with the bind group
    /// `part` and the uniform `uniform`, both by index.
    fn run(
        &self,
        passes: &mut Passes<'_>,
        pipeline: &Pipeline,
        color: Option<u32>,
        part: usize,
        uniform: usize,
        invocations: u32,
    ) {
        passes.run(pipeline, color, |pass| {
            let offset = uniform as u32 * self.dispatches.stride;
            pass.set_bind_group(0, &self.bind_groups[part], &[offset]);
            dispatch(pass, invocations.div_ceil(EACH));
        });
    }
}
