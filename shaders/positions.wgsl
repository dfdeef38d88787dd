// Positions, all of them in one binding.

fn position(vertex: u32) -> vec4<f32> {
    return positions[vertex];
}

fn set_position(vertex: u32, at: vec4<f32>) {
    positions[vertex] = at;
}
