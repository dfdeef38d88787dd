// Computes the center and size of each aggregate of vertices, and the places of its vertices: (z - center) / size. The size is
// the root of the mean squared distance from the center, 1 for a single vertex. Two rows of `rows` hold an aggregate: the
// center as pairs of floats; then size, inverse size and number of vertices.

@compute @workgroup_size(WORKGROUP)
fn place_members(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows {
        return;
    }
    let start = structure[op.member_starts + row];
    let end = structure[op.member_starts + row + 1u];
    let first = position(structure[op.members + start]);
    let count = f32(end - start);
    var mean = vec2(0.0);
    for (var i = start; i < end; i++) {
        mean += edge(first, position(structure[op.members + i]));
    }
    let center = advanced(first, mean / count);
    var square = 0.0;
    for (var i = start; i < end; i++) {
        let away = edge(center, position(structure[op.members + i]));
        square += dot(away, away);
    }
    square /= count;
    let size = select(1.0, sqrt(square), end - start > 1u && square > 0.0);
    for (var i = start; i < end; i++) {
        let v = structure[op.members + i];
        fine[place_at(v)] = edge(center, position(v)) / size;
    }
    rows[op.extents + 2u * row] = center;
    rows[op.extents + 2u * row + 1u] = vec4(size, 1.0 / size, count, 0.0);
}
