// Adds up the partial sums of four products over a span in each workgroup, before sum_secants.wgsl.

@compute @workgroup_size(FINISH_WORKGROUP)
fn add_up_secants(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let partials = op.partials;
    let first = group.x * MOST_SUMMED;
    let end = min(partials, first + MOST_SUMMED);
    for (var i = 0u; i < 4u; i++) {
        let sum = sum_of(local, i * partials + first, i * partials + end);
        if local == 0u {
            sums[PARTIAL + 4u * partials + i * span_count(partials) + group.x] = sum;
        }
    }
}
