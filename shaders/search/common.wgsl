// Declarations of the line search along a correction that an application encodes: a fixed number of trials, judged on
// the device.

@group(0) @binding(1) var<storage, read> control: Control;
@group(0) @binding(2) var<storage, read_write> vectors: array<vec2<f32>>;

// The length from which the search for the first correction starts.
const USUAL_LENGTH: f32 = 1.0;
