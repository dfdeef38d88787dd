// Constants of a run: what every kernel sees but those that exchange positions with an application.
//
// Constants in CAPITALS that are declared nowhere here are put in front by src/gpu/shaders.rs.

struct Params {
    // A zero the compiler cannot know; see `opaque`.
    zero: u32,
    triangles: u32,
    // Invocations of the objective kernel.
    partials: u32,
    inner: u32,
    // Stopping, see finish.wgsl. Sums are of q² - ideal² over all triangles.
    base: u32,
    window: u32,
    max_sweeps: u32,
    has_target: u32,
    target_sum: vec2<f32>,
    ideal_sum: f32,
    tolerance: f32,
    mean_area: f32,
}

@group(0) @binding(0) var<uniform> params: Params;

// Compilers may take (a + b) - a for b. They cannot see through this.
fn opaque(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ params.zero);
}
