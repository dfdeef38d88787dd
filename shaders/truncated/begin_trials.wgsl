// Begins the trials of a step, or continues them, if conjugate gradients have ended and no length is accepted. Otherwise the
// trials and the movement do nothing. search/places.wgsl has the indices of the state of the trials.

@compute @workgroup_size(1)
fn begin_trials() {
    let rest = state.is_solved == 0u || state.is_searched != 0u;
    vectors[LENGTHS] = vec2(select(state.next_length, 0.0, rest), 0.0);
    vectors[PROGRESS] = vec2(select(0.0, 1.0, rest), 0.0);
}
