// Holds vertices by a mask of the application, in addition to those that the host holds.

struct Mask {
    // Number of vertices that are free or held. Those behind them are on the boundary.
    vertices: u32,
    // Words before the first vertex, from the start of the binding.
    offset: u32,
    padding: vec2<u32>,
}

@group(0) @binding(0) var<uniform> to_hold: Mask;
@group(0) @binding(1) var<storage, read_write> ring_start: array<u32>; // HELD is set where the vertex must stay
// The application's number of each vertex.
@group(0) @binding(2) var<storage, read> numbers: array<u32>;
// One bit for each vertex, set where the host holds it.
@group(0) @binding(3) var<storage, read> pins: array<u32>;
@group(0) @binding(4) var<storage, read> mask: array<u32>;
// Two counters: of changes by kernels to the mesh, and of changes by the host to what may move.
@group(0) @binding(5) var<storage, read_write> changes: array<atomic<u32>, 2>;

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
