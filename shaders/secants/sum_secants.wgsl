// Adds up the partial sums, or the sums of their spans, in one workgroup, and computes from them the factors of the two-loop recursion, as
// src/run/secant.rs does.

// Returns the sum of all partial sums of a product, or of the sums of their spans.
fn total(local: u32, i: u32) -> f32 {
    let spans = span_count(op.partials);
    let start = select(0u, 4u * op.partials, spans > 0u);
    let count = select(op.partials, spans, spans > 0u);
    let sum = sum_of(local, start + i * count, start + (i + 1u) * count);
    return sum.x + sum.y;
}

// Returns a product divided by a curvature, or 0 if the pair is not used.
fn share(product: f32, curvature: f32) -> f32 {
    return select(0.0, product / curvature, curvature > 0.0);
}

// Computes the factors aᵢ from the products with the gradient.
fn find_before(along: vec2<f32>, curvature: f32, across: f32) {
    let slope_before = along.x - curvature;
    let counts = is_positive(curvature - MIN_CURVATURE * abs(slope_before));
    // The newer pair of the last correction is the older pair now.
    let older_curvature = select(0.0, sums[CURVATURES].x, op.pairs > 1u);
    let curvatures = vec2(select(0.0, curvature, counts), older_curvature);
    let newer = share(along.x, curvatures.x);
    let older = share(along.y - newer * across, curvatures.y);
    sums[CURVATURES] = curvatures;
    sums[BEFORE] = vec2(newer, older);
    sums[ACROSS] = vec2(across, 0.0);
}

// Computes the factors cᵢ from the products with the correction. The correction is minus the result of the levels,
// hence the signs.
fn find_after(products: vec2<f32>) {
    let curvatures = sums[CURVATURES];
    let before = sums[BEFORE];
    let older = select(0.0, before.y + products.y / curvatures.y, curvatures.y > 0.0);
    let product = older * sums[ACROSS].x - products.x;
    let newer = select(0.0, before.x - product / curvatures.x, curvatures.x > 0.0);
    sums[AFTER] = vec2(newer, older);
}

@compute @workgroup_size(FINISH_WORKGROUP)
fn sum_secants(@builtin(local_invocation_index) local: u32) {
    let newer = total(local, 0u);
    let second = total(local, 1u);
    // After the levels only two sums are computed, and the next two totals are not used.
    let older = total(local, 2u);
    let across = total(local, 3u);
    if local == 0u {
        if op.is_after == 0u {
            find_before(vec2(newer, older), second, across);
        } else {
            find_after(vec2(newer, second));
        }
    }
}
