//! Mirrors of the WGSL structs; tests hold their offsets against naga's.

use bytemuck::{Pod, Zeroable};

use crate::metric::Metric;

/// Evaluations the device remembers; the host reads them before they are overwritten.
pub(crate) const HISTORY: u32 = 256;
/// Invocations in a workgroup of every kernel but `finish`.
pub(crate) const WORKGROUP: u32 = 64;
/// Invocations of the `finish` kernel.
pub(crate) const FINISH_WORKGROUP: u32 = 256;

const METRICS: usize = Metric::ALL.len();

/// `Params` in shaders/common.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Params {
    pub(crate) zero: u32,
    pub(crate) triangles: u32,
    pub(crate) partials: u32,
    pub(crate) plain_sweeps: u32,
    pub(crate) inner: u32,
    pub(crate) sharpness_first: u32,
    pub(crate) sharpness_every: u32,
    pub(crate) sharpness_last: u32,
    pub(crate) base: u32,
    pub(crate) window: u32,
    pub(crate) max_sweeps: u32,
    pub(crate) has_target: u32,
    pub(crate) target_sum: [f32; 2],
    pub(crate) ideal_sum: f32,
    pub(crate) tolerance: f32,
    pub(crate) mean_area: f32,
    pub(crate) padding: [u32; 3],
    pub(crate) omega: [[f32; 4]; 2],
}

/// `Color` in shaders/common.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Color {
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// `Control` in shaders/common.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Control {
    pub(crate) done: u32,
    pub(crate) evaluated: u32,
    pub(crate) improved: u32,
    pub(crate) best_sweep: u32,
    pub(crate) best_sum: [f32; 2],
    pub(crate) padding: [u32; 2],
    pub(crate) history: [[[f32; 2]; METRICS]; HISTORY as usize],
}

/// A double as the sum of two floats.
pub(crate) fn pair(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

/// The double a pair of floats stands for.
pub(crate) fn unpair([high, low]: [f32; 2]) -> f64 {
    f64::from(high) + f64::from(low)
}
