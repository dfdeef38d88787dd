// Restricts the negative gradient to the first coarse level: the sum over the members of each aggregate.

@compute @workgroup_size(WORKGROUP)
fn restrict_gradient(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows || rests() {
        return;
    }
    var sum = vec2(0.0);
    let end = structure[op.member_starts + row + 1u];
    for (var i = structure[op.member_starts + row]; i < end; i++) {
        sum -= direction[structure[op.members + i]];
    }
    vectors[op.right + row] = sum;
}
