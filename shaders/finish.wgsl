// Ends a sweep: adds up the partial sums or the sums of their spans, writes the history, and applies the stop rule of StopRule::judge in
// src/run/stop.rs. Runs in one workgroup.

// Returns the base metric's sum of q² - ideal² at an evaluation, as a pair of floats.
fn base_sum(evaluation: u32) -> vec2<f32> {
    return control.history[(evaluation % HISTORY) * SLOTS + params.base];
}

fn gain(earlier: u32, later: u32) -> f32 {
    return pair_difference(base_sum(earlier), base_sum(later));
}

// Estimates the remaining gain from the gains of two successive windows, for gains that decay geometrically. 3e38 if
// gains do not decay.
fn remaining(last: u32, window: u32) -> f32 {
    let before = gain(last - 2u * window, last - window);
    let now = gain(last - window, last);
    if now > 0.0 && now < before {
        return now * now / (before - now);
    }
    return 3.0e38;
}

fn judge(last: u32) -> u32 {
    let sum = base_sum(last);
    if params.has_goal != 0u && pair_less(sum, params.goal_sum) {
        return STOP_REACHED;
    }
    if last >= 2u * params.window && (params.has_goal != 0u || params.tolerance > 0.0) {
        let scale = max(sum.x + params.ideal_sum, MIN_SCALE * f32(params.triangles));
        let still = abs(gain(last - params.window, last)) <= NOISE * scale;
        if still || last - control.best_sweep >= 2u * params.window {
            let level = still || pair_difference(sum, control.best_sum) <= JITTER * scale;
            if level && params.has_goal == 0u {
                return STOP_CONVERGED;
            }
            return STOP_STALLED;
        }
        let left = max(remaining(last, params.window), remaining(last, params.window / 2u));
        if 2.0 * left <= params.tolerance * scale {
            return STOP_CONVERGED;
        }
    }
    if last >= params.max_sweeps {
        return STOP_MAX_SWEEPS;
    }
    return 0u;
}

@compute @workgroup_size(FINISH_WORKGROUP)
fn finish(@builtin(local_invocation_index) local: u32) {
    // No invocation returns before the loop: all must reach its barriers.
    let running = control.done == 0u;
    let evaluation = control.evaluated;
    let spans = span_count(params.partials);
    // The sums of the spans follow the partial sums.
    let count = select(params.partials, spans, spans > 0u);
    let start = select(0u, (TRACKED + 1u) * params.partials, spans > 0u);
    for (var i = 0u; i <= TRACKED; i++) {
        let first = start + i * count;
        let total = total_of(i, local, first, first + count);
        if local == 0u && running {
            control.history[(evaluation % HISTORY) * SLOTS + TRACKED_SLOTS[i]] = total;
        }
    }
    if local != 0u {
        return;
    }
    control.improved = 0u;
    if !running {
        return;
    }
    let sum = base_sum(evaluation);
    if evaluation == 0u || pair_less(sum, control.best_sum) {
        control.best_sum = sum;
        control.best_sweep = evaluation;
        control.improved = 1u;
    }
    control.done = judge(evaluation);
    control.evaluated = evaluation + 1u;
}
