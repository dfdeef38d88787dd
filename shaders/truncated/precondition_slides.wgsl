// Computes the preconditioned residual of the sliding vertices, and adds their part to the partial sums of
// precondition.wgsl. Each invocation strides over the unknowns.

@compute @workgroup_size(WORKGROUP)
fn precondition_slides(@builtin(global_invocation_id) id: vec3<u32>) {
    if state.is_solved != 0u {
        return;
    }
    var sum = fine[sum_at(id.x)];
    for (var first = id.x; first < op.rows; first += op.partials) {
        if lines[first].is_first == 0u {
            continue;
        }
        var value = 0.0;
        for (var k = first; k != NONE; k = lines[k].next) {
            value += lines[k].share * dot(lines[k].along, preconditioned(lines[k].vertex));
        }
        sum = pair_accumulate(sum, value_in(0u, first) * value);
        set_value(product_at(0u), first, value);
    }
    fine[sum_at(id.x)] = sum;
}
