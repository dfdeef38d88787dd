//! Creates pipelines and bind groups. The pipelines of runs are created once for a device.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use web_time::Instant;

use crate::error::GpuError;
use crate::gpu::kernels::form::{MeshForm, Positions};
use crate::gpu::kernels::layouts::{BindLayout, Bindings};
use crate::gpu::kernels::table::Kernel;
use crate::gpu::scope::{Counters, WatchedDevice, scoped};

/// A kernel that is ready to run.
#[derive(Clone)]
pub(crate) struct Pipeline {
    pub(crate) kernel: Kernel,
    pub(crate) raw: wgpu::ComputePipeline,
    /// Counters of the device.
    counters: Arc<Counters>,
}

impl Pipeline {
    /// Counts a dispatch of the kernel.
    pub(crate) fn count_dispatch(&self) {
        self.counters.add_dispatch(matches!(self.kernel, Kernel::Sweep(..)));
    }
}

/// A pipeline, `None` before it is compiled. The lock is held during compilation, so that a second thread that needs the kernel
/// waits for the first.
type Slot = Arc<Mutex<Option<wgpu::ComputePipeline>>>;

/// Pipelines of a device, each compiled at the first request.
#[derive(Default)]
pub(crate) struct Pipelines {
    layouts: [[OnceLock<Layout>; Positions::ALL.len()]; BindLayout::ALL.len()],
    made: Mutex<HashMap<(Kernel, MeshForm), Slot>>,
    /// A pipeline cache of the application.
    cache: Option<wgpu::PipelineCache>,
}

/// wgpu's bind group layout and pipeline layout for one [`BindLayout`].
struct Layout {
    bindings: wgpu::BindGroupLayout,
    pipeline: wgpu::PipelineLayout,
}

impl Layout {
    fn new(device: &wgpu::Device, layout: BindLayout, positions: Positions) -> Self {
        let entries: Vec<_> = layout
            .accesses(positions)
            .into_iter()
            .zip(0..)
            .map(|(access, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: access.ty(),
                count: None,
            })
            .collect();
        let label = format!("gpu-smooth {layout:?}");
        let bindings = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(&label),
            entries: &entries,
        });
        let pipeline = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&label),
            bind_group_layouts: &[Some(&bindings)],
            immediate_size: 0,
        });
        Self { bindings, pipeline }
    }
}

impl Pipelines {
    /// Creates an empty set of pipelines, with a cache of the application for their compilation.
    pub(crate) fn with_cache(cache: wgpu::PipelineCache) -> Self {
        Self { cache: Some(cache), ..Self::default() }
    }

    /// Returns wgpu's layouts for a bind layout, created at the first request. Must be called in an error scope.
    fn layout(&self, device: &wgpu::Device, layout: BindLayout, positions: Positions) -> &Layout {
        let positions = layout.sees(positions);
        self.layouts[layout as usize][positions as usize]
            .get_or_init(|| Layout::new(device, layout, positions))
    }

    /// Creates the bind group of a bind layout from its resources. Must be called in an error scope.
    pub(crate) fn bind<'a, B: Bindings<'a>>(
        &self,
        device: &wgpu::Device,
        form: impl Into<MeshForm>,
        bindings: B,
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = bindings
            .resources()
            .into_iter()
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&format!("gpu-smooth {:?}", B::LAYOUT)),
            layout: &self.layout(device, B::LAYOUT, form.into().positions).bindings,
            entries: &entries,
        })
    }

    /// Returns the slot of a kernel for meshes of a form that the kernel sees.
    fn slot(&self, kernel: &Kernel, form: MeshForm) -> Slot {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(made.entry((kernel.clone(), form)).or_default())
    }

    /// Returns whether the pipeline of a kernel is compiled.
    pub(crate) fn has(&self, kernel: &Kernel, form: MeshForm) -> bool {
        let slot = self.slot(kernel, kernel.sees(form));
        slot.try_lock().is_ok_and(|made| made.is_some())
    }

    /// Returns the pipeline of a kernel for meshes of this form, compiled at the first request. Waits if another thread compiles
    /// the kernel.
    pub(crate) fn get(
        &self,
        device: &WatchedDevice,
        kernel: &Kernel,
        form: impl Into<MeshForm>,
    ) -> Result<Pipeline, GpuError> {
        let form = kernel.sees(form.into());
        let ready = |raw: &wgpu::ComputePipeline| Pipeline {
            kernel: kernel.clone(),
            raw: raw.clone(),
            counters: Arc::clone(device.counters()),
        };
        let slot = self.slot(kernel, form);
        let mut made = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(raw) = &*made {
            return Ok(ready(raw));
        }
        let wgsl = kernel.composed(form);
        let raw = scoped(device, || self.compile(device, kernel, form.positions, wgsl))?;
        Ok(ready(made.insert(raw)))
    }

    /// Compiles `wgsl` with the entry point and the bindings of a kernel. Must be called in an error scope.
    pub(crate) fn compile(
        &self,
        device: &WatchedDevice,
        kernel: &Kernel,
        positions: Positions,
        wgsl: String,
    ) -> wgpu::ComputePipeline {
        let (label, began) = (kernel.label(), Instant::now());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&label),
            source: wgpu::ShaderSource::Wgsl(wgsl.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&label),
            layout: Some(&self.layout(device, kernel.layout(), positions).pipeline),
            module: &module,
            entry_point: Some(kernel.entry_point()),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: self.cache.as_ref(),
        });
        device.counters().add_kernel(began.elapsed());
        pipeline
    }
}

#[cfg(test)]
mod tests {
    use wgpu::naga::{self, AddressSpace, StorageAccess};

    use super::*;
    use crate::gpu::kernels::layouts::Access;
    use crate::layout::MapKind;

    #[test]
    fn every_kernel_declares_the_bindings_of_its_layout() {
        let both = [false, true];
        let forms: Vec<MeshForm> = Positions::ALL
            .into_iter()
            .flat_map(|positions| MapKind::ALL.map(|maps| MeshForm { maps, ..positions.into() }))
            .flat_map(|form| both.map(|is_bounded| MeshForm { is_bounded, ..form }))
            .flat_map(|form| both.map(|quads| MeshForm { has_quadrilaterals: quads, ..form }))
            .collect();
        let each =
            |kernel: Kernel| forms.clone().into_iter().map(move |form| (kernel.clone(), form));
        for (kernel, form) in Kernel::all().into_iter().flat_map(each) {
            let module = naga::front::wgsl::parse_str(&kernel.composed(form)).unwrap();
            let bound = module.global_variables.iter().filter_map(|(_, v)| Some((v.binding?, v)));
            let mut spaces: Vec<_> = bound
                .map(|(at, variable)| (at.group, at.binding as usize, variable.space))
                .collect();
            spaces.sort_unstable_by_key(|&(group, binding, _)| (group, binding));
            let wanted = kernel.layout().accesses(form.positions);
            let wanted = wanted.iter().enumerate().map(|(i, access)| {
                let space = match access {
                    Access::Uniform | Access::DynamicUniform => AddressSpace::Uniform,
                    Access::Read => AddressSpace::Storage { access: StorageAccess::LOAD },
                    Access::ReadWrite | Access::Positions => {
                        AddressSpace::Storage { access: StorageAccess::LOAD | StorageAccess::STORE }
                    }
                };
                (0, i, space)
            });
            assert_eq!(spaces, wanted.collect::<Vec<_>>(), "{}", kernel.label());
        }
    }

    #[test]
    fn prepared_pipelines_are_not_compiled_again() {
        use crate::gpu::{DeviceMesh, Gpu, Sweeps, VertexBuffer};
        use crate::{Mesh, Options};

        let gpu = Gpu::open(None).block().unwrap();
        let made = || gpu.pipelines.made.lock().unwrap().len();
        let options = Options { scheme: "edge+imr".parse().unwrap(), ..Options::default() };
        assert_eq!(made(), 0);
        gpu.prepare(&options).unwrap();
        let prepared = made();
        assert!(prepared >= 7, "{prepared}");

        let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.4]];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = DeviceMesh::new(&gpu, &Mesh { points, triangles, ..Mesh::default() }).unwrap();
        let sweeps = Sweeps::new(&mesh, &options).block().unwrap();
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 64,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let vertices = VertexBuffer::new(buffer.slice(..), 8);
        let _bound =
            (mesh.bind_vertices(&vertices).unwrap(), sweeps.bind_objective(buffer.slice(..)));
        assert_eq!(made(), prepared);
    }
}
