// Adds up partial sums of products of secant pairs in one workgroup.

var<workgroup> totals: array<vec2<f32>, FINISH_WORKGROUP>;

// Returns the sum of the partial sums from `first` on, before `end`, the same for each invocation.
fn sum_of(local: u32, first: u32, end: u32) -> vec2<f32> {
    var sum = vec2(0.0);
    // Four loads are under way at once. The order of the sum is that of a plain loop.
    var k = first + local;
    for (; k + 3u * FINISH_WORKGROUP < end; k += 4u * FINISH_WORKGROUP) {
        let a = sums[PARTIAL + k];
        let b = sums[PARTIAL + k + FINISH_WORKGROUP];
        let c = sums[PARTIAL + k + 2u * FINISH_WORKGROUP];
        let d = sums[PARTIAL + k + 3u * FINISH_WORKGROUP];
        sum = pair_add(pair_add(pair_add(pair_add(sum, a), b), c), d);
    }
    for (; k < end; k += FINISH_WORKGROUP) {
        sum = pair_add(sum, sums[PARTIAL + k]);
    }
    totals[local] = sum;
    for (var half = FINISH_WORKGROUP / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local < half {
            totals[local] = pair_add(totals[local], totals[local + half]);
        }
    }
    workgroupBarrier();
    let whole = totals[0];
    workgroupBarrier();
    return whole;
}
