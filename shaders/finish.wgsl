// Ends a sweep: adds up the partial sums, writes the history, and applies the stop rule of StopRule::judge in
// src/run/stop.rs. Runs in one workgroup.

var<workgroup> totals: array<vec2<f32>, FINISH_WORKGROUP>;

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
    if params.has_target != 0u && pair_less(sum, params.target_sum) {
        return STOP_REACHED;
    }
    if last >= 2u * params.window && (params.has_target != 0u || params.tolerance > 0.0) {
        let scale = max(sum.x + params.ideal_sum, MIN_SCALE * f32(params.triangles));
        let still = abs(gain(last - params.window, last)) <= NOISE * scale;
        if still || last - control.best_sweep >= 2u * params.window {
            let level = still || pair_difference(sum, control.best_sum) <= JITTER * scale;
            if level && params.has_target == 0u {
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

// Combines a tracked value over two sets of triangles. All values except the last are added. The last value is the
// worst triangle's: the larger value wins and, among equal values, the lower triangle number.
fn joined(tracked: u32, a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    if tracked == TRACKED {
        let is_first = bitcast<u32>(a.y) < bitcast<u32>(b.y);
        return select(b, a, a.x > b.x || (a.x == b.x && is_first));
    }
    return pair_add(a, b);
}

@compute @workgroup_size(FINISH_WORKGROUP)
fn finish(@builtin(local_invocation_index) local: u32) {
    // No invocation returns before the loop: all must reach its barriers.
    let running = control.done == 0u;
    let evaluation = control.evaluated;
    let partials = params.partials;
    for (var i = 0u; i <= TRACKED; i++) {
        // The worst value starts at -1, below imr² - 1 of any triangle.
        var sum = select(vec2(0.0), vec2(-1.0, 0.0), i == TRACKED);
        // Four loads are under way at once. The order of the sum is that of a plain loop.
        let first = i * partials;
        var k = local;
        for (; k + 3u * FINISH_WORKGROUP < partials; k += 4u * FINISH_WORKGROUP) {
            let a = partial_sums[first + k];
            let b = partial_sums[first + k + FINISH_WORKGROUP];
            let c = partial_sums[first + k + 2u * FINISH_WORKGROUP];
            let d = partial_sums[first + k + 3u * FINISH_WORKGROUP];
            sum = joined(i, joined(i, joined(i, joined(i, sum, a), b), c), d);
        }
        for (; k < partials; k += FINISH_WORKGROUP) {
            sum = joined(i, sum, partial_sums[first + k]);
        }
        totals[local] = sum;
        for (var half = FINISH_WORKGROUP / 2u; half > 0u; half /= 2u) {
            workgroupBarrier();
            if local < half {
                totals[local] = joined(i, totals[local], totals[local + half]);
            }
        }
        if local == 0u && running {
            control.history[(evaluation % HISTORY) * SLOTS + TRACKED_SLOTS[i]] = totals[0];
        }
        workgroupBarrier();
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
