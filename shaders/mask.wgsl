// Holds vertices by a mask of the application, in addition to the vertices that the host holds.

@compute @workgroup_size(WORKGROUP)
fn hold_by_mask(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let vertex = id.x + id.y * groups.x * WORKGROUP;
    if vertex >= to_hold.vertices {
        return;
    }
    let by_host = (pins[vertex / 32u] >> (vertex % 32u)) & 1u;
    let held = by_host != 0u || mask[to_hold.offset + numbers[vertex]] != 0u;
    let was = ring_start[vertex];
    let now = select(was & ~HELD, was | HELD, held);
    if now != was {
        ring_start[vertex] = now;
        atomicAdd(&changes[0], 1u);
    }
}
