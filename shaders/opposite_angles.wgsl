// The term of ACUTE that joins opposite angles of a quadrilateral (src/metric/opposite_angles.rs): 200 times the products of their
// cotangents.

// Returns the cotangent of the angle at a corner of a quadrilateral, given the corner as metrics see it.
fn cotangent_of(t: Corner) -> f32 {
    let b = before_shear(t);
    return dot(t.a, b) / cross2(t.a, b);
}

// Returns the cotangent of the angle at the present corner, with its derivatives by the visited vertex.
fn cotangent_derivatives(t: Corner) -> Derivatives {
    let b = before_shear(t);
    let s = plane_slopes;
    return with_angle(
        Derivatives(0.0, vec2(0.0), vec3(0.0)),
        ANGLE_ITSELF,
        1.0 / cross2(t.a, b),
        area_slope(t) / HEIGHT,
        dot(t.a, b),
        s.x * b + s.y * t.a,
        2.0 * s.x * s.y,
    );
}

// Returns a corner of a quadrilateral that the visited vertex is not in, as metrics see it. The present corner is another corner of
// the quadrilateral.
fn distant_corner(p: Patch, vertices: vec3<u32>) -> Corner {
    let start = position(vertices.x);
    let a = edge(start, position(vertices.y)) * p.unit;
    let b = edge(start, position(vertices.z)) * p.unit;
    return transformed(metric_form(Corner(a, b, p.ideal)), map_of(vertices) * p.map_unit);
}

// Returns the cotangent of the angle at a corner around the vertex of a patch, with the vertex moved by d.
fn cotangent_around(p: Patch, role: u32, first: u32, second: u32, d: vec2<f32>) -> f32 {
    let map = map_of_patch(p, first, second);
    return cotangent_of(transformed(metric_form(corner_of(p, role, first, second, d)), map));
}

// Returns the cotangent of the angle at a corner around the vertex of a patch, with its derivatives by the vertex.
fn cotangent_derivatives_around(p: Patch, role: u32, first: u32, second: u32) -> Derivatives {
    let map = map_of_patch(p, first, second);
    let t = transformed(metric_form(corner_of(p, role, first, second, vec2(0.0))), map);
    return pulled_back(cotangent_derivatives(t), map);
}

// Returns the term of a quadrilateral with the vertex of a patch moved by d. `around` are its other vertices, counter-clockwise.
fn opposite_angles(p: Patch, around: vec3<u32>, d: vec2<f32>) -> f32 {
    let own = cotangent_around(p, OWN, around.x, around.z, d);
    let next = cotangent_around(p, NEXT, around.x, around.y, d);
    let last = cotangent_around(p, LAST, around.z, around.y, d);
    let opposite = cotangent_of(distant_corner(p, around.yzx));
    return 200.0 * (own * opposite + next * last);
}

// Adds the term of a quadrilateral, with its derivatives by the vertex of a patch, to a sum.
fn with_opposite_angles(sum: Derivatives, p: Patch, around: vec3<u32>) -> Derivatives {
    let own = cotangent_derivatives_around(p, OWN, around.x, around.z);
    let next = cotangent_derivatives_around(p, NEXT, around.x, around.y);
    let last = cotangent_derivatives_around(p, LAST, around.z, around.y);
    let opposite = cotangent_of(distant_corner(p, around.yzx));
    let g = next.gradient;
    let h = last.gradient;
    let crossed = vec3(2.0 * g.x * h.x, g.x * h.y + g.y * h.x, 2.0 * g.y * h.y);
    return Derivatives(
        sum.value + 200.0 * (own.value * opposite + next.value * last.value),
        sum.gradient + 200.0 * (own.gradient * opposite + g * last.value + h * next.value),
        sum.hessian + 200.0 * (own.hessian * opposite + next.hessian * last.value
            + last.hessian * next.value + crossed),
    );
}

// Returns the share of two opposite corners in the term of their quadrilateral.
fn share_of_opposite_angles(t: Corner, opposite: Corner) -> f32 {
    return 200.0 * cotangent_of(t) * cotangent_of(opposite);
}

// Returns the places of the vertices of the corner opposite to corner k of a quadrilateral, in the list of quadrilaterals.
fn opposite_corner(quadrilateral: u32, k: u32) -> vec3<u32> {
    return 4u * quadrilateral + (vec3(2u, 3u, 1u) + k) % 4u;
}
