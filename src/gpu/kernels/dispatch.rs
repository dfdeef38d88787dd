//! Dispatches of more workgroups than fit in one dimension.

use crate::gpu::kernels::uniforms::WORKGROUP;

/// Workgroups along x if a dispatch is too long for one dimension.
pub(crate) const FOLD: u32 = 32768;

/// Dispatches enough workgroups for `invocations`, in two dimensions if one is too short.
pub(crate) fn dispatch(pass: &mut wgpu::ComputePass<'_>, invocations: u32) {
    let groups = invocations.div_ceil(WORKGROUP);
    if groups <= FOLD {
        pass.dispatch_workgroups(groups, 1, 1);
    } else {
        pass.dispatch_workgroups(FOLD, groups.div_ceil(FOLD), 1);
    }
}
