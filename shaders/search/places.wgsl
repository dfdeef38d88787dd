// Indices in `vectors`: of the totals that sum_along_correction.wgsl leaves, and of the state of the line search on the
// device. Where the host searches, that state stays zero.
const TOTALS: u32 = 0u;
// Two lengths: how far the next trial, or the final movement, goes along the correction; and the first trial length for
// the next correction, 0 before the first correction.
const LENGTHS: u32 = 4u;
// The best length so far, and the change of the objective at it; zeros if there is none.
const BEST: u32 = 5u;
// Two values: not zero if the rest of the correction must do nothing; and the number of trials so far.
const PROGRESS: u32 = 6u;

fn rests() -> bool {
    return vectors[PROGRESS].x != 0.0;
}
