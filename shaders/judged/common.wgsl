// For the kernels that let an application's encoded sweeps end by the stop rule. Their bindings are `Reopen` in
// src/gpu/kernels/layouts.rs.

// The value of `done` that makes a run in progress skip the next evaluation, which only runs that begin need.
const PASSED: u32 = 0xffffffffu;
