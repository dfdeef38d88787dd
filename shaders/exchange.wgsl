// Declarations of the kernels that copy positions between this library's buffer and an application's vertex buffer.

struct Exchange {
    // Always zero, which the compiler cannot know; see `opaque` in pairs.wgsl.
    zero: u32,
    vertices: u32,
    // Floats before the first vertex, from the start of the binding.
    offset: u32,
    // Floats from one vertex to the next.
    stride: u32,
    // The normalized position is (x - center) * scale. The center is held in pairs of floats, xy + zw.
    center: vec4<f32>,
    scale: f32,
    inverse_scale: f32,
}

@group(0) @binding(0) var<uniform> exchange: Exchange;
// The application's number of each vertex.
@group(0) @binding(2) var<storage, read> numbers: array<u32>;
@group(0) @binding(3) var<storage, read_write> vertex_buffer: array<f32>;
// Two counters: of changes by kernels to the mesh, and of changes by the host to what may move.
@group(0) @binding(4) var<storage, read_write> changes: array<atomic<u32>, 2>;

fn runtime_zero() -> u32 {
    return exchange.zero;
}

// A position in the application's units, rounded to single precision.
fn exported(p: vec4<f32>) -> vec2<f32> {
    let high = p.xy * exchange.inverse_scale;
    let low = p.zw * exchange.inverse_scale;
    return vec2(
        pair_add(vec2(exchange.center.x, exchange.center.z), vec2(high.x, low.x)).x,
        pair_add(vec2(exchange.center.y, exchange.center.w), vec2(high.y, low.y)).x,
    );
}
