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

// Returns the corner opposite the visited vertex of a quadrilateral, as metrics see it. The present corner is another corner of the
// quadrilateral.
fn opposite_of(p: Patch, e: Element) -> Corner {
    let map = map_of(e.vertices.yzx) * p.map_unit;
    return transformed(metric_form(Corner(-e.from_last, -e.from_next, p.ideal)), map);
}

// Returns the cotangent of the angle at a corner of a quadrilateral, with the visited vertex moved by d.
fn cotangent_in(p: Patch, e: Element, role: u32, d: vec2<f32>) -> f32 {
    return cotangent_of(transformed(metric_form(corner_in(p, e, role, d)), map_in(p, e, role)));
}

// Returns the cotangent of the angle at a corner of a quadrilateral, with its derivatives by the visited vertex.
fn cotangent_derivatives_in(p: Patch, e: Element, role: u32) -> Derivatives {
    let map = map_in(p, e, role);
    let t = transformed(metric_form(corner_in(p, e, role, vec2(0.0))), map);
    return pulled_back(cotangent_derivatives(t), map);
}

// Returns the term of a quadrilateral with the vertex of a patch moved by d.
fn opposite_angles(p: Patch, e: Element, d: vec2<f32>) -> f32 {
    let own = cotangent_in(p, e, OWN, d);
    let next = cotangent_in(p, e, NEXT, d);
    let last = cotangent_in(p, e, LAST, d);
    let opposite = cotangent_of(opposite_of(p, e));
    return 200.0 * (own * opposite + next * last);
}

// Returns the term of a quadrilateral, with its derivatives by the vertex of a patch.
fn opposite_angle_derivatives(p: Patch, e: Element) -> Derivatives {
    let own = cotangent_derivatives_in(p, e, OWN);
    let next = cotangent_derivatives_in(p, e, NEXT);
    let last = cotangent_derivatives_in(p, e, LAST);
    let opposite = cotangent_of(opposite_of(p, e));
    let g = next.gradient;
    let h = last.gradient;
    let crossed = vec3(2.0 * g.x * h.x, g.x * h.y + g.y * h.x, 2.0 * g.y * h.y);
    return Derivatives(
        200.0 * (own.value * opposite + next.value * last.value),
        200.0 * (own.gradient * opposite + g * last.value + h * next.value),
        200.0 * (own.hessian * opposite + next.hessian * last.value + last.hessian * next.value + crossed),
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
