// Holds sliding vertices by a mask of the application. A held vertex holds its partner.

fn is_masked(vertex: u32) -> bool {
    return vertex != NONE && mask[to_hold.offset + numbers[vertex]] != 0u;
}

@compute @workgroup_size(WORKGROUP)
fn hold_sliding_by_mask(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = id.x + id.y * groups.x * WORKGROUP;
    if index >= to_hold.vertices {
        return;
    }
    let vertices = sliding[index].vertices;
    let now = select(0u, 1u, is_masked(vertices.x) || is_masked(vertices.y));
    if now != sliding[index].masked {
        sliding[index].masked = now;
        atomicAdd(&changes[0], 1u);
    }
}
