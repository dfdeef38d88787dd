// Solves the system of the coarsest level: multiplies its inverse, stored row by row, by the right-hand side.

@compute @workgroup_size(WORKGROUP)
fn coarsest_solve(@builtin(global_invocation_id) id: vec3<u32>) {
    let row = id.x;
    if row >= op.rows || rests() {
        return;
    }
    var sum = vec2(0.0);
    for (var k = 0u; k < op.rows; k++) {
        sum += values[op.entries + row * op.rows + k] * vectors[op.right + k];
    }
    vectors[op.out + row] = sum;
}
