// Completes the open secant pair, and computes the partial sums of its products as pairs of floats.

@compute @workgroup_size(WORKGROUP)
fn complete_pair(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let stride = groups.x * WORKGROUP;
    var sum: array<vec2<f32>, 4>;
    for (var v = id.x; v < op.free; v += stride) {
        let at = position(v);
        let g = gradient[v];
        var moved = edge(vec4(steps[op.newer + v], low_starts[v]), at);
        if MAPPED {
            moved = mapped(shape_of(v), moved);
        }
        let change = g + changes[op.newer + v];
        steps[op.newer + v] = moved;
        changes[op.newer + v] = change;
        let older = older_step(v);
        sum[0] = pair_accumulate(sum[0], dot(moved, g));
        sum[1] = pair_accumulate(sum[1], dot(moved, change));
        sum[2] = pair_accumulate(sum[2], dot(older, g));
        sum[3] = pair_accumulate(sum[3], dot(older, change));
    }
    for (var i = 0u; i < 4u; i++) {
        sums[PARTIAL + i * op.partials + id.x] = sum[i];
    }
}
