// Sweeps that an application encodes, and that end by the stop rule.

@group(0) @binding(0) var<storage, read_write> control: Control;
// How often a vertex was moved, and how often the host changed what may move.
@group(0) @binding(1) var<storage, read> changes: array<u32, 2>;

// Ends the run if it has not: for the evaluation that follows, which is for runs that begin.
const PASSED: u32 = 0xffffffffu;
