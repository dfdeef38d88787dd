// Writes the objectives of the last evaluation into a buffer of the application, laid out as the Rust struct
// ObjectiveValues.

struct Publish {
    // Where the values begin, in words from the start of the binding.
    offset: u32,
    triangles: u32,
    // Not zero if the sweeps are judged by the stop rule, and so have a reason to stop and a count of sweeps.
    judged: u32,
    padding: u32,
    // ideal² of each metric, which the sums leave out for each triangle; 0 for a metric that is not tracked.
    ideal_squared: array<vec4<f32>, SLOT_VECTORS>,
}

@group(0) @binding(0) var<uniform> publish_to: Publish;
@group(0) @binding(1) var<storage, read> control: Control;
// The control of the sweeps; `control` is that of the evaluation.
@group(0) @binding(2) var<storage, read> sweeps: Control;
// Two counters: of changes by kernels to the mesh, and of changes by the host to what may move.
@group(0) @binding(3) var<storage, read> changes: array<u32, 2>;
@group(0) @binding(4) var<storage, read_write> destination: array<u32>;

const INFINITY: u32 = 0x7f800000u;

@compute @workgroup_size(SLOTS)
fn publish(@builtin(local_invocation_index) slot: u32) {
    let last = ((control.evaluated - 1u) % HISTORY) * SLOTS;
    let sum = control.history[last + slot];
    var word = 0u;
    if slot == INVERTED {
        word = u32(sum.x) + u32(i32(sum.y));
    } else if slot == WORST {
        // Infinity is written by its bits, as compilers may assume that there are no infinities.
        let is_tangled = control.history[last + INVERTED].x > 0.0;
        word = select(bitcast<u32>(sqrt(1.0 + sum.x)), INFINITY, is_tangled);
    } else {
        let ideal = publish_to.ideal_squared[slot / 4u][slot % 4u];
        word = bitcast<u32>(ideal + (sum.x + sum.y) / f32(publish_to.triangles));
    }
    destination[publish_to.offset + slot] = word;
    if slot == 0u {
        // If the mesh has changed since, the next sweeps begin a new run, and the stop of the old one means nothing.
        let holds = publish_to.judged != 0u && sweeps.changes == changes[0] + changes[1];
        destination[publish_to.offset + SLOTS] = select(0u, sweeps.done, holds);
        let done = max(sweeps.evaluated, 1u) - 1u;
        destination[publish_to.offset + SLOTS + 1u] = select(0u, done, holds);
        let worst = bitcast<u32>(control.history[last + WORST].y);
        destination[publish_to.offset + SLOTS + 2u] = worst - LEAST_NORMAL;
    }
}
