// Combines partial values of an evaluation in one workgroup.

var<workgroup> totals: array<vec2<f32>, FINISH_WORKGROUP>;

// Combines a tracked value over two sets of triangles. All values except the last are added. The last value is the
// worst triangle's: the larger value wins and, among equal values, the lower triangle number.
fn joined(tracked: u32, a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    if tracked == TRACKED {
        let is_first = bitcast<u32>(a.y) < bitcast<u32>(b.y);
        return select(b, a, a.x > b.x || (a.x == b.x && is_first));
    }
    return pair_add(a, b);
}

// Returns a tracked value over the partial values from `first` on, before `end`. To be called by all invocations of a workgroup.
fn total_of(tracked: u32, local: u32, first: u32, end: u32) -> vec2<f32> {
    // The worst value starts at -1, below imr² - 1 of any triangle.
    var sum = select(vec2(0.0), vec2(-1.0, 0.0), tracked == TRACKED);
    // Four loads are under way at once. The order of the sum is that of a plain loop.
    var k = first + local;
    for (; k + 3u * FINISH_WORKGROUP < end; k += 4u * FINISH_WORKGROUP) {
        let a = partial_sums[k];
        let b = partial_sums[k + FINISH_WORKGROUP];
        let c = partial_sums[k + 2u * FINISH_WORKGROUP];
        let d = partial_sums[k + 3u * FINISH_WORKGROUP];
        let before = joined(tracked, joined(tracked, sum, a), b);
        sum = joined(tracked, joined(tracked, before, c), d);
    }
    for (; k < end; k += FINISH_WORKGROUP) {
        sum = joined(tracked, sum, partial_sums[k]);
    }
    totals[local] = sum;
    for (var half = FINISH_WORKGROUP / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local < half {
            totals[local] = joined(tracked, totals[local], totals[local + half]);
        }
    }
    workgroupBarrier();
    let total = totals[0];
    workgroupBarrier();
    return total;
}
