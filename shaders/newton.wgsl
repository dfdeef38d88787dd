// Visits the free vertices of one color by local feasible Newton steps (Park & Shontz, Section 2.1), the same steps as
// in src/patch/newton_step.rs.

// Returns in x the sum of the metric's model over the patch with the vertex moved by d, and in y whether the position
// is feasible: 0 if a triangle is inverted, has an area that is not finite, or breaks the shape guard, else 1.
fn objective_at(p: Patch, d: vec2<f32>, limit: f32) -> vec2<f32> {
    var sum = 0.0;
#if QUADRILATERALS
    for (var at = first_element(p); at.entry < p.end; at = next_element(p, at)) {
        for (var role = at.first_role; role <= at.last_role; role++) {
        let now = corner_in(p, at.element, role, d);
        let t = transformed(metric_form(now), map_in(p, at.element, role));
#else
    var a = ring_edge(p, p.end - 1u) - d;
    for (var i = p.start; i < p.end; i++) {
        let b = ring_edge(p, i) - d;
        let t = transformed(Corner(a, b, p.ideal), map_around(p, i));
#endif
        if !is_positive(doubled_area(t)) {
            return vec2(0.0, 0.0);
        }
#if QUADRILATERALS
        let before = moved_back(now, d);
        if BOUNDED && !keeps_altitude(before.a, before.b, now.a, now.b, p.unit) {
#else
        if BOUNDED && !keeps_altitude(a + d, b + d, a, b, p.unit) {
#endif
            return vec2(0.0, 0.0);
        }
        if limit < NO_GUARD && inverse_mean_ratio(t) > limit {
            return vec2(0.0, 0.0);
        }
        sum += metric_model(t);
#if QUADRILATERALS
        }
#else
        a = b;
#endif
#if OPPOSITE_ANGLES
        if at.first_role == OWN {
            sum += opposite_angles(p, at.element, d);
        }
#endif
    }
    return vec2(sum, 1.0);
}

// Returns the factor on the length of the first trial, above 1 where nearly flat triangles dominate the patch's
// objective E. `decrease` is gᵀH⁻¹g, and `squares` is E. See src/patch/search_rule.rs.
fn lengthening(decrease: f32, squares: f32) -> f32 {
    let share = decrease / squares;
    if part.max_lengthening <= 1.0 || squares <= MIN_FLAT_SUM || !(share > FLAT_RATIO) {
        return 1.0;
    }
    return 1.0 / max(1.0 - FLAT_EXPONENT * share, 1.0 / part.max_lengthening);
}

// Returns a Newton step of a vertex after its line search, in the patch's unit; zero if no trial improves the patch.
fn newton_step(vertex: u32, p: Patch, omega: f32) -> vec2<f32> {
    var value = 0.0;
    var gradient = vec2(0.0);
    var hessian = vec3(0.0);
    var limit = part.shape_guard;
    let width = difference_width(p);
#if QUADRILATERALS
    for (var at = first_element(p); at.entry < p.end; at = next_element(p, at)) {
        for (var role = at.first_role; role <= at.last_role; role++) {
        let map = map_in(p, at.element, role);
        let t = transformed(metric_form(corner_in(p, at.element, role, vec2(0.0))), map);
#else
    var a = ring_edge(p, p.end - 1u);
    for (var i = p.start; i < p.end; i++) {
        let b = ring_edge(p, i);
        let map = map_around(p, i);
        let t = transformed(Corner(a, b, p.ideal), map);
#endif
        if part.shape_guard < NO_GUARD {
            limit = max(limit, inverse_mean_ratio(t));
        }
        let d = pulled_back(metric_derivatives(t, width), map);
        value += d.value;
        gradient += d.gradient;
        hessian += d.hessian;
#if QUADRILATERALS
        }
#else
        a = b;
#endif
#if OPPOSITE_ANGLES
        if at.first_role == OWN {
            let joined = opposite_angle_derivatives(p, at.element);
            value += joined.value;
            gradient += joined.gradient;
            hessian += joined.hessian;
        }
#endif
    }
    let inverse = inverse_of(p.own * p.map_unit);
    // The eigenvalue floor is meant for nearly equilateral triangles, so the floor is applied in the coordinates of the
    // vertex's map.
    let sum = pulled_back(Derivatives(value, gradient, hessian), inverse);
    var down = descent(sum.gradient, sum.hessian);
    if MAPPED {
        down = vec3(mapped(inverse, down.xy), down.z);
    }
    var disc: Disc;
    if BOUNDED {
        disc = disc_of(vertex, p.at, p.unit);
        down = turned(disc, down, Derivatives(value, gradient, hessian));
    }
    if down.z >= 0.0 {
        return vec2(0.0);
    }
#if QUADRILATERALS
    let squares = value + counts_of(p).y * IDEAL_SQUARED;
#else
    let squares = value + f32(p.end - p.start) * IDEAL_SQUARED;
#endif
    let slack = SLACK * squares;
    var length = omega * lengthening(-down.z, squares);
    for (var trial = 0u; trial < TRIALS; trial++) {
        var d = down.xy * length;
        var change = length * down.z;
        if BOUNDED {
            d = within(disc, d);
            change = dot(gradient, d);
        }
        let there = objective_at(p, d, limit);
        // A projected step need not lower a quadratic objective.
        let is_exact = QUADRATIC && !BOUNDED;
        if there.y == 0.0 {
            length *= SHORTEN_INFEASIBLE;
        } else if (!BOUNDED || change < 0.0)
            && (is_exact || there.x <= value + SUFFICIENT_DECREASE * change + slack) {
            return d;
        } else {
            length *= SHORTEN;
        }
    }
    return vec2(0.0);
}

@compute @workgroup_size(WORKGROUP)
fn sweep(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let index = invocation(id, groups);
    if index >= part.count || control.done != 0u {
        return;
    }
    let vertex = part.first + index;
    if (ring_start[vertex] & HELD) != 0u {
        return;
    }
    sharpness = part.sharpness;
    inverse_penalty_guard = part.inverse_penalty_guard;
    var p = patch_of(vertex);
    var moved = false;
    for (var i = 0u; i < params.newton_steps; i++) {
        let d = newton_step(vertex, p, part.omega);
        if all(d == vec2(0.0)) {
            break;
        }
        p.at = advanced(p.at, d / p.unit);
        moved = true;
        if length(d) < SETTLED {
            break;
        }
    }
    if moved {
        set_position(vertex, p.at);
    }
}
