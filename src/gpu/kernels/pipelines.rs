//! Creates pipelines and bind groups. The pipelines of runs are created once for a device.

use std::collections::HashMap;
use std::sync::{Mutex, OnceLock, PoisonError};

use crate::error::GpuError;
use crate::gpu::kernels::table::{Interface, Kernel, MeshForm, Positions};
use crate::gpu::scope::scoped;

/// Returns the bindings of group 0, in order. Tests compare them with the WGSL.
fn bindings(interface: Interface, positions: Positions) -> Vec<Binding> {
    let mut bindings = bindings_of_whole(interface).to_vec();
    if interface.sees(positions) == Positions::InTwo {
        bindings.push(Binding::ReadWrite);
    }
    bindings
}

/// Returns the bindings of group 0 for positions in one binding.
fn bindings_of_whole(interface: Interface) -> &'static [Binding] {
    use Binding::{ReadOnly, ReadWrite, Uniform};
    const UNIFORM: Binding = Uniform { dynamic: false };
    match interface {
        Interface::Run => &[
            UNIFORM,
            Uniform { dynamic: true },
            ReadWrite,
            ReadOnly,
            ReadOnly,
            ReadOnly,
            ReadWrite,
            ReadWrite,
            ReadWrite,
        ],
        Interface::Exchange => &[UNIFORM, ReadWrite, ReadOnly, ReadWrite, ReadWrite],
        Interface::Publish => &[UNIFORM, ReadOnly, ReadOnly, ReadOnly, ReadWrite],
        Interface::Reopen => &[ReadWrite, ReadOnly],
        Interface::Restore => &[UNIFORM, ReadWrite, ReadWrite, ReadOnly, ReadWrite],
        Interface::Mask => &[UNIFORM, ReadWrite, ReadOnly, ReadOnly, ReadOnly, ReadWrite],
        Interface::Move => {
            &[UNIFORM, ReadWrite, ReadOnly, ReadOnly, ReadOnly, ReadWrite, ReadWrite]
        }
        Interface::Untangle => &[
            UNIFORM,
            Uniform { dynamic: true },
            ReadWrite,
            ReadOnly,
            ReadOnly,
            ReadOnly,
            ReadWrite,
            ReadWrite,
            ReadWrite,
        ],
        Interface::Fine => &[
            UNIFORM,
            Uniform { dynamic: true },
            ReadWrite,
            ReadOnly,
            ReadOnly,
            ReadOnly,
            ReadWrite,
            ReadWrite,
            ReadWrite,
        ],
        Interface::Transfer => &[
            UNIFORM,
            Uniform { dynamic: true },
            ReadOnly,
            ReadOnly,
            ReadOnly,
            ReadOnly,
            ReadWrite,
            ReadWrite,
            ReadWrite,
        ],
        Interface::Coarse => &[UNIFORM, Uniform { dynamic: true }, ReadOnly, ReadOnly, ReadWrite],
        Interface::Search => &[UNIFORM, ReadOnly, ReadWrite],
        Interface::Secants => &[
            UNIFORM,
            Uniform { dynamic: true },
            ReadWrite,
            ReadWrite,
            ReadWrite,
            ReadWrite,
            ReadWrite,
            ReadWrite,
            ReadWrite,
        ],
        Interface::Arithmetic => &[UNIFORM, ReadOnly, ReadWrite],
    }
}

#[derive(Clone, Copy, Debug)]
enum Binding {
    Uniform { dynamic: bool },
    ReadOnly,
    ReadWrite,
}

impl Binding {
    fn ty(self) -> wgpu::BindingType {
        let (ty, has_dynamic_offset) = match self {
            Binding::Uniform { dynamic } => (wgpu::BufferBindingType::Uniform, dynamic),
            Binding::ReadOnly => (wgpu::BufferBindingType::Storage { read_only: true }, false),
            Binding::ReadWrite => (wgpu::BufferBindingType::Storage { read_only: false }, false),
        };
        wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None }
    }
}

/// The most storage buffers that a kernel binds.
pub(crate) fn storage_bindings(positions: Positions) -> u32 {
    let bindings = bindings(Interface::Run, positions);
    bindings.iter().filter(|b| !matches!(b, Binding::Uniform { .. })).count() as u32
}

/// A kernel that is ready to run.
#[derive(Clone)]
pub(crate) struct Pipeline {
    pub(crate) kernel: Kernel,
    pub(crate) raw: wgpu::ComputePipeline,
}

/// The pipelines of a device, each created when it is first requested.
#[derive(Default)]
pub(crate) struct Pipelines {
    layouts: [[OnceLock<Layout>; Positions::ALL.len()]; Interface::ALL.len()],
    made: Mutex<HashMap<(Kernel, MeshForm), wgpu::ComputePipeline>>,
    /// A pipeline cache of the application.
    cache: Option<wgpu::PipelineCache>,
}

/// The layout of one [`Interface`].
struct Layout {
    bindings: wgpu::BindGroupLayout,
    pipeline: wgpu::PipelineLayout,
}

impl Layout {
    fn new(device: &wgpu::Device, interface: Interface, positions: Positions) -> Self {
        let entries: Vec<_> = bindings(interface, positions)
            .iter()
            .zip(0..)
            .map(|(kind, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: kind.ty(),
                count: None,
            })
            .collect();
        let label = format!("gpu-smooth {interface:?}");
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
    /// Makes an empty set of pipelines, which will be compiled with the given cache.
    pub(crate) fn with_cache(cache: wgpu::PipelineCache) -> Self {
        Self { cache: Some(cache), ..Self::default() }
    }

    /// To be called in an error scope.
    fn layout(&self, device: &wgpu::Device, interface: Interface, positions: Positions) -> &Layout {
        let positions = interface.sees(positions);
        self.layouts[interface as usize][positions as usize]
            .get_or_init(|| Layout::new(device, interface, positions))
    }

    /// Binds resources in the order of the interface. To be called in an error scope.
    pub(crate) fn bind(
        &self,
        device: &wgpu::Device,
        interface: Interface,
        form: impl Into<MeshForm>,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = resources
            .iter()
            .cloned()
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&format!("gpu-smooth {interface:?}")),
            layout: &self.layout(device, interface, form.into().positions).bindings,
            entries: &entries,
        })
    }

    /// Returns the pipeline of a kernel, which is compiled when it is first requested.
    pub(crate) fn get(
        &self,
        device: &wgpu::Device,
        kernel: &Kernel,
        form: impl Into<MeshForm>,
    ) -> Result<Pipeline, GpuError> {
        let form = kernel.sees(form.into());
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(raw) = made.get(&(kernel.clone(), form)) {
            return Ok(Pipeline { kernel: kernel.clone(), raw: raw.clone() });
        }
        let wgsl = kernel.composed(form);
        let raw = scoped(device, || self.compile(device, kernel, form.positions, wgsl))?;
        made.insert((kernel.clone(), form), raw.clone());
        Ok(Pipeline { kernel: kernel.clone(), raw })
    }

    /// Compiles `wgsl` with the entry point and the bindings of a kernel. To be called in an error scope.
    pub(crate) fn compile(
        &self,
        device: &wgpu::Device,
        kernel: &Kernel,
        positions: Positions,
        wgsl: String,
    ) -> wgpu::ComputePipeline {
        let label = kernel.label();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&label),
            source: wgpu::ShaderSource::Wgsl(wgsl.into()),
        });
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&label),
            layout: Some(&self.layout(device, kernel.interface(), positions).pipeline),
            module: &module,
            entry_point: Some(kernel.entry_point()),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: self.cache.as_ref(),
        })
    }
}

#[cfg(test)]
mod tests {
    use naga::{AddressSpace, StorageAccess};

    use super::*;
    use crate::metric::Metric;
    use crate::run::Derivatives;

    fn kernels() -> Vec<Kernel> {
        let all = Metric::ALL.to_vec();
        let sweep = |&metric| Kernel::Sweep(metric, Derivatives::Analytic);
        let mut kernels: Vec<_> = all.iter().map(sweep).collect();
        let differences = |&metric| Kernel::Sweep(metric, Derivatives::FiniteDifference);
        kernels.extend(all.iter().map(differences));
        kernels.extend([Kernel::Objective(all.clone()), Kernel::Finish(all), Kernel::KeepBest]);
        kernels.extend([Kernel::Import, Kernel::Export, Kernel::Publish, Kernel::CheckArithmetic]);
        kernels.extend([Kernel::FindShare, Kernel::MoveVertices, Kernel::Reopen, Kernel::Resume]);
        kernels.extend([Kernel::HoldByMask, Kernel::RestoreLastValid]);
        kernels.extend([Kernel::FindInverted, Kernel::Regularize, Kernel::Untangle]);
        kernels.extend(Metric::ALL.iter().flat_map(|&metric| Kernel::of_levels(metric)));
        kernels
    }

    #[test]
    fn every_kernel_declares_the_bindings_of_its_interface() {
        let form = |positions| [false, true].map(|has_targets| MeshForm { positions, has_targets });
        let forms = Positions::ALL.map(form).concat();
        let each =
            |kernel: Kernel| forms.clone().into_iter().map(move |form| (kernel.clone(), form));
        for (kernel, form) in kernels().into_iter().flat_map(each) {
            let module = naga::front::wgsl::parse_str(&kernel.composed(form)).unwrap();
            let bound = module.global_variables.iter().filter_map(|(_, v)| Some((v.binding?, v)));
            let mut spaces: Vec<_> = bound
                .map(|(at, variable)| (at.group, at.binding as usize, variable.space))
                .collect();
            spaces.sort_unstable_by_key(|&(group, binding, _)| (group, binding));
            let wanted = bindings(kernel.interface(), form.positions);
            let wanted = wanted.iter().enumerate().map(|(i, binding)| {
                let space = match binding {
                    Binding::Uniform { .. } => AddressSpace::Uniform,
                    Binding::ReadOnly => AddressSpace::Storage { access: StorageAccess::LOAD },
                    Binding::ReadWrite => {
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

        let gpu = Gpu::open(None).unwrap();
        let made = || gpu.pipelines.made.lock().unwrap().len();
        let options = Options { scheme: "edge+imr".parse().unwrap(), ..Options::default() };
        assert_eq!(made(), 0);
        gpu.prepare(&options).unwrap();
        let prepared = made();
        assert!(prepared >= 7, "{prepared}");

        let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.4]];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = DeviceMesh::new(&gpu, &Mesh { points, triangles, fixed: vec![] }).unwrap();
        let sweeps = Sweeps::new(&mesh, &options).unwrap();
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 64,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let vertices = VertexBuffer::new(&buffer, 8);
        let _bound = (mesh.bind_vertices(&vertices).unwrap(), sweeps.bind_objective(&buffer, 0));
        assert_eq!(made(), prepared);
    }

    #[test]
    fn storage_bindings_fit_the_default_limits() {
        let declared = wgpu::Limits::default().max_storage_buffers_per_shader_stage;
        assert_eq!(Positions::ALL.map(storage_bindings), [7, 8]);
        assert!(storage_bindings(Positions::InTwo) <= declared);
    }
}
