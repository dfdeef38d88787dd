// Ends an iteration of conjugate gradients: adds α times the direction to the solution and subtracts α times the product from
// the residual, aggregate by aggregate. The sums of the residual over the aggregates are the right-hand side of the first level,
// whose first step of Chebyshev's method from zero is computed too.

@compute @workgroup_size(WORKGROUP)
fn advance(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    let alpha = state.alpha;
    if row >= op.rows || (state.is_solved != 0u && alpha == 0.0) {
        return;
    }
    var sum = vec4(0.0);
    let end = structure[op.member_starts + row + 1u];
    for (var i = structure[op.member_starts + row]; i < end; i++) {
        let v = structure[op.members + i];
        fine[solution_at(v)] += alpha * fine[direction_at(v)];
        let left = fine[v] - alpha * fine[product_at(v)];
        fine[v] = left;
        let place = fine[place_at(v)];
        sum += vec4(
            left,
            place.x * left.x + place.y * left.y,
            place.x * left.y - place.y * left.x,
        );
    }
    rows[op.right + row] = sum;
    rows[op.step + row] = FIRST_STEP * (block_at(op.inverses, row) * sum);
}
