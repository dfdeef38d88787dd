// Adds up the partial sums of objective_along_correction.wgsl to four totals. If the list is long, the first of two dispatches has a
// workgroup for each span of MOST_SUMMED partial sums, and the second adds up the sums of the spans in one workgroup.

var<workgroup> totals: array<vec2<f32>, FINISH_WORKGROUP>;

@compute @workgroup_size(FINISH_WORKGROUP)
fn sum_along_correction(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let start = group.x * MOST_SUMMED;
    let count = select(min(op.rows - start, MOST_SUMMED), 0u, rests());
    for (var i = 0u; i < 4u; i++) {
        var sum = vec2(0.0);
        // Four loads are under way at once. The order of the sum is that of a plain loop.
        let first = op.partial_sums + i * op.rows + start;
        var k = local;
        for (; k + 3u * FINISH_WORKGROUP < count; k += 4u * FINISH_WORKGROUP) {
            let a = vectors[first + k];
            let b = vectors[first + k + FINISH_WORKGROUP];
            let c = vectors[first + k + 2u * FINISH_WORKGROUP];
            let d = vectors[first + k + 3u * FINISH_WORKGROUP];
            sum = pair_add(pair_add(pair_add(pair_add(sum, a), b), c), d);
        }
        for (; k < count; k += FINISH_WORKGROUP) {
            sum = pair_add(sum, vectors[first + k]);
        }
        totals[local] = sum;
        for (var half = FINISH_WORKGROUP / 2u; half > 0u; half /= 2u) {
            workgroupBarrier();
            if local < half {
                totals[local] = pair_add(totals[local], totals[local + half]);
            }
        }
        if local == 0u {
            vectors[op.totals + i * groups.x + group.x] = totals[0];
        }
        workgroupBarrier();
    }
}
