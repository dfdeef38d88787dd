// The state of a run, written by finish.wgsl, and by judged/reopen.wgsl where an application encodes the sweeps.

struct Control {
    // Not zero when the run has ended: every kernel then leaves everything as it is.
    done: u32,
    // How often the objective was evaluated: before the first sweep and after each.
    evaluated: u32,
    // Whether the last evaluation was the best so far.
    improved: u32,
    best_sweep: u32,
    best_sum: vec2<f32>,
    // How many changes of the mesh by the application there were when this run began.
    changes: u32,
    padding: u32,
    // Sums by evaluation (modulo HISTORY) and slot, each a pair of floats. A slot is a metric, or
    // INVERTED, the number of triangles that are inverted or flat in single precision, or
    // WORST, the largest imr² - 1, which is not a sum, and behind it the triangle: LEAST_NORMAL more than its number.
    history: array<vec2<f32>, HISTORY_LENGTH>,
}
