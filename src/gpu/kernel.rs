//! Pipelines: the only place that makes them, each once per device.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use super::device::{GpuError, scoped};
use super::shaders::Kernel;

/// How a kernel sees a binding of `shaders/common.wgsl`.
const BINDINGS: [Binding; 9] = [
    Binding::Uniform { dynamic: false },
    Binding::Uniform { dynamic: true },
    Binding::ReadWrite,
    Binding::ReadOnly,
    Binding::ReadOnly,
    Binding::ReadOnly,
    Binding::ReadWrite,
    Binding::ReadWrite,
    Binding::ReadWrite,
];

#[derive(Clone, Copy)]
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

/// Number of storage buffers a kernel sees, to be held against the device's limit.
pub(crate) fn storage_bindings() -> u32 {
    BINDINGS.iter().filter(|b| !matches!(b, Binding::Uniform { .. })).count() as u32
}

/// The pipelines of a device, all of one layout, made when first asked for.
pub(crate) struct Pipelines {
    pub(crate) bindings: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    made: Mutex<HashMap<Kernel, wgpu::ComputePipeline>>,
}

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let entries: Vec<_> = BINDINGS
            .iter()
            .zip(0..)
            .map(|(kind, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: kind.ty(),
                count: None,
            })
            .collect();
        let bindings = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("gpu-smooth bindings"),
            entries: &entries,
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("gpu-smooth layout"),
            bind_group_layouts: &[Some(&bindings)],
            immediate_size: 0,
        });
        Self { bindings, layout, made: Mutex::default() }
    }

    /// The pipeline of a kernel.
    pub(crate) fn get(
        &self,
        device: &wgpu::Device,
        kernel: &Kernel,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = made.get(kernel) {
            return Ok(pipeline.clone());
        }
        let label = kernel.label();
        let pipeline = scoped(device, || {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(&label),
                source: wgpu::ShaderSource::Wgsl(kernel.wgsl().into()),
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(&label),
                layout: Some(&self.layout),
                module: &module,
                entry_point: Some(kernel.entry_point()),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        })?;
        made.insert(kernel.clone(), pipeline.clone());
        Ok(pipeline)
    }
}

#[cfg(test)]
mod tests {
    use naga::{AddressSpace, StorageAccess};

    use super::*;
    use crate::metric::Metric;
    use crate::plan::Derivatives;

    fn kernels() -> Vec<Kernel> {
        let all = Metric::ALL.to_vec();
        let sweep = |&metric| Kernel::Sweep(metric, Derivatives::Analytic);
        let mut kernels: Vec<_> = all.iter().map(sweep).collect();
        let differences = |&metric| Kernel::Sweep(metric, Derivatives::FiniteDifference);
        kernels.extend(all.iter().map(differences));
        kernels.extend([Kernel::Objective(all.clone()), Kernel::Finish(all), Kernel::KeepBest]);
        kernels
    }

    #[test]
    fn every_kernel_declares_the_bindings_of_the_one_layout() {
        for kernel in kernels() {
            let module = naga::front::wgsl::parse_str(&kernel.wgsl()).unwrap();
            let bound = module.global_variables.iter().filter_map(|(_, v)| Some((v.binding?, v)));
            let mut spaces: Vec<_> = bound
                .map(|(at, variable)| (at.group, at.binding as usize, variable.space))
                .collect();
            spaces.sort_unstable_by_key(|&(group, binding, _)| (group, binding));
            let wanted = BINDINGS.iter().enumerate().map(|(i, binding)| {
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
    fn storage_bindings_fit_the_default_limits() {
        let declared = wgpu::Limits::default().max_storage_buffers_per_shader_stage;
        assert_eq!(storage_bindings(), 7);
        assert!(storage_bindings() <= declared);
    }
}
