// If there are secant pairs, completes the correction by them and restores the gradient. Then opens the next pair in
// the slot of the older pair.

@compute @workgroup_size(WORKGROUP)
fn begin_pair(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let v = invocation(id, groups);
    if v >= op.free {
        return;
    }
    var g = gradient[v];
    if op.pairs > 0u {
        g += bend(v);
        gradient[v] = g;
        let factors = sums[AFTER];
        direction[v] -= factors.x * steps[op.newer + v] + factors.y * older_step(v);
    }
    let at = position(v);
    steps[op.older + v] = at.xy;
    low_starts[v] = at.zw;
    changes[op.older + v] = -g;
}
