//! Checks and raises the limits of an application's device.

use crate::error::GpuError;
use crate::gpu::kernels::dispatch::FOLD;
use crate::gpu::kernels::form::Positions;
use crate::gpu::kernels::layouts::storage_bindings;
use crate::gpu::kernels::uniforms::{FINISH_WORKGROUP, WORKGROUP};
use crate::mesh::MeshSize;

/// One limit: its name, access to its field, the value that the kernels need, and the resource that needs it, for
/// errors.
type Row = (&'static str, fn(&mut wgpu::Limits) -> &mut u32, u32, &'static str);

macro_rules! row {
    ($limit:ident, $needed:expr, $what:expr) => {
        (stringify!($limit), |limits: &mut wgpu::Limits| &mut limits.$limit, $needed, $what)
    };
}

/// Returns the limits that kernels need if they bind the positions of a mesh as `positions`. Tests create a device with
/// exactly these limits.
fn rows(positions: Positions) -> [Row; 11] {
    let storage = storage_bindings(positions);
    let largest = FINISH_WORKGROUP.max(WORKGROUP);
    [
        row!(max_storage_buffers_per_shader_stage, storage, "the storage buffers of a kernel"),
        row!(max_uniform_buffers_per_shader_stage, 2, "the uniforms of a kernel"),
        row!(max_dynamic_uniform_buffers_per_pipeline_layout, 1, "the uniform of a color"),
        row!(max_bind_groups, 1, "the bind group of a kernel"),
        row!(max_bindings_per_bind_group, storage + 2, "the bindings of a kernel"),
        row!(max_compute_invocations_per_workgroup, largest, "a workgroup"),
        row!(max_compute_workgroup_size_x, largest, "a workgroup"),
        row!(max_compute_workgroup_size_y, 1, "a workgroup"),
        row!(max_compute_workgroup_size_z, 1, "a workgroup"),
        row!(max_compute_workgroups_per_dimension, FOLD, "a dispatch"),
        row!(max_compute_workgroup_storage_size, SHARED, "the memory of a workgroup"),
    ]
}

/// Memory that a workgroup shares, in bytes: a pair of floats for each invocation of the kernels that complete sums.
const SHARED: u32 = FINISH_WORKGROUP * size_of::<[f32; 2]>() as u32;

/// Returns [`GpuError::Limit`] if a limit is too low for kernels that bind positions whole.
pub(crate) fn check(available: &wgpu::Limits) -> Result<(), GpuError> {
    raise(&mut available.clone(), available, Positions::Whole)
}

/// Raises `limits` to the values that the kernels need. Returns [`GpuError::Limit`] if `available` has a lower value.
fn raise(
    limits: &mut wgpu::Limits,
    available: &wgpu::Limits,
    positions: Positions,
) -> Result<(), GpuError> {
    for (limit, of, needed, what) in rows(positions) {
        let available = *of(&mut available.clone());
        if needed > available {
            let (what, needed, available) = (what.into(), needed.into(), available.into());
            return Err(GpuError::Limit { what, needed, limit, available });
        }
        let raised = of(limits);
        *raised = needed.max(*raised);
    }
    Ok(())
}

/// Returns the limits to create a device with; see [`Gpu::required_limits`](super::Gpu::required_limits).
pub(crate) fn required(
    own: wgpu::Limits,
    size: MeshSize,
    available: &wgpu::Limits,
) -> Result<wgpu::Limits, GpuError> {
    size.check(available)?;
    let mut limits = own;
    let positions = Positions::of(size.vertices, available);
    raise(&mut limits, available, positions)?;
    // A mesh that just fits the device needs neither moves of all vertices nor Newton steps.
    let more = size.largest_of_move().max(size.largest_of_step()).min(available.max_buffer_size);
    let largest = size.largest(positions).max(more);
    let bound = &mut limits.max_storage_buffer_binding_size;
    *bound = largest.min(available.max_storage_buffer_binding_size).max(*bound);
    limits.max_buffer_size = largest.max(limits.max_buffer_size);
    Ok(limits)
}
