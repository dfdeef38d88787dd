// Begins the line search of a correction, or skips the correction if the sweeps have ended by the stop rule.

@compute @workgroup_size(1)
fn begin_search() {
    let known = vectors[LENGTHS].y;
    let first = select(known, USUAL_LENGTH, known == 0.0);
    let ended = control.done != 0u;
    vectors[LENGTHS] = vec2(select(first, 0.0, ended), first);
    vectors[BEST] = vec2(0.0);
    vectors[PROGRESS] = vec2(select(0.0, 1.0, ended), 0.0);
}
