// Returns the residual of a vertex, preconditioned: multiplied by the inverse of the diagonal block, plus the motion of the
// vertex with its aggregate.
fn preconditioned(v: u32) -> vec2<f32> {
    let left = fine[v];
    let above = fine[inverse_at(v)];
    let below = vec2(above.y, fine[inverse_at(v) + 1u].x);
    let motion = STIFFNESS * rows[op.solution + structure[op.aggregate_of + v]];
    let place = fine[place_at(v)];
    let turned = vec2(
        place.x * motion.z - place.y * motion.w,
        place.x * motion.w + place.y * motion.z,
    );
    return vec2(dot(above, left), dot(below, left)) + motion.xy + turned;
}
