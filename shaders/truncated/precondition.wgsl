// Computes the preconditioned residual: by the inverses of the diagonal blocks, plus the motion of each vertex with its
// aggregate. Each invocation strides over the vertices and writes a partial sum of the inner product with the residual.

@compute @workgroup_size(WORKGROUP)
fn precondition(@builtin(global_invocation_id) id: vec3<u32>) {
    if state.is_solved != 0u {
        return;
    }
    var sum = vec2(0.0);
    for (var v = id.x; v < op.vertices; v += op.partials) {
        let left = fine[v];
        let above = fine[inverse_at(v)];
        let below = vec2(above.y, fine[inverse_at(v) + 1u].x);
        let motion = STIFFNESS * rows[op.solution + structure[op.aggregate_of + v]];
        let place = fine[place_at(v)];
        let turned = vec2(
            place.x * motion.z - place.y * motion.w,
            place.x * motion.w + place.y * motion.z,
        );
        let preconditioned = vec2(dot(above, left), dot(below, left)) + motion.xy + turned;
        fine[product_at(v)] = preconditioned;
        sum = pair_accumulate(sum, dot(left, preconditioned));
    }
    fine[sum_at(id.x)] = sum;
}
