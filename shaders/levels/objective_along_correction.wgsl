// The objective here and at a times the correction, the number of triangles that are broken there,
// and the slope, from the gradient: each invocation leaves four partial sums as pairs of floats, which
// sum_along_correction.wgsl adds up. Further parts of the triangles add to what the ones before left.

fn moved(v: u32) -> vec2<f32> {
    if v >= op.free {
        return vec2(0.0);
    }
    return op.a * direction[v];
}

// Whether a triangle is inverted or flat, or breaks the shape guard and is worse than it was.
fn is_broken(here: Corner, there: Corner) -> bool {
    if !(doubled_area(there) > 0.0) {
        return true;
    }
    if !GUARDED {
        return false;
    }
    return inverse_mean_ratio(there) > max(op.shape_guard, inverse_mean_ratio(here));
}

fn added(sum: vec2<f32>, value: f32) -> vec2<f32> {
    let s = two_sum(sum.x, value);
    return vec2(s.x, sum.y + s.y);
}

@compute @workgroup_size(WORKGROUP)
fn objective_along_correction(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let stride = groups.x * WORKGROUP;
    var sums: array<vec2<f32>, 4>;
    if op.first != 0u {
        for (var i = 0u; i < 4u; i++) {
            sums[i] = vectors[op.out + i * stride + id.x];
        }
    } else {
        for (var v = id.x; v < op.free; v += stride) {
            sums[3] = added(sums[3], dot(gradient[v], direction[v]));
        }
    }
    for (var t = id.x; t < op.rows; t += stride) {
        let corners = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
        let p = position(corners.x);
        let a = edge(p, position(corners.y));
        let b = edge(p, position(corners.z));
        let d = moved(corners.x);
        let here = Corner(a, b, params.mean_area);
        let there =
            Corner(a + (moved(corners.y) - d), b + (moved(corners.z) - d), params.mean_area);
        sums[0] = added(sums[0], metric_excess(here));
        if is_broken(here, there) {
            sums[2].x += 1.0;
        } else {
            sums[1] = added(sums[1], metric_excess(there));
        }
    }
    for (var i = 0u; i < 4u; i++) {
        vectors[op.out + i * stride + id.x] = sums[i];
    }
}
