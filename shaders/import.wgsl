// Reads the positions from an application's vertex buffer.

fn imported(x: f32, center: vec2<f32>) -> vec2<f32> {
    return pair_times(pair_add(vec2(x, 0.0), -center), exchange.scale);
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
    // A vertex that the application has not moved keeps its position, which has more digits than the application's
    // floats.
    if all(given == exported(position(vertex))) {
        return;
    }
    let x = imported(given.x, vec2(exchange.center.x, exchange.center.z));
    let y = imported(given.y, vec2(exchange.center.y, exchange.center.w));
    // A position that is not finite would spread from neighbor to neighbor.
    if is_finite(x.x) && is_finite(y.x) {
        set_position(vertex, vec4(x.x, y.x, x.y, y.y));
        atomicAdd(&changes[0], 1u);
    }
}
