// Adds up the partial sums of an evaluation over a span in each workgroup, before finish.wgsl.

@compute @workgroup_size(FINISH_WORKGROUP)
fn add_up_evaluation(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let partials = params.partials;
    let spans = span_count(partials);
    let first = group.x * MOST_SUMMED;
    let end = min(partials, first + MOST_SUMMED);
    for (var i = 0u; i <= TRACKED; i++) {
        let total = total_of(i, local, i * partials + first, i * partials + end);
        if local == 0u {
            partial_sums[(TRACKED + 1u) * partials + i * spans + group.x] = total;
        }
    }
}
