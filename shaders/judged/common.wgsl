// Shared by the kernels that let an application's encoded sweeps end by the stop rule. Their bindings are `RestartIfChanged` in
// src/gpu/kernels/layouts.rs.

// Value of `done` by which a run in progress skips the next evaluation, needed only at the start of a run.
const PASSED: u32 = 0xffffffffu;
