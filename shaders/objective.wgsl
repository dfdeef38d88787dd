// Computes partial sums over the triangles: q² - ideal² for each tracked metric, and the number of inverted triangles.
// The last value is the largest imr² - 1, with the number of the triangle. Each invocation strides over the triangles
// and writes a pair of floats for each value; finish.wgsl combines the pairs. If the triangles are bound in parts, each
// dispatch continues the sums of the previous part. No barriers are used, as barriers are slow on software adapters.

// Value of a triangle with an edge that is not finite. A metric may overlook such an edge, as maxima and minima ignore
// NaN.
const NOT_FINITE: f32 = 3.0e38;

// Returns the number of a triangle as the bits of a normal float. Drivers may change zeros, denormals, infinities and
// NaNs when they copy floats.
fn as_float(triangle: u32) -> f32 {
    return bitcast<f32>(triangle + MIN_NORMAL);
}

fn edge_is_finite(edge: vec2<f32>) -> bool {
    return is_finite(edge.x) && is_finite(edge.y);
}

@compute @workgroup_size(WORKGROUP)
fn objective(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    if control.done != 0u {
        return;
    }
    let stride = groups.x * WORKGROUP;
    var sums: array<vec2<f32>, TRACKED>;
    // The worst value starts at -1, below imr² - 1 of any triangle.
    var worst = vec2(-1.0, 0.0);
    if part.first != 0u {
        for (var i = 0u; i < TRACKED; i++) {
            sums[i] = partial_sums[i * stride + id.x];
        }
        worst = partial_sums[TRACKED * stride + id.x];
    }
    for (var t = id.x; t < part.count; t += stride) {
#if QUADRILATERALS
        for (var k = 0u; k < 4u; k++) {
        let places = own_corner(t, k);
        let corners = vec3(triangles[places.x], triangles[places.y], triangles[places.z]);
#else
        let corners = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
#endif
        let p = position(corners.x);
        let a = edge(p, position(corners.y));
        let b = edge(p, position(corners.z));
        let ideal = Ideal(params.mean_area, params.size_weight);
#if QUADRILATERALS
        let corner = transformed(metric_form(Corner(a, b, ideal)), map_of(corners));
#else
        let corner = transformed(Corner(a, b, ideal), map_of(corners));
#endif
#if OPPOSITE_ANGLES
        var values = tracked_values(corner);
        // Each pair of opposite corners has one share.
        if k < 2u {
            let across = opposite_corner(t, k);
            let around = vec3(triangles[across.x], triangles[across.y], triangles[across.z]);
            let o = position(around.x);
            let c = edge(o, position(around.y));
            let d = edge(o, position(around.z));
            let opposite = transformed(metric_form(Corner(c, d, ideal)), map_of(around));
            values = with_shares_of_opposite_angles(values, corner, opposite);
        }
#else
        let values = tracked_values(corner);
#endif
        let seen = edge_is_finite(a) && edge_is_finite(b);
        for (var i = 0u; i < TRACKED; i++) {
            // The last value counts inverted triangles, among which are those with edges that are not finite.
            let is_value = seen || i == TRACKED - 1u;
            sums[i] = pair_accumulate(sums[i], select(NOT_FINITE, values[i], is_value));
        }
        // An inverted triangle is the worst possible.
        let sound = seen && values[TRACKED - 1u] == 0.0;
        let excess = select(NOT_FINITE, shape_excess(corner), sound);
        if excess > worst.x {
            worst = vec2(excess, as_float(part.first + t));
        }
#if QUADRILATERALS
        }
#endif
    }
    for (var i = 0u; i < TRACKED; i++) {
        partial_sums[i * stride + id.x] = sums[i];
    }
    partial_sums[TRACKED * stride + id.x] = worst;
}
