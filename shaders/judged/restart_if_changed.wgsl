// Restarts the stop rule if the mesh or its pins have changed. The next evaluation then precedes the first sweep. A run
// in progress skips the evaluation, as the present state was evaluated after the last sweep.

@compute @workgroup_size(1)
fn restart_if_changed() {
    let count = changes[0] + changes[1];
    if control.changes != count {
        control.changes = count;
        control.evaluated = 0u;
        control.done = 0u;
    }
    if control.evaluated != 0u && control.done == 0u {
        control.done = PASSED;
    }
}
