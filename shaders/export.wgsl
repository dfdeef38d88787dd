// Writes the positions into an application's vertex buffer.

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
    let p = exported(position(vertex));
    vertex_buffer[at] = p.x;
    vertex_buffer[at + 1u] = p.y;
}
