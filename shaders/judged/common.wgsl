// Declarations of the kernels that let an application's encoded sweeps end by the stop rule.

@group(0) @binding(0) var<storage, read_write> control: Control;
// Two counters: of changes by kernels to the mesh, and of changes by the host to what may move.
@group(0) @binding(1) var<storage, read> changes: array<u32, 2>;

// The value of `done` that makes a run in progress skip the next evaluation, which only runs that begin need.
const PASSED: u32 = 0xffffffffu;
