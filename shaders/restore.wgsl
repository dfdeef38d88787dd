// Saves the positions of a mesh without inverted or flat triangles, and otherwise restores the saved positions.

fn runtime_zero() -> u32 {
    return restore.zero;
}

@compute @workgroup_size(WORKGROUP)
fn restore_last_valid(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= restore.count {
        return;
    }
    let vertex = restore.first + index;
    let last = ((control.evaluated - 1u) % HISTORY) * SLOTS;
    let now = position(vertex);
    if control.history[last + INVERTED].x <= 0.0 {
        valid_positions[index] = now;
        return;
    }
    let then = valid_positions[index];
    // By their bits, as a comparison with NaN differs from driver to driver.
    if any(bitcast<vec4<u32>>(then) != bitcast<vec4<u32>>(now)) {
        set_position(vertex, then);
        atomicAdd(&changes[0], 1u);
    }
}
