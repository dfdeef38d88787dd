//! The adapters of this machine.

use crate::adapter::AdapterSummary;
use crate::error::GpuError;
use crate::gpu::device::blocking::blocking;

impl AdapterSummary {
    pub(crate) fn new(info: &wgpu::AdapterInfo) -> Self {
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete GPU",
            wgpu::DeviceType::IntegratedGpu => "integrated GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Cpu => "CPU",
            wgpu::DeviceType::Other => "other",
        };
        let driver = [info.driver.trim(), info.driver_info.trim()];
        let driver: Vec<_> = driver.into_iter().filter(|part| !part.is_empty()).collect();
        let name = match info.name.as_str() {
            "" => "unnamed adapter",
            name => name,
        };
        Self {
            name: name.to_owned(),
            driver: driver.join(" "),
            backend: info.backend.to_string(),
            kind,
        }
    }
}

/// Lists the adapters of this machine that can compute, in order of preference, without opening any. In a browser the
/// list is empty; [`Gpu::open_async`](crate::gpu::Gpu::open_async) finds the browser's only adapter.
pub fn adapters() -> Vec<AdapterSummary> {
    ranked_adapters().iter().map(|adapter| AdapterSummary::new(&adapter.get_info())).collect()
}

/// Returns the adapters that can compute, fastest kind first. Adapters of OpenGL are listed only if other backends have
/// none: they repeat the same devices, and their driver starts slowly.
pub(crate) fn ranked_adapters() -> Vec<wgpu::Adapter> {
    blocking(async { Ok::<_, GpuError>(ranked_adapters_async().await) }).unwrap_or_default()
}

/// Returns the adapters that can compute like [`ranked_adapters`], without blocking.
pub(crate) async fn ranked_adapters_async() -> Vec<wgpu::Adapter> {
    let native = usable_adapters(wgpu::Backends::PRIMARY).await;
    match native.is_empty() {
        true => usable_adapters(wgpu::Backends::SECONDARY).await,
        false => native,
    }
}

async fn usable_adapters(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        // Validation layers print to the caller's terminal.
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters = instance.enumerate_adapters(backends).await;
    let can_compute = |adapter: &wgpu::Adapter| {
        let downlevel = adapter.get_downlevel_capabilities();
        downlevel.flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
    };
    adapters.retain(can_compute);
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::device::Gpu;

    #[test]
    fn an_adapter_without_a_name_is_called_unnamed() {
        let gpu = Gpu::open(None).unwrap();
        let info = gpu.device.adapter_info();
        assert_eq!(AdapterSummary::new(&info), *gpu.adapter());
        let unnamed = wgpu::AdapterInfo { name: String::new(), ..info };
        assert_eq!(AdapterSummary::new(&unnamed).name, "unnamed adapter");
    }
}
