// Writes the objectives of the last evaluation into a buffer of the application.

struct Publish {
    // In floats, from the start of the binding.
    offset: u32,
    triangles: u32,
    padding: vec2<u32>,
    // By slot: what the sums leave out, per triangle; 0 where nothing is summed. The last slot, INVERTED, is
    // a count.
    ideal_squared: array<vec4<f32>, 2>,
}

@group(0) @binding(0) var<uniform> publish_to: Publish;
@group(0) @binding(1) var<storage, read> control: Control;
@group(0) @binding(2) var<storage, read_write> destination: array<f32>;

@compute @workgroup_size(SLOTS)
fn publish(@builtin(local_invocation_index) slot: u32) {
    let last = (control.evaluated - 1u) % HISTORY;
    let sum = control.history[last * SLOTS + slot];
    var value = sum.x + sum.y;
    if slot != INVERTED {
        value = publish_to.ideal_squared[slot / 4u][slot % 4u] + value / f32(publish_to.triangles);
    }
    destination[publish_to.offset + slot] = value;
}
