// Value, gradient and Hessian of the active metric by forward differences of width h. Like Mesquite, it evaluates the
// value 16 times for each element (see DISPLACEMENTS in src/run/line_search.rs).

fn differences(t: Corner, h: f32) -> Derivatives {
    var displacements = DISPLACEMENTS;
    var values: array<f32, 16>;
    for (var i = 0u; i < 16u; i++) {
#if QUADRILATERALS
        let d = displacements[i] * h;
        let moved = Corner(t.a + edge_slopes.x * d, t.b + edge_slopes.y * d, t.ideal);
        values[i] = metric_model(moved);
#else
        values[i] = metric_model(displaced(t, displacements[i] * h));
#endif
    }
    let here = vec2(values[1] - values[0], values[2] - values[0]) / h;
    let right = vec2(values[5] - values[4], values[6] - values[4]) / h;
    let up = vec2(values[9] - values[8], values[10] - values[8]) / h;
    let mixed = 0.5 * ((right.y - here.y) + (up.x - here.x));
    return Derivatives(values[0], here, vec3(right.x - here.x, mixed, up.y - here.y) / h);
}
