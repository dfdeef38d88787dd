//! The adapters of this machine.

use crate::adapter::AdapterSummary;
use crate::error::GpuError;
use crate::gpu::device::pending::blocking;

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
/// list is empty; an awaited [`Gpu::open`](crate::gpu::Gpu::open) finds the browser's only adapter.
pub fn adapters() -> Vec<AdapterSummary> {
    ranked_adapters().iter().map(|adapter| AdapterSummary::new(&adapter.get_info())).collect()
}

/// Returns the adapters that can compute, fastest kind first. Adapters of OpenGL are listed only if other backends have
/// none: they repeat the same devices, and their driver starts slowly.
pub(crate) fn ranked_adapters() -> Vec<wgpu::Adapter> {
    blocking(async { Ok::<_, GpuError>(awaited_adapters().await) }).unwrap_or_default()
}

/// Returns the adapters that can compute like [`ranked_adapters`], without blocking.
pub(crate) async fn awaited_adapters() -> Vec<wgpu::Adapter> {
    let compiled = wgpu::Instance::enabled_backend_features();
    let native = usable_adapters(wgpu::Backends::PRIMARY, compiled).await;
    match native.is_empty() {
        true => usable_adapters(wgpu::Backends::SECONDARY, compiled).await,
        false => native,
    }
}

/// Returns the adapters of `backends` that can compute. `compiled` are the backends that the build has on this platform.
async fn usable_adapters(backends: wgpu::Backends, compiled: wgpu::Backends) -> Vec<wgpu::Adapter> {
    // wgpu panics if the build has no backend of the platform, as with the feature `metal` on Linux.
    if compiled.is_empty() {
        return Vec::new();
    }
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
    fn without_a_backend_of_the_platform_there_is_no_adapter() {
        let none = wgpu::Backends::empty();
        for backends in [wgpu::Backends::PRIMARY, wgpu::Backends::SECONDARY] {
            let adapters = pollster::block_on(usable_adapters(backends, none));
            assert!(adapters.is_empty());
        }
        let compiled = wgpu::Instance::enabled_backend_features();
        let all = pollster::block_on(usable_adapters(wgpu::Backends::all(), compiled));
        assert!(!all.is_empty(), "the tests need an adapter");
    }

    /// A build with the features `--no-default-features --features gpu` has this test alone. The other tests of this
    /// module need an adapter.
    #[cfg(not(any(feature = "vulkan", feature = "gles", feature = "metal", feature = "dx12")))]
    #[test]
    fn a_build_without_a_backend_has_no_adapter() {
        assert!(adapters().is_empty() && crate::gpu::checked_adapters().is_empty());
        assert!(matches!(Gpu::open(None).block(), Err(GpuError::NoAdapter { .. })));
        let size = crate::MeshSize { vertices: 3_000_000, triangles: 6_000_000 };
        let (backend, reason) = crate::Backend::auto(size, &crate::Options::default());
        assert!(matches!(backend, crate::Backend::Cpu), "{reason}");
    }

    #[test]
    fn an_adapter_without_a_name_is_called_unnamed() {
        let gpu = Gpu::open(None).block().unwrap();
        let info = gpu.device.adapter_info();
        assert_eq!(AdapterSummary::new(&info), *gpu.adapter());
        let unnamed = wgpu::AdapterInfo { name: String::new(), ..info };
        assert_eq!(AdapterSummary::new(&unnamed).name, "unnamed adapter");
    }
}
