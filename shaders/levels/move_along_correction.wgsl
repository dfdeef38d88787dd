// Moves each free vertex along the correction, multiplied by the step length.

@compute @workgroup_size(WORKGROUP)
fn move_along_correction(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let v = invocation(id, groups);
    // The direction of a refused trial may contain infinities, and the product of 0 and infinity is no number.
    if v >= op.rows || length_along() == 0.0 {
        return;
    }
    let d = move_of(v);
    if any(d != vec2(0.0)) {
        set_position(v, advanced(position(v), d));
    }
}
