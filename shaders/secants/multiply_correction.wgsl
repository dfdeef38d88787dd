// Computes the partial sums of the products of both gradient changes with the correction, as pairs of floats.

@compute @workgroup_size(WORKGROUP)
fn multiply_correction(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let stride = groups.x * WORKGROUP;
    var newer = vec2(0.0);
    var older = vec2(0.0);
    for (var v = id.x; v < op.free; v += stride) {
        newer = pair_accumulate(newer, dot(changes[op.newer + v], direction[v]));
        older = pair_accumulate(older, dot(older_change(v), direction[v]));
    }
    sums[PARTIAL + id.x] = newer;
    sums[PARTIAL + op.partials + id.x] = older;
}
