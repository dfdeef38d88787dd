// Shared by the kernels of the line search along an application's encoded correction: a fixed number of trials, judged
// on the device. The bindings are `Search` in src/gpu/kernels/layouts.rs.

// First trial length along the first correction.
const USUAL_LENGTH: f32 = 1.0;
