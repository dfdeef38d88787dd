// Computes the place of each aggregate in its coarser aggregate, and the ratio of both sizes.

@compute @workgroup_size(WORKGROUP)
fn find_shifts(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows {
        return;
    }
    let own = op.extents + 2u * row;
    let coarse = op.coarse_extents + 2u * structure[op.aggregate_of + row];
    let inverse = rows[coarse + 1u].y;
    let place = edge(rows[coarse], rows[own]) * inverse;
    rows[op.shifts + row] = vec4(place, rows[own + 1u].x * inverse, 0.0);
}
