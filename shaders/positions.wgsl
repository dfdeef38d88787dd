// Position of each vertex as a pair of floats: xy + zw, |zw| at most half a unit in the last place of xy.

fn position(vertex: u32) -> vec4<f32> {
    return positions[vertex];
}

fn set_position(vertex: u32, at: vec4<f32>) {
    positions[vertex] = at;
}
