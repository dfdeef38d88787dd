// Computes the center and size of each coarser aggregate from its members, in the rows that place_members.wgsl writes.

@compute @workgroup_size(WORKGROUP)
fn join_aggregates(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows {
        return;
    }
    let start = structure[op.member_starts + row];
    let end = structure[op.member_starts + row + 1u];
    let first = rows[op.extents + 2u * structure[op.members + start]];
    var count = 0.0;
    var sum = vec2(0.0);
    for (var i = start; i < end; i++) {
        let member = op.extents + 2u * structure[op.members + i];
        let weight = rows[member + 1u].z;
        count += weight;
        sum += weight * edge(first, rows[member]);
    }
    let center = advanced(first, sum / count);
    var square = 0.0;
    for (var i = start; i < end; i++) {
        let member = op.extents + 2u * structure[op.members + i];
        let away = edge(center, rows[member]);
        let size = rows[member + 1u].x;
        square += (dot(away, away) + size * size) * rows[member + 1u].z / count;
    }
    let size = sqrt(square);
    rows[op.coarse_extents + 2u * row] = center;
    rows[op.coarse_extents + 2u * row + 1u] = vec4(size, 1.0 / size, count, 0.0);
}
