//! Runs calls of wgpu and turns failures into errors, whether wgpu reports them to an error scope or panics.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::error::GpuError;
use crate::gpu::scope::watched::WatchedDevice;

/// Runs wgpu calls that may panic. wgpu panics if a driver reports a failure for which wgpu has no error: a device lost
/// during a wait, or memory that runs out while wgpu encodes. The work of the calls is dropped, so nothing half done
/// remains. The error is wgpu's message on one line. In a program built with `panic = "abort"`, a panic ends the
/// program.
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

/// Returns the error of wgpu calls that panicked: [`GpuError::Lost`] if the device is lost, [`GpuError::Refused`] if the
/// device still works.
fn failed(device: &wgpu::Device, text: String) -> GpuError {
    if is_lost(device) { GpuError::Lost(text) } else { GpuError::Refused(text) }
}

/// Returns [`GpuError::Lost`] if the device is lost, for calls whose wgpu calls succeed on a lost device. In a browser,
/// a loss is known after the browser has run the device's callback.
pub(crate) fn check_alive(device: &WatchedDevice) -> Result<(), GpuError> {
    #[cfg(target_arch = "wasm32")]
    return device.check();
    #[cfg(not(target_arch = "wasm32"))]
    match is_lost(device) {
        true => Err(GpuError::Lost("no buffer can be created".into())),
        false => Ok(()),
    }
}

/// Polls a device. Returns [`GpuError::Lost`] if the poll fails or wgpu panics on a lost device.
pub(crate) fn poll(
    device: &wgpu::Device,
    what: wgpu::PollType,
) -> Result<wgpu::PollStatus, GpuError> {
    let polled = caught(|| device.poll(what)).map_err(|text| failed(device, text))?;
    polled.map_err(|error| GpuError::Lost(error.to_string()))
}

/// Runs wgpu calls in error scopes. Returns [`GpuError::OutOfMemory`], [`GpuError::Lost`] if the device is lost, and
/// [`GpuError::Refused`] for any other error that wgpu reports or panics with.
///
/// A browser reports errors after the calls have returned. There this function returns `Ok`, and
/// [`WatchedDevice::check_async`] the errors.
pub(crate) fn scoped<T>(device: &WatchedDevice, calls: impl FnOnce() -> T) -> Result<T, GpuError> {
    scoped_as(device, calls, GpuError::Refused)
}

/// Runs wgpu calls like [`scoped`], for calls that take a buffer of the application: a refusal is reported as a fault
/// of the buffer.
pub(crate) fn scoped_to_buffer<T>(
    device: &WatchedDevice,
    calls: impl FnOnce() -> T,
) -> Result<T, GpuError> {
    scoped_as(device, calls, |text| {
        GpuError::Buffer(format!("the buffer was destroyed, or belongs to another device: {text}"))
    })
}

/// Runs wgpu calls in error scopes. `refusal` makes an error of the text of a refusal.
fn scoped_as<T>(
    device: &WatchedDevice,
    calls: impl FnOnce() -> T,
    refusal: fn(String) -> GpuError,
) -> Result<T, GpuError> {
    let (mut calls, mut value) = (Some(calls), None);
    run_scoped(device, &mut || value = calls.take().map(|calls| calls()), refusal)?;
    value.ok_or_else(|| refusal("the calls did not run".into()))
}

/// Does the work of [`scoped_as`]. Compiled once, whatever the calls return.
#[cfg(target_arch = "wasm32")]
fn run_scoped(
    device: &WatchedDevice,
    calls: &mut dyn FnMut(),
    refusal: fn(String) -> GpuError,
) -> Result<(), GpuError> {
    let ((), [memory, internal, validation]) = in_scopes(device, calls);
    device.reports().expect(async move {
        let (memory, internal, validation) = (memory.await, internal.await, validation.await);
        error_of(memory, internal.or(validation), refusal)
    });
    Ok(())
}

/// Does the work of [`scoped_as`]. Compiled once, whatever the calls return.
#[cfg(not(target_arch = "wasm32"))]
fn run_scoped(
    device: &WatchedDevice,
    calls: &mut dyn FnMut(),
    refusal: fn(String) -> GpuError,
) -> Result<(), GpuError> {
    let (done, reports) = in_scopes(device, || caught(calls));
    let [memory, internal, validation] = reports.map(pollster::block_on);
    match error_of(memory, internal.or(validation), refusal) {
        Some(error @ GpuError::OutOfMemory(_)) => Err(error),
        // For a lost device wgpu reports only the consequences: "... is invalid".
        Some(_) if is_lost(device) => Err(GpuError::Lost("no buffer can be created".into())),
        Some(error) => Err(error),
        None => done.map_err(|text| failed(device, text)),
    }
}

/// Runs wgpu calls in error scopes. Returns their result, and the errors that wgpu reports: a lack of memory, an internal
/// error, and a refusal.
fn in_scopes<T, C: FnOnce() -> T>(
    device: &wgpu::Device,
    calls: C,
) -> (T, [impl Future<Output = Option<wgpu::Error>> + 'static + use<T, C>; 3]) {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let value = calls();
    let internal = internal.pop();
    let memory = memory.pop();
    (value, [memory, internal, validation.pop()])
}

fn error_of(
    memory: Option<wgpu::Error>,
    other: Option<wgpu::Error>,
    refusal: fn(String) -> GpuError,
) -> Option<GpuError> {
    let memory = memory.map(|error| GpuError::OutOfMemory(error.to_string()));
    memory.or_else(|| other.map(|error| refusal(error.to_string())))
}

/// Browsers report a lost device to the device's callback alone, and a page cannot wait for the callback.
#[cfg(target_arch = "wasm32")]
fn is_lost(_: &wgpu::Device) -> bool {
    false
}

/// Returns whether the device is lost, by trying to create a mapped buffer. On a lost device the buffer cannot be
/// mapped, and no lack of memory is reported.
#[cfg(not(target_arch = "wasm32"))]
fn is_lost(device: &wgpu::Device) -> bool {
    // A panic of these calls means that the driver is gone.
    caught(|| cannot_map(device)).unwrap_or(true)
}

#[cfg(not(target_arch = "wasm32"))]
fn cannot_map(device: &wgpu::Device) -> bool {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("gpu-smooth trial"),
        size: wgpu::COPY_BUFFER_ALIGNMENT,
        // A buffer of another usage is mapped by a copy, which stays pending until the next submission.
        usage: wgpu::BufferUsages::MAP_WRITE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: true,
    });
    let is_mapped = buffer.get_mapped_range_mut(..).is_ok();
    let memory = pollster::block_on(memory.pop());
    let _ = pollster::block_on(validation.pop());
    !is_mapped && memory.is_none()
}
