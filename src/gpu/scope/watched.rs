//! A device with the failures that arrive outside of calls.

use std::fmt;
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::GpuError;
use crate::gpu::scope::counts::Counters;
#[cfg(target_arch = "wasm32")]
use crate::gpu::scope::reports::Reports;

/// A device with the failures that arrive outside of calls (its loss and, in a browser, the errors of earlier calls), and
/// with counters of the work that this library gives to it.
#[derive(Clone)]
pub(crate) struct WatchedDevice {
    raw: wgpu::Device,
    lost: Arc<Mutex<Option<String>>>,
    counters: Arc<Counters>,
    #[cfg(target_arch = "wasm32")]
    reports: Reports,
}

impl WatchedDevice {
    /// Wraps a device of an application, whose callbacks stay the application's. A browser allows several callbacks for
    /// the loss of a device, so there the loss is noted as well.
    pub(crate) fn of_application(raw: wgpu::Device) -> Self {
        let device = Self::new(raw);
        #[cfg(target_arch = "wasm32")]
        device.note_loss();
        device
    }

    /// Wraps a device that this library has opened, and sets the device's callbacks.
    pub(crate) fn of_library(raw: wgpu::Device) -> Self {
        let device = Self::new(raw);
        device.note_loss();
        // Every call is in an error scope. Without this handler, wgpu would panic on an error that still arrives.
        let lost = Arc::clone(&device.lost);
        device.raw.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            *lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.to_string());
        }));
        device
    }

    fn new(raw: wgpu::Device) -> Self {
        Self {
            raw,
            lost: Arc::default(),
            counters: Arc::default(),
            #[cfg(target_arch = "wasm32")]
            reports: Reports::default(),
        }
    }

    pub(crate) fn counters(&self) -> &Arc<Counters> {
        &self.counters
    }

    fn note_loss(&self) {
        let lost = Arc::clone(&self.lost);
        self.raw.set_device_lost_callback(move |reason, message| {
            let text = if message.is_empty() { format!("{reason:?}") } else { message };
            *lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(text);
        });
    }

    /// Returns [`GpuError::Lost`] if the device was lost or has reported an uncaptured error, as far as callbacks of
    /// this library are set; in a browser also the first error of earlier calls that has arrived. Never waits.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        if let Some(message) = &*self.lost.lock().unwrap_or_else(PoisonError::into_inner) {
            return Err(GpuError::Lost(message.clone()));
        }
        #[cfg(target_arch = "wasm32")]
        self.reports.arrived()?;
        Ok(())
    }

    /// Waits until a browser has reported the errors of all earlier calls, and checks the device. Elsewhere every call
    /// has returned its errors.
    pub(crate) async fn check_async(&self) -> Result<(), GpuError> {
        #[cfg(target_arch = "wasm32")]
        self.reports.all().await?;
        self.check()
    }

    #[cfg(target_arch = "wasm32")]
    pub(super) fn reports(&self) -> &Reports {
        &self.reports
    }
}

impl fmt::Debug for WatchedDevice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("WatchedDevice").field(&self.raw).finish()
    }
}

impl Deref for WatchedDevice {
    type Target = wgpu::Device;

    fn deref(&self) -> &wgpu::Device {
        &self.raw
    }
}
