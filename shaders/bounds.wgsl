// The discs that free vertices may not leave, and the least altitude of triangles. The CPU keeps the same bounds; see
// src/cpu/within.rs.

const BOUNDED: bool = true;
// Largest normal share of a gradient that is tangential up to rounding.
const TANGENTIAL: f32 = 1e-4;

// The disc of a vertex: the displacement of the vertex from the center, and the radius.
struct Disc {
    away: vec2<f32>,
    radius: f32,
}

// Returns the disc of a free vertex at a position, multiplied by `unit`. Behind the positions and maps, two rows for each
// free vertex hold the center and the radius.
fn disc_of(v: u32, at: vec4<f32>, unit: f32) -> Disc {
    if params.discs == NONE {
        return Disc(vec2(0.0), NO_GUARD);
    }
    let row = params.discs + 2u * v;
    return Disc(edge(position(row), at) * unit, position(row + 1u).x * unit);
}

// Returns the displacement d, or the displacement to the nearest point of the disc if d leads outside.
fn within(disc: Disc, d: vec2<f32>) -> vec2<f32> {
    if disc.radius <= 0.0 {
        return vec2(0.0);
    }
    // Divided by the radius before any product: the square of a small length vanishes.
    let to = (disc.away + d) / disc.radius;
    let distance = length(to);
    if distance <= 1.0 {
        return d;
    }
    return to * (disc.radius / distance) - disc.away;
}

// Returns the direction and slope of a Newton step. If the vertex is at the circle of its disc and the direction `down`
// leads outward, the step is a Newton step along the circle.
fn turned(disc: Disc, down: vec3<f32>, sum: Derivatives) -> vec3<f32> {
    let out = disc.away / max(disc.radius, TINY);
    let distance = length(out);
    if distance < AT_DISC || dot(down.xy, out) <= 0.0 {
        return down;
    }
    let normal = out / distance;
    let tangent = vec2(-normal.y, normal.x);
    let slope = dot(sum.gradient, tangent);
    let h = sum.hessian;
    let bend = dot(sum.gradient, normal) / disc.radius;
    let curvature = h.x * tangent.x * tangent.x + 2.0 * h.y * tangent.x * tangent.y
        + h.z * tangent.y * tangent.y - bend;
    let most = abs(0.5 * (h.x + h.z)) + length(vec2(0.5 * (h.x - h.z), h.y));
    let step = -slope / max(abs(curvature), MIN_CIRCLE_CURVATURE * most);
    // A longer step along the tangent ends at nearly the same point of the circle.
    let limited = clamp(step, -disc.radius, disc.radius);
    return vec3(tangent * limited, min(slope * limited, 0.0));
}

// Returns the gradient by which levels correct a vertex: at the circle of its disc, if the descent leads outward, the part
// along the circle.
fn tangential(disc: Disc, gradient: vec2<f32>) -> vec2<f32> {
    if disc.radius <= 0.0 {
        return vec2(0.0);
    }
    let out = disc.away / disc.radius;
    let distance = length(out);
    if distance < AT_DISC || dot(gradient, out) >= 0.0 {
        return gradient;
    }
    let tangent = vec2(-out.y, out.x) / distance;
    return tangent * dot(tangent, gradient);
}

// Returns the displacement d of a correction, along the circle if `gradient` is a result of `tangential`. A displacement
// inward would raise f by the part of the gradient that `tangential` has removed.
fn along_circle(disc: Disc, d: vec2<f32>, gradient: vec2<f32>) -> vec2<f32> {
    if disc.radius <= 0.0 {
        return vec2(0.0);
    }
    let out = disc.away / disc.radius;
    let distance = length(out);
    if distance < AT_DISC || abs(dot(gradient, out)) > TANGENTIAL * length(gradient) {
        return d;
    }
    let tangent = vec2(-out.y, out.x) / distance;
    return tangent * dot(tangent, d);
}

// Returns the altitude of the triangle between two edges from one corner, less the error of single precision.
fn sure_altitude(a: vec2<f32>, b: vec2<f32>, error: f32) -> f32 {
    let c = b - a;
    let longest = sqrt(max(dot(a, a), max(dot(b, b), dot(c, c))));
    return cross2(a, b) / longest - error * longest;
}

// Returns whether a moved triangle has at least the least altitude, or a larger altitude than before. The triangle is given
// by two edges from one corner, multiplied by `unit`.
fn keeps_altitude(a: vec2<f32>, b: vec2<f32>, moved_a: vec2<f32>, moved_b: vec2<f32>, unit: f32) -> bool {
    if params.least_altitude <= 0.0 {
        return true;
    }
    let now = sure_altitude(moved_a, moved_b, ALTITUDE_ERROR);
    return now >= params.least_altitude * unit || now >= sure_altitude(a, b, -ALTITUDE_ERROR);
}
