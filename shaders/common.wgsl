// What every kernel of a run sees.
//
// Constants in CAPITALS that are declared nowhere here are put in front by src/gpu/shaders.rs.

// Constants of a run.
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

// The free vertices of one color, and how one sweep steps.
struct SweepColor {
    first: u32,
    count: u32,
    omega: f32,
    sharpness: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<uniform> color: SweepColor;
// Position of each vertex as a pair of floats: xy + zw, |zw| at most half a unit in the last place of xy.
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> ring_start: array<u32>; // HELD is set where the vertex is to stay
@group(0) @binding(4) var<storage, read> ring: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>;
@group(0) @binding(6) var<storage, read_write> partial_sums: array<vec2<f32>>;
@group(0) @binding(7) var<storage, read_write> control: Control;
@group(0) @binding(8) var<storage, read_write> best_positions: array<vec4<f32>>;

// Compilers may take (a + b) - a for b. They cannot see through this.
fn opaque(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ params.zero);
}
