// Lets a run in progress continue after the evaluation that restart_if_changed.wgsl made it skip.

@compute @workgroup_size(1)
fn resume() {
    if control.done == PASSED {
        control.done = 0u;
    }
}
