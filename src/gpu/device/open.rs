//! Opens adapters, and skips those whose arithmetic is wrong.

use crate::adapter::AdapterSummary;
use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::adapters::{awaited_adapters, ranked_adapters};
use crate::gpu::device::pending::{Pending, Waiting, blocking};
use crate::gpu::scope::{WatchedDevice, caught};

impl Gpu {
    /// Opens the best adapter whose name contains `name` (case is ignored), or the best of all adapters for `None`.
    /// Discrete GPUs are preferred to integrated, virtual, other and software adapters, in this order. An adapter that
    /// fails [`Gpu::check_arithmetic`] is skipped. Except in a browser, the future of an awaited call blocks its thread
    /// while the arithmetic is checked.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] if the machine has no adapter with this name; [`GpuError::NoDevice`] if the adapter
    /// refuses to create a device; [`GpuError::Arithmetic`] for the best adapter if every adapter fails the check; or
    /// another [`GpuError`] if the device fails.
    pub fn open(name: Option<&str>) -> Pending<'_, Self> {
        Pending::new(move |_| Box::pin(Self::best(name)))
    }

    async fn best(name: Option<&str>) -> Result<Self, GpuError> {
        let adapters = awaited_adapters().await;
        let has_name = |adapter: &&wgpu::Adapter| {
            let text = adapter.get_info().name.to_lowercase();
            name.is_none_or(|name| text.contains(&name.to_lowercase()))
        };
        match first_that_passes(adapters.iter().filter(has_name), Self::started).await {
            Some(opened) => opened,
            None => {
                let names: Vec<_> = adapters.iter().map(|a| a.get_info().name).collect();
                let (wanted, available) = (name.map(str::to_owned), names.join(", "));
                Err(GpuError::NoAdapter { wanted, available })
            }
        }
    }

    /// Opens a device with all limits of the adapter, and checks the adapter's arithmetic.
    pub(crate) fn start(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        blocking(Self::started(adapter))
    }

    async fn started(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let summary = AdapterSummary::new(&adapter.get_info());
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("gpu-smooth device"),
            required_features: adapter.features() & Self::optional_features(),
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let none = |message| GpuError::NoDevice { adapter: summary.name.clone(), message };
        let requested = caught(|| adapter.request_device(&descriptor)).map_err(none)?;
        // wgpu's message ends with a period, but the sentence around it goes on.
        let said = |error: wgpu::RequestDeviceError| error.to_string().trim_end_matches('.').into();
        let (device, queue) = requested.await.map_err(|error| none(said(error)))?;
        let gpu = Self::with(WatchedDevice::of_library(device), queue, summary)?;
        // A browser polls its devices. On other targets only this library has the device, and polls it.
        let browser = cfg!(target_arch = "wasm32");
        let waiting = if browser { Waiting::Await } else { Waiting::Block };
        if let Err(error) = gpu.arithmetic_checked(waiting).await {
            gpu.discard();
            return Err(error);
        }
        Ok(gpu)
    }
}

/// Opens and checks all adapters of this machine. Returns them in order of preference, each with the error if the
/// adapter cannot be used. [`adapters`](crate::gpu::adapters) lists the adapters without opening any.
pub fn checked_adapters() -> Vec<(AdapterSummary, Result<(), GpuError>)> {
    let checked = |adapter: &wgpu::Adapter| {
        (AdapterSummary::new(&adapter.get_info()), Gpu::start(adapter).map(|_| ()))
    };
    ranked_adapters().iter().map(checked).collect()
}

/// Opens candidates in order until one does not fail the check of its arithmetic, and returns its result: a device, or
/// any other error. If every candidate fails the check, returns the error of the first candidate. `None` without
/// candidates.
async fn first_that_passes<A, G, F: Future<Output = Result<G, GpuError>>>(
    candidates: impl Iterator<Item = A>,
    open: impl Fn(A) -> F,
) -> Option<Result<G, GpuError>> {
    let mut failed = None;
    for candidate in candidates {
        match open(candidate).await {
            Err(error @ GpuError::Arithmetic { .. }) => failed = failed.or(Some(Err(error))),
            opened => return Some(opened),
        }
    }
    failed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drops_digits(adapter: &str) -> GpuError {
        GpuError::Arithmetic { adapter: adapter.to_owned(), operation: "digits are lost" }
    }

    #[test]
    fn an_adapter_that_drops_digits_is_passed_over() {
        let open = async |name: &'static str| match name {
            "fast" | "faster" => Err(drops_digits(name)),
            "gone" => Err(GpuError::Lost("gone".into())),
            name => Ok(name),
        };
        let first = |names: &[&'static str]| {
            pollster::block_on(first_that_passes(names.iter().copied(), open))
        };
        assert_eq!(first(&["fast", "right", "other"]).unwrap().unwrap(), "right");
        let error = first(&["fast", "faster"]).unwrap().unwrap_err();
        assert!(matches!(&error, GpuError::Arithmetic { adapter, .. } if adapter == "fast"));
        // Any other error is returned at once.
        assert!(matches!(first(&["gone", "right"]), Some(Err(GpuError::Lost(_)))));
        assert!(first(&[]).is_none());
    }

    #[test]
    fn the_adapter_that_is_opened_is_the_first_that_passes() {
        let checked = checked_adapters();
        let (first, _) = checked.iter().find(|(_, usable)| usable.is_ok()).unwrap();
        assert_eq!(Gpu::open(None).block().unwrap().adapter(), first);
    }
}
