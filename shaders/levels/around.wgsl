// The sum of the metric's derivatives over the triangles of a patch, in the patch's unit.

fn derivatives_around(p: Patch) -> Derivatives {
    var sum = Derivatives(0.0, vec2(0.0), vec3(0.0));
    var a = ring_edge(p, p.end - 1u);
    for (var i = p.start; i < p.end; i++) {
        let b = ring_edge(p, i);
        let map = map_around(p, i);
        let one = pulled_back(metric_derivatives(shown(Corner(a, b, p.mean_area), map), 0.0), map);
        sum.gradient += one.gradient;
        sum.hessian += one.hessian;
        a = b;
    }
    return sum;
}
