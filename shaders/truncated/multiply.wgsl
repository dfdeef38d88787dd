// Multiplies the direction by the Hessian. Each invocation strides over the vertices and writes a partial sum of the inner
// product of both. As the blocks of a row have the sum zero, a row is the sum of the blocks times differences.

@compute @workgroup_size(WORKGROUP)
fn multiply(@builtin(global_invocation_id) id: vec3<u32>) {
    if state.is_solved != 0u {
        return;
    }
    var sum = vec2(0.0);
    for (var v = id.x; v < op.vertices; v += op.partials) {
        let own = fine[direction_at(v)];
        var product = vec2(0.0);
        let end = ring_place(ring_start[v + 1u]);
        for (var i = ring_place(ring_start[v]); i < end; i++) {
#if QUADRILATERALS
            let k = ring[i] & ~OPPOSITE;
#else
            let k = ring[i];
#endif
            // Fixed vertices do not move.
            let other = select(vec2(0.0), fine[direction_at(min(k, op.movers - 1u))], k < op.movers);
            let block = entries[i];
            let apart = other - own;
            product += block.xy * apart.x + block.zw * apart.y;
        }
        fine[product_at(v)] = product;
        sum = pair_accumulate(sum, dot(own, product));
    }
    fine[sum_at(id.x)] = sum;
}
