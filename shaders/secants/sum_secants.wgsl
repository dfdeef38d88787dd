// Adds up the partial sums in one workgroup, and computes from them the factors of the two-loop recursion, as
// src/run/secant.rs does.

var<workgroup> totals: array<vec2<f32>, FINISH_WORKGROUP>;

fn total(local: u32, i: u32) -> f32 {
    var sum = vec2(0.0);
    for (var k = local; k < op.partials; k += FINISH_WORKGROUP) {
        sum = pair_add(sum, sums[PARTIAL + i * op.partials + k]);
    }
    totals[local] = sum;
    for (var half = FINISH_WORKGROUP / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local < half {
            totals[local] = pair_add(totals[local], totals[local + half]);
        }
    }
    workgroupBarrier();
    let whole = totals[0].x + totals[0].y;
    workgroupBarrier();
    return whole;
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
