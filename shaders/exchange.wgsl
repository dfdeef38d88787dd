// Positions between this library's buffer and a vertex buffer of the application.

struct Exchange {
    // A zero the compiler cannot know; see `opaque`.
    zero: u32,
    vertices: u32,
    // In floats, from the start of the binding.
    offset: u32,
    stride: u32,
    // The normalized position is (x - center) * scale, the center a pair of floats, xy + zw.
    center: vec4<f32>,
    scale: f32,
    inverse_scale: f32,
}

@group(0) @binding(0) var<uniform> exchange: Exchange;
@group(0) @binding(1) var<storage, read_write> positions: array<vec4<f32>>;
// The application's number of each vertex.
@group(0) @binding(2) var<storage, read> numbers: array<u32>;
@group(0) @binding(3) var<storage, read_write> vertex_buffer: array<f32>;

fn opaque(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ exchange.zero);
}

// In the application's unit and precision.
fn exported(p: vec4<f32>) -> vec2<f32> {
    let high = p.xy * exchange.inverse_scale;
    let low = p.zw * exchange.inverse_scale;
    return vec2(
        pair_add(vec2(exchange.center.x, exchange.center.z), vec2(high.x, low.x)).x,
        pair_add(vec2(exchange.center.y, exchange.center.w), vec2(high.y, low.y)).x,
    );
}

fn imported(x: f32, center: vec2<f32>) -> vec2<f32> {
    return pair_add(vec2(x, 0.0), -center) * exchange.scale;
}

// By its bits: compilers may take it that there are no other numbers.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

@compute @workgroup_size(WORKGROUP)
fn import_positions(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let vertex = invocation(id, groups);
    if vertex >= exchange.vertices {
        return;
    }
    let at = exchange.offset + numbers[vertex] * exchange.stride;
    let given = vec2(vertex_buffer[at], vertex_buffer[at + 1u]);
    // A vertex the application has not moved keeps the bits that its floats do not hold.
    if all(given == exported(positions[vertex])) {
        return;
    }
    let x = imported(given.x, vec2(exchange.center.x, exchange.center.z));
    let y = imported(given.y, vec2(exchange.center.y, exchange.center.w));
    // One vertex that is nowhere would take its neighbors along, and these theirs.
    if is_finite(x.x) && is_finite(y.x) {
        positions[vertex] = vec4(x.x, y.x, x.y, y.y);
    }
}

@compute @workgroup_size(WORKGROUP)
fn export_positions(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let vertex = invocation(id, groups);
    if vertex >= exchange.vertices {
        return;
    }
    let at = exchange.offset + numbers[vertex] * exchange.stride;
    let p = exported(positions[vertex]);
    vertex_buffer[at] = p.x;
    vertex_buffer[at + 1u] = p.y;
}
