// Returns the square root of the stiffness at a vertex. The stiffness is the mean absolute eigenvalue of the Hessian of
// the sum of q² with respect to the vertex, divided by the number of its neighbors.
fn root_of_stiffness(p: Patch, hessian: vec3<f32>) -> f32 {
    let mean = 0.5 * (hessian.x + hessian.z);
    let half = 0.5 * (hessian.x - hessian.z);
    // The eigenvalues are the mean plus and minus the radius.
    let radius = sqrt(half * half + hessian.y * hessian.y);
#if QUADRILATERALS
    return sqrt(max(abs(mean), radius) / counts_of(p).x) * p.unit;
#else
    return sqrt(max(abs(mean), radius) / f32(p.end - p.start)) * p.unit;
#endif
}

// Returns the sums of the metric's gradients and Hessians over the triangles of a patch, in the patch's unit. The value
// stays 0.

fn derivatives_around(p: Patch) -> Derivatives {
    var sum = Derivatives(0.0, vec2(0.0), vec3(0.0));
#if QUADRILATERALS
    for (var at = first_element(p); at.entry < p.end; at = next_element(p, at)) {
        for (var role = at.first_role; role <= at.last_role; role++) {
        let map = map_in(p, at.element, role);
        let t = transformed(metric_form(corner_in(p, at.element, role, vec2(0.0))), map);
        let one = pulled_back(metric_derivatives(t, 0.0), map);
#else
    var a = ring_edge(p, p.end - 1u);
    for (var i = p.start; i < p.end; i++) {
        let b = ring_edge(p, i);
        let map = map_around(p, i);
        let one = pulled_back(metric_derivatives(transformed(Corner(a, b, p.ideal), map), 0.0), map);
#endif
        sum.gradient += one.gradient;
        sum.hessian += one.hessian;
#if QUADRILATERALS
        }
#else
        a = b;
#endif
#if OPPOSITE_ANGLES
        if at.first_role == OWN {
            let joined = opposite_angle_derivatives(p, at.element);
            sum.gradient += joined.gradient;
            sum.hessian += joined.hessian;
        }
#endif
    }
    return sum;
}
