// Adds up the partial sums of objective_along_correction.wgsl to four totals. If the list is long, the first of two dispatches has a
// workgroup for each span of MOST_SUMMED partial sums, and the second adds up the sums of the spans in one workgroup.

fn partial_sum(k: u32) -> vec2<f32> {
    return vectors[k];
}

@compute @workgroup_size(FINISH_WORKGROUP)
fn sum_along_correction(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let start = group.x * MOST_SUMMED;
    let count = select(min(op.rows - start, MOST_SUMMED), 0u, rests());
    for (var i = 0u; i < 4u; i++) {
        let first = op.partial_sums + i * op.rows + start;
        let sum = sum_of(local, first, first + count);
        if local == 0u {
            vectors[op.totals + i * groups.x + group.x] = sum;
        }
    }
}
