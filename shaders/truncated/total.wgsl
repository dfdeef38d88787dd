// The partial sums of inner products.

fn partial_sum(k: u32) -> vec2<f32> {
    return fine[sum_at(k)];
}

// Returns the sum of all partial sums, or of the sums of their spans.
fn total(local: u32) -> f32 {
    let spans = span_count(op.partials);
    let first = select(0u, op.partials, spans > 0u);
    let sum = sum_of(local, first, first + select(op.partials, spans, spans > 0u));
    return sum.x + sum.y;
}
