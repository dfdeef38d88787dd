// Computes the preconditioned residual of the free vertices. Each invocation strides over the vertices and writes a partial sum
// of the inner product with the residual.

@compute @workgroup_size(WORKGROUP)
fn precondition(@builtin(global_invocation_id) id: vec3<u32>) {
    if state.is_solved != 0u {
        return;
    }
    var sum = vec2(0.0);
    for (var v = id.x; v < op.vertices; v += op.partials) {
        let made = preconditioned(v);
        fine[product_at(v)] = made;
        sum = pair_accumulate(sum, dot(fine[v], made));
    }
    fine[sum_at(id.x)] = sum;
}
