// The two stages in which long lists of partial sums are added up. In the first stage, a workgroup adds up each span of MOST_SUMMED
// partial sums, and in the second, one workgroup adds up the sums of the spans. `span_count` of src/gpu/device/size.rs agrees.

// Returns the number of spans; 0 if one workgroup adds up all partial sums in one stage.
fn span_count(partials: u32) -> u32 {
    return select(0u, (partials + MOST_SUMMED - 1u) / MOST_SUMMED, partials > MOST_SUMMED);
}
