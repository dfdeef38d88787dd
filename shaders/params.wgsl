// Constants of a run, for all kernels except those that exchange positions with an application.
//
// Constants in CAPITALS that no shader declares are defined by src/gpu/kernels/source.rs, in front of the source.

struct Params {
    // Always zero, which the compiler cannot know; see `opaque` in pairs.wgsl.
    zero: u32,
    triangles: u32,
    // Number of invocations of the objective kernel.
    partials: u32,
    inner: u32,
    // The members from here to `tolerance` are for the stop rule in finish.wgsl. Sums are of q² - ideal² over all
    // triangles.
    base: u32,
    window: u32,
    max_sweeps: u32,
    has_target: u32,
    target_sum: vec2<f32>,
    ideal_sum: f32,
    tolerance: f32,
    // A pair of floats: the mean area rounded to single precision, and the rounding error.
    mean_area: vec2<f32>,
    // Index of the first target map in the positions.
    targets: u32,
}

@group(0) @binding(0) var<uniform> params: Params;

fn runtime_zero() -> u32 {
    return params.zero;
}
