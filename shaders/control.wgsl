// The state of a run. Written by finish.wgsl, and by judged/reopen.wgsl where an application encodes the sweeps.

struct Control {
    // Not zero when the run has ended: every kernel then leaves everything as it is.
    done: u32,
    // Number of evaluations of the objective: one before the first sweep and one after each.
    evaluated: u32,
    // Whether the last evaluation was the best so far.
    improved: u32,
    best_sweep: u32,
    best_sum: vec2<f32>,
    // Number of changes that the application had made to the mesh when this run began.
    changes: u32,
    padding: u32,
    // One entry for each evaluation (modulo HISTORY) and slot. The slot of a metric holds its sum as a pair of floats.
    // The slot INVERTED holds the number of triangles that are inverted or flat in single precision, also as a pair.
    // The slot WORST holds the largest imr² - 1 in x, and in y, as bits, the number of that triangle plus LEAST_NORMAL.
    history: array<vec2<f32>, HISTORY_LENGTH>,
}
