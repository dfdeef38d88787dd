//! Error scopes, which turn what wgpu reports of a call into an error.

use crate::error::GpuError;

/// Runs wgpu calls. A browser answers what it reports of them later, and a page cannot wait for that: there it goes to the
/// device's handler of uncaptured errors.
#[cfg(target_arch = "wasm32")]
pub(crate) fn scoped<T>(_: &wgpu::Device, calls: impl FnOnce() -> T) -> Result<T, GpuError> {
    Ok(calls())
}

/// Runs wgpu calls and turns whatever wgpu reports of them into an error.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn scoped<T>(device: &wgpu::Device, calls: impl FnOnce() -> T) -> Result<T, GpuError> {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let value = calls();
    let internal = pollster::block_on(internal.pop());
    let memory = pollster::block_on(memory.pop());
    let validation = pollster::block_on(validation.pop());
    if let Some(error) = memory {
        return Err(GpuError::OutOfMemory(error.to_string()));
    }
    match internal.or(validation) {
        // Of a lost device wgpu reports only the consequences: "... is invalid".
        Some(_) if is_lost(device) => Err(GpuError::Lost("it makes no buffers any more".into())),
        Some(error) => Err(GpuError::Refused(error.to_string())),
        None => Ok(value),
    }
}

/// As [`scoped`], for calls that take a buffer of the application: what is refused is then the buffer.
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

/// Whether the device is lost, found by trial: a lost device makes a buffer that cannot be mapped, and reports nothing
/// to the error scopes.
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
