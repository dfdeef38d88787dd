// Begins the judged sweeps of an application anew where the mesh was changed. The evaluation that follows is that of the
// mesh before the first sweep; a run that goes on passes it over.

@compute @workgroup_size(1)
fn reopen() {
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
