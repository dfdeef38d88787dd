// out = right_factor right + product_factor M x: a residual, or the transfer between two coarse levels.

@compute @workgroup_size(WORKGROUP)
fn matrix_vector(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows || rests() {
        return;
    }
    var sum = op.product_factor * row_times_x(row);
    if op.right != NONE {
        sum += op.right_factor * vectors[op.right + row];
    }
    vectors[op.out + row] = sum;
}
