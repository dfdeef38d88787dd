// Prolongation from the first coarse level: each free vertex takes the solution x of its aggregate, smoothed once over
// the one-rings.

fn value_at(v: u32) -> vec2<f32> {
    let aggregate = structure[op.aggregate_of + v];
    if aggregate == NONE {
        return vec2(0.0);
    }
    return vectors[op.solution + aggregate];
}

fn carried(k: u32) -> vec2<f32> {
    return value_at(k) * root(k);
}

@compute @workgroup_size(WORKGROUP)
fn prolong_solution(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= op.rows || rests() {
        return;
    }
    let v = op.first + index;
    if (ring_start[v] & HELD) != 0u {
        direction[v] = vec2(0.0);
        return;
    }
    let share = SMOOTHING * values[op.diagonal + v] * root(v);
    direction[v] = fit(v) * (value_at(v) * (1.0 - SMOOTHING) + sum_over_neighbors(v) * share);
}
