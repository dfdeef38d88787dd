// Copies the parameters of the sliding vertices if the base objective is the lowest so far.

@compute @workgroup_size(WORKGROUP)
fn keep_best_places(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if control.improved != 0u && index < arrayLength(&places) {
        best_places[index] = places[index];
    }
}
