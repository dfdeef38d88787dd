// Saves the positions of a mesh if it is valid, and restores the saved ones if it is not.

struct Restore {
    // Always zero, which the compiler cannot know; see `opaque` in pairs.wgsl.
    zero: u32,
    // The vertices of this dispatch; `valid_positions` is bound from the first of them on.
    first: u32,
    count: u32,
    padding: u32,
}

@group(0) @binding(0) var<uniform> restore: Restore;
@group(0) @binding(2) var<storage, read_write> valid_positions: array<vec4<f32>>;
// Holds the number of inverted triangles from an evaluation encoded just before.
@group(0) @binding(3) var<storage, read> control: Control;
// Two counters: of changes by kernels to the mesh, and of changes by the host to what may move.
@group(0) @binding(4) var<storage, read_write> changes: array<atomic<u32>, 2>;

fn runtime_zero() -> u32 {
    return restore.zero;
}

@compute @workgroup_size(WORKGROUP)
fn restore_last_valid(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= restore.count {
        return;
    }
    let vertex = restore.first + index;
    let last = ((control.evaluated - 1u) % HISTORY) * SLOTS;
    let now = position(vertex);
    if control.history[last + INVERTED].x <= 0.0 {
        valid_positions[index] = now;
        return;
    }
    let then = valid_positions[index];
    if any(then != now) {
        set_position(vertex, then);
        atomicAdd(&changes[0], 1u);
    }
}
