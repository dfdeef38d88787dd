// Bindings shared by every kernel, and arithmetic in pairs of floats.
//
// Constants in CAPITALS that are declared nowhere here are put in front by src/gpu/shaders.rs.

struct Params {
    // A zero the compiler cannot know; see `opaque`.
    zero: u32,
    triangles: u32,
    // Invocations of the objective kernel.
    partials: u32,
    plain_sweeps: u32,
    inner: u32,
    sharpness_first: u32,
    sharpness_every: u32,
    sharpness_last: u32,
    // Stopping, see finish.wgsl. Sums are of q² - ideal² over all triangles.
    base: u32,
    window: u32,
    max_sweeps: u32,
    has_target: u32,
    target_sum: vec2<f32>,
    ideal_sum: f32,
    tolerance: f32,
    mean_area: f32,
    // By metric.
    omega: array<vec4<f32>, 2>,
}

// The free vertices of one color.
struct Color {
    first: u32,
    count: u32,
}

struct Control {
    // Not zero when the run has ended: every kernel then leaves everything as it is.
    done: u32,
    // How often the objective was evaluated: before the first sweep and after each.
    evaluated: u32,
    // Whether the last evaluation was the best so far.
    improved: u32,
    best_sweep: u32,
    best_sum: vec2<f32>,
    padding: vec2<u32>,
    // Sums by evaluation (modulo HISTORY) and metric, each a pair of floats.
    history: array<vec2<f32>, HISTORY_LENGTH>,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<uniform> color: Color;
// Position of each vertex as a pair of floats: xy + zw, |zw| at most half a unit in the last place of xy.
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> ring_start: array<u32>;
@group(0) @binding(4) var<storage, read> ring: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>;
@group(0) @binding(6) var<storage, read_write> partial_sums: array<vec2<f32>>;
@group(0) @binding(7) var<storage, read_write> control: Control;
@group(0) @binding(8) var<storage, read_write> best_positions: array<vec4<f32>>;

// Compilers may take (a + b) - a for b. They cannot see through this.
fn opaque(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ params.zero);
}

// a + b exactly, as the rounded sum and what rounding lost (Knuth's two-sum).
fn two_sum(a: f32, b: f32) -> vec2<f32> {
    let s = opaque(a + b);
    let bb = opaque(s - a);
    return vec2(s, (a - opaque(s - bb)) + (b - bb));
}

fn pair_add(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let s = two_sum(a.x, b.x);
    return two_sum(s.x, s.y + (a.y + b.y));
}

fn pair_less(a: vec2<f32>, b: vec2<f32>) -> bool {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

// The number of an invocation in a dispatch folded to two dimensions.
fn invocation(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return id.x + id.y * groups.x * WORKGROUP;
}
