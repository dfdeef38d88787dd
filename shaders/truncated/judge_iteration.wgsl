// Judges an iteration of conjugate gradients: the step α, the gain of the model, the bound of its remaining gain by the rule of
// Gauss and Radau, and whether the solution is accurate enough. The rules are those of ErrorBound in
// src/run/truncated/bound.rs and of StepRequest in src/run/truncated/step.rs. Runs in one workgroup.

const INFINITE: f32 = 3.0e38;
const SMALLEST: f32 = 1.2e-38;

// Returns the diagonal entry of Lanczos's matrix.
fn diagonal_of(k: u32) -> f32 {
    let own = 1.0 / fine[coefficients_at(k)].x;
    if k == 0u {
        return own;
    }
    return own + fine[coefficients_at(k)].y / fine[coefficients_at(k - 1u)].x;
}

// Returns whether Lanczos's matrix of the first iterations has an eigenvalue below a number: whether a pivot is negative after
// a shift.
fn has_lower(count: u32, shift: f32) -> bool {
    var pivot = diagonal_of(0u) - shift;
    for (var k = 1u; k < count && pivot > 0.0; k++) {
        let before = fine[coefficients_at(k - 1u)].x;
        let square = fine[coefficients_at(k)].y / (before * before);
        pivot = diagonal_of(k) - shift - square / pivot;
    }
    return !(pivot > 0.0);
}

// Returns the smallest Ritz value after the first iterations, infinite without iterations.
fn ritz_of(count: u32) -> f32 {
    if count == 0u {
        return INFINITE;
    }
    var low = 0.0;
    var high = INFINITE;
    for (var k = 0u; k < count; k++) {
        high = min(high, diagonal_of(k));
    }
    for (var k = 0u; k < BISECTIONS; k++) {
        let middle = 0.5 * (low + high);
        if has_lower(count, middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}

// Returns γ of the last iteration with the given node; 0 if the node is not below the spectrum.
fn gamma_anew(count: u32, node: f32) -> f32 {
    var gamma = 1.0 / node;
    for (var k = 1u; k < count; k++) {
        let rest = gamma - fine[coefficients_at(k - 1u)].x;
        if rest <= 0.0 {
            return 0.0;
        }
        gamma = rest / (node * rest + fine[coefficients_at(k)].y);
    }
    return gamma;
}

// Records the last of `count` iterations in a bound, given by its node and γ. `ritz` is the smallest Ritz value.
fn with_iteration(bound: vec2<f32>, count: u32, ritz: f32) -> vec2<f32> {
    let last = fine[coefficients_at(count - 1u)];
    var made = bound;
    if count > 1u {
        let rest = made.y - fine[coefficients_at(count - 2u)].x;
        made.y = rest / (made.x * rest + last.y);
    }
    if BELOW * ritz < made.x {
        made.x = BELOW * ritz;
        made.y = gamma_anew(count, made.x);
    }
    // The node is above the smallest Ritz value.
    for (var k = 0u; k < 120u && !is_above(made.y, last.x); k++) {
        made.x *= 0.5;
        made.y = gamma_anew(count, made.x);
    }
    return made;
}

fn is_above(gamma: f32, alpha: f32) -> bool {
    return gamma > alpha && is_finite(gamma);
}

// Returns the largest amount by which further iterations can lower the model.
fn remaining(bound: vec2<f32>, alpha: f32) -> f32 {
    return select(INFINITE, 0.5 * state.rho * (bound.y - alpha), is_above(bound.y, alpha));
}

// Lowers the node further if the smallest Ritz value still falls from iteration to iteration.
fn refined(bound: vec2<f32>, count: u32, ritz: f32) -> vec2<f32> {
    var fall = FIRST_FALL;
    if count > FALLS_OVER {
        fall = min(ritz / ritz_of(count - FALLS_OVER), 1.0);
    }
    let square = fall * fall;
    let node = BELOW * ritz * square * square;
    if node < bound.x {
        return vec2(node, gamma_anew(count, node));
    }
    return bound;
}

fn judge(curvature: f32) {
    let rho = state.rho;
    if !is_positive(rho) || !is_positive(curvature) || !is_finite(rho / curvature) {
        state.is_curved_down = 1u;
        state.is_solved = 1u;
        state.alpha = 0.0;
        if state.iterations == 0u {
            // The whole direction is the solution.
            state.alpha = 1.0;
            state.descent = rho;
        }
        return;
    }
    let alpha = rho / curvature;
    let count = state.iterations + 1u;
    fine[coefficients_at(count - 1u)] = vec2(alpha, state.beta);
    let ritz = ritz_of(count);
    var bound = with_iteration(vec2(state.node, state.gamma), count, ritz);
    let rough = with_iteration(vec2(state.rough_node, state.rough_gamma), count, ritz);
    state.alpha = alpha;
    state.iterations = count;
    state.least_ritz = ritz;
    state.model_gain += 0.5 * alpha * rho;
    // The solution minimizes the model over the directions so far, so its gain is half of the descent.
    state.descent = 2.0 * state.model_gain;
    let wanted = state.forcing * state.model_gain;
    let slides = state.slides != 0u;
    var accuracy = select(state.least_gain, wanted, wanted > NEAR_LEAST * state.least_gain);
    if slides {
        accuracy = max(wanted, state.least_gain);
    }
    let is_last = slides || accuracy <= state.least_gain;
    // Only a solution that may end the run needs a safe bound.
    if is_last && remaining(bound, alpha) <= min(accuracy, 2.0 * state.least_gain) {
        bound = refined(bound, count, ritz);
    }
    let left = remaining(bound, alpha);
    state.node = bound.x;
    state.gamma = bound.y;
    state.rough_node = rough.x;
    state.rough_gamma = rough.y;
    state.bound = left;
    let is_accurate = accuracy >= select(remaining(rough, alpha), left, is_last);
    if is_accurate || count == MOST_ITERATIONS {
        state.is_solved = 1u;
    }
}

@compute @workgroup_size(FINISH_WORKGROUP)
fn judge_iteration(@builtin(local_invocation_index) local: u32) {
    let curvature = total(local);
    if local != 0u {
        return;
    }
    if state.is_solved != 0u {
        // The last iteration has ended.
        state.alpha = 0.0;
        return;
    }
    judge(curvature);
}
