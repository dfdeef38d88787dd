//! What the application's device has to be made with.

use super::device::{Gpu, GpuError};
use super::kernel::storage_bindings;
use super::layout::{FINISH_WORKGROUP, WORKGROUP};
use super::run::FOLD;
use super::shaders::Positions;
use super::size::MeshSize;

/// A limit, how much of it the kernels need, and what for.
type Row = (&'static str, fn(&mut wgpu::Limits) -> &mut u32, u32, &'static str);

macro_rules! row {
    ($limit:ident, $needed:expr, $what:expr) => {
        (stringify!($limit), |limits: &mut wgpu::Limits| &mut limits.$limit, $needed, $what)
    };
}

/// What the kernels need, on meshes bound like this. Tests make a device of exactly this.
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

/// Bytes of memory a workgroup shares.
const SHARED: u32 = FINISH_WORKGROUP * size_of::<[f32; 2]>() as u32;

/// Fails if the kernels cannot run with these limits.
pub(crate) fn check(available: &wgpu::Limits) -> Result<(), GpuError> {
    raise(&mut available.clone(), available, Positions::Whole)
}

/// Raises limits as far as the kernels need.
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

impl Gpu {
    /// The features a device needs: none beyond core WebGPU.
    pub fn required_features() -> wgpu::Features {
        wgpu::Features::empty()
    }

    /// The features this library makes use of where the device has them: `TIMESTAMP_QUERY`, for
    /// [`Timestamps`](super::Timestamps). An application that wants it asks for
    /// `adapter.features() & Gpu::optional_features()`.
    pub fn optional_features() -> wgpu::Features {
        wgpu::Features::TIMESTAMP_QUERY
    }

    /// The limits to make a device with, for an application that needs `own` for itself and has meshes of up
    /// to `size`: `own`, raised where the kernels or the meshes need more. Buffers larger than what the
    /// adapter binds at once are bound part by part: that takes its largest `max_storage_buffer_binding_size`.
    ///
    /// ```no_run
    /// # use gpu_smooth::{wgpu, Gpu, GpuError, MeshSize};
    /// # async fn f(adapter: wgpu::Adapter) -> Result<(), Box<dyn std::error::Error>> {
    /// let size = MeshSize { vertices: 100_000, triangles: 200_000 };
    /// let (device, queue) = adapter
    ///     .request_device(&wgpu::DeviceDescriptor {
    ///         required_features: Gpu::required_features(),
    ///         required_limits: Gpu::required_limits(
    ///             wgpu::Limits::default(),
    ///             size,
    ///             &adapter.limits(),
    ///         )?,
    ///         ..Default::default()
    ///     })
    ///     .await?;
    /// let gpu = Gpu::new(device, queue)?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// A vertex buffer with a stride above 16 bytes may need a larger `max_storage_buffer_binding_size` than the
    /// mesh.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if `available`, the adapter's limits, are too low for the kernels or the mesh; it
    /// names the limit. Of `own` nothing is checked: that the adapter does when it is asked for the device.
    pub fn required_limits(
        own: wgpu::Limits,
        size: MeshSize,
        available: &wgpu::Limits,
    ) -> Result<wgpu::Limits, GpuError> {
        size.check(available)?;
        let mut limits = own;
        let positions = Positions::of(size.vertices, available);
        raise(&mut limits, available, positions)?;
        let largest = size.largest(positions);
        let bound = &mut limits.max_storage_buffer_binding_size;
        *bound = largest.min(available.max_storage_buffer_binding_size).max(*bound);
        limits.max_buffer_size = largest.max(limits.max_buffer_size);
        Ok(limits)
    }

    /// Says whether meshes of this size fit the device, however their buffers are bound. Allocates nothing.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if not; it names the buffer and the limit.
    pub fn check_size(&self, size: MeshSize) -> Result<(), GpuError> {
        size.check(&self.device.limits())
    }
}
