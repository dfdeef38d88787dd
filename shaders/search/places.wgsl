// Places in `vectors`: the totals that sum_along_correction.wgsl leaves, and what the device knows of a line search of its own. A run
// leaves the latter zero, as the host searches for it.
const TOTALS: u32 = 0u;
// How far the next trial, or the movement at the end, goes along the correction; and the length that the next correction is tried
// with first, 0 before there is one.
const LENGTHS: u32 = 4u;
// The best length so far, and what it adds to the objective; zeros if there is none.
const BEST: u32 = 5u;
// Not zero if the rest of the correction is to leave everything as it is; and the number of trials.
const PROGRESS: u32 = 6u;

fn rests() -> bool {
    return vectors[PROGRESS].x != 0.0;
}
