// For the line search along a correction that an application encodes: a fixed number of trials, judged on the device.
// The bindings are `Search` in src/gpu/kernels/layouts.rs.

// The length from which the search for the first correction starts.
const USUAL_LENGTH: f32 = 1.0;
