// Constants of a run, for every kernel but those that exchange positions with an application.
//
// Constants in CAPITALS that are declared in no shader are put in front by src/gpu/kernels/source.rs.

struct Params {
    // Always zero, which the compiler cannot know; see `opaque` in pairs.wgsl.
    zero: u32,
    triangles: u32,
    // Invocations of the objective kernel.
    partials: u32,
    inner: u32,
    // The rest but mean_area is for finish.wgsl, which ends a run. Sums are of q² - ideal² over all triangles.
    base: u32,
    window: u32,
    max_sweeps: u32,
    has_target: u32,
    target_sum: vec2<f32>,
    ideal_sum: f32,
    tolerance: f32,
    // A pair: the mean area rounded to single precision, and what that left out.
    mean_area: vec2<f32>,
    // Where target maps begin in the positions.
    targets: u32,
}

@group(0) @binding(0) var<uniform> params: Params;

fn runtime_zero() -> u32 {
    return params.zero;
}
