// Copies the free vertices' positions when they are the best so far by the base metric.

@compute @workgroup_size(WORKGROUP)
fn keep_best(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if control.improved != 0u && index < part.count {
        best_positions[index] = position(part.first + index);
    }
}
