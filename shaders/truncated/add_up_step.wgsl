// Adds up the partial sums of an inner product over a span in each workgroup.

@compute @workgroup_size(FINISH_WORKGROUP)
fn add_up_step(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let first = group.x * MOST_SUMMED;
    let sum = sum_of(local, first, min(op.partials, first + MOST_SUMMED));
    if local == 0u {
        fine[sum_at(op.partials + group.x)] = sum;
    }
}
