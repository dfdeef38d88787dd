// Solves the system of the coarsest level: multiplies its inverse, stored row by row, by the right-hand side.

@compute @workgroup_size(WORKGROUP)
fn coarsest_solve(@builtin(global_invocation_id) id: vec3<u32>) {
    let row = id.x;
    if row >= op.rows || rests() {
        return;
    }
    var sum = vec2(0.0);
    // Four entries are under way at once. The order of the sum is that of a plain loop.
    let first = op.entries + row * op.rows;
    var k = 0u;
    for (; k + 4u <= op.rows; k += 4u) {
        let at = first + k;
        let m = vec4(values[at], values[at + 1u], values[at + 2u], values[at + 3u]);
        let a = vectors[op.right + k];
        let b = vectors[op.right + k + 1u];
        let c = vectors[op.right + k + 2u];
        let d = vectors[op.right + k + 3u];
        sum += m.x * a;
        sum += m.y * b;
        sum += m.z * c;
        sum += m.w * d;
    }
    for (; k < op.rows; k++) {
        sum += values[first + k] * vectors[op.right + k];
    }
    vectors[op.out + row] = sum;
}
