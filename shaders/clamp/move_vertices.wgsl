// Moves vertices toward their targets by the share that find_share.wgsl has found.

@compute @workgroup_size(WORKGROUP)
fn move_vertices(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let way = invocation(id, groups);
    if way >= movement.vertices {
        return;
    }
    let share = shares[movement.share];
    if share > 0.0 {
        let vertex = ways[way].x;
        let from_ = position(vertex);
        let to = gone(way, from_, share);
        if any(to != from_) {
            set_position(vertex, to);
            atomicAdd(&changes[0], 1u);
        }
    }
}
