// The partial sums of products of secant pairs.

fn partial_sum(k: u32) -> vec2<f32> {
    return sums[PARTIAL + k];
}
