// Sums what a smoothed prolongation hands down to each aggregate: minus the gradient x.

fn smoothed(v: u32) -> vec2<f32> {
    var around = vec2(0.0);
    let end = ring_place(ring_start[v + 1u]);
    for (var i = ring_place(ring_start[v]); i < end; i++) {
        let k = ring[i];
        if k < op.free {
            around += vectors[op.x + k] * (values[op.diagonal + k] * edge_weight(v, k));
        }
    }
    return vectors[op.x + v] * (1.0 - SMOOTHING) + around * SMOOTHING;
}

@compute @workgroup_size(WORKGROUP)
fn hand_down(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows {
        return;
    }
    var sum = vec2(0.0);
    let end = structure[op.starts + row + 1u];
    for (var i = structure[op.starts + row]; i < end; i++) {
        sum -= smoothed(structure[op.columns + i]);
    }
    vectors[op.out + row] = sum;
}
