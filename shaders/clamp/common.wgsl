// Declarations of the kernels that move vertices toward an application's targets. Each vertex goes the same share of
// the way to its target.

struct Movement {
    // Always zero, which the compiler cannot know; see `opaque` in pairs.wgsl.
    zero: u32,
    vertices: u32,
    // Number of triangles that have at least one of the vertices to be moved.
    triangles: u32,
    worst_imr: f32,
    // Floats before the first target, from the start of the binding.
    offset: u32,
    // Floats from one target to the next.
    stride: u32,
    // Index of the word in `shares` that receives the share.
    share: u32,
    // The normalized target is (x - center) * scale. The center is held in pairs of floats, xy + zw.
    scale: f32,
    center: vec4<f32>,
}

@group(0) @binding(0) var<uniform> movement: Movement;
// Six numbers for each triangle: its three vertices, counter-clockwise, and for each of them the index in `ways`, or
// NONE where the vertex stays.
@group(0) @binding(2) var<storage, read> corners: array<u32>;
// For each way: the vertex that moves, and the number of its target.
@group(0) @binding(3) var<storage, read> ways: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> targets: array<f32>;
@group(0) @binding(5) var<storage, read_write> shares: array<f32>;
// Two counters: of changes by kernels to the mesh, and of changes by the host to what may move.
@group(0) @binding(6) var<storage, read_write> changes: array<atomic<u32>, 2>;

fn runtime_zero() -> u32 {
    return movement.zero;
}

fn normalized_target(x: f32, center: vec2<f32>) -> vec2<f32> {
    return pair_add(vec2(x, 0.0), -center) * movement.scale;
}

// Returns the end of a way. Where the target is not finite, the vertex stays where it is.
fn target_of(way: u32, from_: vec4<f32>) -> vec4<f32> {
    let at = movement.offset + ways[way].y * movement.stride;
    let x = normalized_target(targets[at], movement.center.xz);
    let y = normalized_target(targets[at + 1u], movement.center.yw);
    if is_finite(x.x) && is_finite(y.x) {
        return vec4(x.x, y.x, x.y, y.y);
    }
    return from_;
}

// Returns the position of a vertex after a share of its way. The product is opaque, so that all kernels compute the
// same bits.
fn gone(way: u32, from_: vec4<f32>, share: f32) -> vec4<f32> {
    let to = target_of(way, from_);
    if share >= 1.0 {
        return to;
    }
    return advanced(from_, opaque2(share * edge(from_, to)));
}
