// Judges a trial of a step by the rule of StepSearch in src/run/truncated/search.rs: the search begins with the whole step and
// only shortens it. After the last trial of a submission, the movement goes the accepted length, or nowhere.

@compute @workgroup_size(1)
fn judge_length() {
    if rests() {
        return;
    }
    let length = vectors[LENGTHS].x;
    let here = vectors[TOTALS];
    let there = vectors[TOTALS + 1u];
    let change = pair_difference(there, here);
    let is_sound = vectors[TOTALS + 2u].x == 0.0 && is_finite(change);
    state.trials += 1u;
    state.here = here;
    let enough = -SUFFICIENT_DECREASE * length * state.descent;
    // Rounding hides the decrease of a step that gains next to nothing.
    let scale = max(here.x + params.ideal_sum, MIN_SCALE * f32(params.triangles));
    let is_hidden = state.descent * length <= HIDDEN * scale && change <= HIDDEN * scale;
    if is_sound && (change <= enough || is_hidden) && is_positive(state.descent) {
        state.is_searched = 1u;
        state.length = length;
        state.there = there;
        vectors[PROGRESS] = vec2(1.0, 0.0);
        return;
    }
    var next = 0.5 * length;
    if is_sound {
        let bend = change + state.descent * length;
        next = clamp(0.5 * state.descent * length * length / bend, 0.1 * length, 0.5 * length);
    } else {
        state.is_broken = 1u;
    }
    state.next_length = next;
    // The host places sliding vertices before each trial.
    let is_last = state.slides != 0u || state.trials % STEP_TRIALS == 0u;
    if state.trials == MOST_STEP_TRIALS || !is_positive(next) || !is_positive(state.descent) {
        state.is_searched = 1u;
        state.there = here;
        next = 0.0;
    }
    if is_last || next == 0.0 {
        vectors[LENGTHS] = vec2(0.0);
        vectors[PROGRESS] = vec2(1.0, 0.0);
        return;
    }
    vectors[LENGTHS] = vec2(next, 0.0);
}
