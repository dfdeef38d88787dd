// Multiplies the direction by the Hessian at the sliding vertices, along their tangents, and adds their part to the partial sums
// of multiply.wgsl. Each invocation strides over the unknowns.

@compute @workgroup_size(WORKGROUP)
fn multiply_slides(@builtin(global_invocation_id) id: vec3<u32>) {
    if state.is_solved != 0u {
        return;
    }
    var sum = fine[sum_at(id.x)];
    for (var first = id.x; first < op.rows; first += op.partials) {
        let line = lines[first];
        if line.is_first == 0u {
            continue;
        }
        let value = value_in(direction_at(0u), first);
        // The squares of the shares add up to 1.
        var force = line.of_bounds * value;
        for (var k = first; k != NONE; k = lines[k].next) {
            let share = lines[k].share;
            let bent = lines[k].curvature * share * value;
            force += share * (dot(lines[k].along, product_of(lines[k].vertex)) + bent);
        }
        sum = pair_accumulate(sum, value * force);
        set_value(product_at(0u), first, force);
    }
    fine[sum_at(id.x)] = sum;
}

// Returns the row of a sliding vertex times the direction. The blocks of a row have the sum zero.
fn product_of(v: u32) -> vec2<f32> {
    let own = fine[direction_at(v)];
    let range = 2u * corners_of(v);
    var product = vec2(0.0);
    for (var k = range.x; k < range.y; k++) {
        let apart = fine[direction_at(corner_at(k))] - own;
        let block = entries[op.slide_entries + k];
        product += block.xy * apart.x + block.zw * apart.y;
    }
    return product;
}
