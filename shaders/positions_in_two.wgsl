// Positions of a mesh that is too large for one binding: the first is full, and a second goes on where it ends.

@group(0) @binding(BEYOND) var<storage, read_write> positions_beyond: array<vec4<f32>>;

fn position(vertex: u32) -> vec4<f32> {
    let split = arrayLength(&positions);
    if vertex < split {
        return positions[vertex];
    }
    return positions_beyond[vertex - split];
}

fn set_position(vertex: u32, at: vec4<f32>) {
    let split = arrayLength(&positions);
    if vertex < split {
        positions[vertex] = at;
    } else {
        positions_beyond[vertex - split] = at;
    }
}
