// Adds up partial sums, as `partial_sum` returns them, in one workgroup.

var<workgroup> totals: array<vec2<f32>, FINISH_WORKGROUP>;

// Returns the sum of the partial sums from `first` on, before `end`, the same for each invocation.
fn sum_of(local: u32, first: u32, end: u32) -> vec2<f32> {
    var sum = vec2(0.0);
    // Four loads are under way at once. The order of the sum is that of a plain loop.
    var k = first + local;
    for (; k + 3u * FINISH_WORKGROUP < end; k += 4u * FINISH_WORKGROUP) {
        let a = partial_sum(k);
        let b = partial_sum(k + FINISH_WORKGROUP);
        let c = partial_sum(k + 2u * FINISH_WORKGROUP);
        let d = partial_sum(k + 3u * FINISH_WORKGROUP);
        sum = pair_add(pair_add(pair_add(pair_add(sum, a), b), c), d);
    }
    for (; k < end; k += FINISH_WORKGROUP) {
        sum = pair_add(sum, partial_sum(k));
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
