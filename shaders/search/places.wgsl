// Indices in `vectors`: the four totals of sum_along_correction.wgsl, then the state of the line search on the device.
// If the host searches, the state stays zero.
const TOTALS: u32 = 0u;
// Two lengths along the correction: x of the next trial or the final movement, y of the first trial for the next
// correction (0 before the first correction).
const LENGTHS: u32 = 4u;
// x is the best length so far, y the change of the objective at this length; zeros before a successful trial.
const BEST: u32 = 5u;
// x is nonzero if the rest of the correction must do nothing; y counts the trials so far.
const PROGRESS: u32 = 6u;

// Returns whether the rest of the correction must do nothing.
fn rests() -> bool {
    return vectors[PROGRESS].x != 0.0;
}
