//! Runs calls of wgpu and turns their failures into errors: those reported to error scopes, and those on which wgpu
//! panics.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::error::GpuError;

/// Runs wgpu calls that may panic. wgpu panics where a driver reports a failure for which it has no error: a device
/// that is lost while it is waited for, or memory that runs out during wgpu's own encoding. The work of the calls is
/// dropped, so nothing half done remains. The error is wgpu's message on one line.
pub(crate) fn caught<T>(calls: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(calls)).map_err(|payload| {
        let text = match (payload.downcast_ref::<String>(), payload.downcast_ref::<&str>()) {
            (Some(text), _) => text,
            (None, Some(text)) => *text,
            (None, None) => "wgpu has failed",
        };
        let text =
            text.strip_prefix("called `Result::unwrap()` on an `Err` value: ").unwrap_or(text);
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    })
}

/// Polls a device.
pub(crate) fn poll(
    device: &wgpu::Device,
    what: wgpu::PollType,
) -> Result<wgpu::PollStatus, GpuError> {
    let polled = caught(|| device.poll(what)).map_err(GpuError::Lost)?;
    polled.map_err(|error| GpuError::Lost(error.to_string()))
}

/// Runs wgpu calls. A browser reports their errors later, and a page cannot wait for that. So errors go to the device's
/// handler of uncaptured errors.
#[cfg(target_arch = "wasm32")]
pub(crate) fn scoped<T>(_: &wgpu::Device, calls: impl FnOnce() -> T) -> Result<T, GpuError> {
    Ok(calls())
}

/// Runs wgpu calls, and turns whatever wgpu reports into an error.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn scoped<T>(device: &wgpu::Device, calls: impl FnOnce() -> T) -> Result<T, GpuError> {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let value = caught(calls).map_err(GpuError::Lost);
    let internal = pollster::block_on(internal.pop());
    let memory = pollster::block_on(memory.pop());
    let validation = pollster::block_on(validation.pop());
    if let Some(error) = memory {
        return Err(GpuError::OutOfMemory(error.to_string()));
    }
    match internal.or(validation) {
        // For a lost device wgpu reports only the consequences: "... is invalid".
        Some(_) if is_lost(device) => Err(GpuError::Lost("no buffer can be created".into())),
        Some(error) => Err(GpuError::Refused(error.to_string())),
        None => value,
    }
}

/// Runs wgpu calls like [`scoped`], for calls that take a buffer of the application: a refusal is reported as a fault
/// of the buffer.
pub(crate) fn scoped_to_buffer<T>(
    device: &wgpu::Device,
    calls: impl FnOnce() -> T,
) -> Result<T, GpuError> {
    scoped(device, calls).map_err(|error| match error {
        GpuError::Refused(text) => {
            GpuError::Buffer(format!("it was destroyed, or is of another device: {text}"))
        }
        other => other,
    })
}

/// Whether the device is lost, found by a trial: on a lost device a new buffer cannot be mapped, and the error scopes
/// report nothing.
#[cfg(not(target_arch = "wasm32"))]
fn is_lost(device: &wgpu::Device) -> bool {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("gpu-smooth trial"),
        size: wgpu::COPY_BUFFER_ALIGNMENT,
        usage: wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: true,
    });
    let is_mapped = buffer.get_mapped_range_mut(..).is_ok();
    let memory = pollster::block_on(memory.pop());
    let _ = pollster::block_on(validation.pop());
    !is_mapped && memory.is_none()
}
