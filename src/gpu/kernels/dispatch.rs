//! Dispatches of more workgroups than one dimension takes.

use crate::gpu::kernels::uniforms::WORKGROUP;

/// Workgroups along x of a dispatch too long for one dimension.
pub(crate) const FOLD: u32 = 32768;

/// Dispatches enough workgroups for `invocations`, folded where one dimension is too short.
pub(crate) fn dispatch(pass: &mut wgpu::ComputePass<'_>, invocations: u32) {
    let groups = invocations.div_ceil(WORKGROUP);
    if groups <= FOLD {
        pass.dispatch_workgroups(groups, 1, 1);
    } else {
        pass.dispatch_workgroups(FOLD, groups.div_ceil(FOLD), 1);
    }
}
