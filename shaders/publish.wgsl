// Writes the objectives of the last evaluation into a buffer of the application, as the Rust struct
// ObjectiveValues has them.

struct Publish {
    // In words, from the start of the binding.
    offset: u32,
    triangles: u32,
    padding: vec2<u32>,
    // ideal² of each metric, which the sums leave out of each triangle; 0 for a metric that is not tracked.
    ideal_squared: array<vec4<f32>, SLOT_VECTORS>,
}

@group(0) @binding(0) var<uniform> publish_to: Publish;
@group(0) @binding(1) var<storage, read> control: Control;
@group(0) @binding(2) var<storage, read_write> destination: array<u32>;

const INFINITY: u32 = 0x7f800000u;

@compute @workgroup_size(SLOTS)
fn publish(@builtin(local_invocation_index) slot: u32) {
    let last = ((control.evaluated - 1u) % HISTORY) * SLOTS;
    let sum = control.history[last + slot];
    var word = 0u;
    if slot == INVERTED {
        word = u32(sum.x) + u32(i32(sum.y));
    } else if slot == WORST {
        // Infinity is written by its bits: compilers may assume that there is no such number.
        let is_tangled = control.history[last + INVERTED].x > 0.0;
        word = select(bitcast<u32>(sqrt(1.0 + sum.x)), INFINITY, is_tangled);
    } else {
        let ideal = publish_to.ideal_squared[slot / 4u][slot % 4u];
        word = bitcast<u32>(ideal + (sum.x + sum.y) / f32(publish_to.triangles));
    }
    destination[publish_to.offset + slot] = word;
}
