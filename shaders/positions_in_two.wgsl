// Replaces positions.wgsl for a mesh that is too large for one binding: one binding holds the high parts of all
// vertices, a second binding the low parts. Half of the vertices in each binding would double the loads on adapters
// that execute both branches.

fn position(vertex: u32) -> vec4<f32> {
    return vec4(high_positions[vertex], low_positions[vertex]);
}

fn set_position(vertex: u32, at: vec4<f32>) {
    high_positions[vertex] = at.xy;
    low_positions[vertex] = at.zw;
}
