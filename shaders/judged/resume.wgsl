// Lets judged sweeps go on that have passed over the evaluation after reopen.wgsl.

@compute @workgroup_size(1)
fn resume() {
    if control.done == PASSED {
        control.done = 0u;
    }
}
