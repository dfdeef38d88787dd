// Finds the largest share of their ways that vertices can go before a triangle inverts or gets too flat. Like
// Topology::move_clamped on the host (src/topology/clamp.rs), solves a quadratic equation for each triangle, and then
// checks the triangles at the new positions. Runs in one workgroup.

// An inverse mean ratio in single precision has a relative error of up to this times the ratio.
const ROUNDING: f32 = 4.76837158203125e-7; // 2^-21
// Triangles with a larger inverse mean ratio count as flat, as rounding leaves the sign of the area unknown.
const FLATTEST: f32 = 5.0e5;
// An excessive share is first shortened by SHORTEN_FIRST, relative to the share; each further shortening is
// SHORTEN_MORE times larger.
const SHORTEN_FIRST: f32 = 9.5367431640625e-7; // 2^-20
const SHORTEN_MORE: f32 = 16.0;

var<workgroup> least: atomic<u32>;
var<workgroup> too_long: atomic<u32>;
var<workgroup> share: f32;
var<workgroup> goes_on: u32;

struct Corners {
    p: vec4<f32>,
    q: vec4<f32>,
    r: vec4<f32>,
}

fn corners_of(t: u32) -> Corners {
#if QUADRILATERALS
    set_role(select(TRIANGLE, OWN, (corners[6u * t] & OPPOSITE) != 0u));
#endif
    return Corners(
#if QUADRILATERALS
        position(corners[6u * t] & ~OPPOSITE),
#else
        position(corners[6u * t]),
#endif
        position(corners[6u * t + 1u]),
        position(corners[6u * t + 2u]),
    );
}

// Returns the inverse mean ratio of the triangle spanned by edges a and b; 0 for an inverted, flat or infinite
// triangle.
fn imr(a: vec2<f32>, b: vec2<f32>) -> f32 {
#if QUADRILATERALS
    let t = metric_form(Corner(a, b, Ideal()));
#else
    let t = Corner(a, b, Ideal());
#endif
    let area = doubled_area(t);
    if !is_positive(area) {
        return 0.0;
    }
    let ratio = 0.28867513459 * squared_length_sum(t) / area;
    return select(0.0, ratio, is_positive(ratio) && ratio <= FLATTEST);
}

// Returns the largest inverse mean ratio that the movement may give a triangle, from its present ratio.
fn limit_of(now: f32) -> f32 {
    return max(movement.worst_imr, now * (1.0 + now * ROUNDING));
}

fn way_vector(t: u32, corner: u32, from_: vec4<f32>) -> vec2<f32> {
    let way = corners[6u * t + 3u + corner];
    if way == NONE {
        return vec2(0.0);
    }
    return edge(from_, target_of(way, from_));
}

fn going(t: u32, corner: u32, from_: vec4<f32>, by: f32) -> vec4<f32> {
    let way = corners[6u * t + 3u + corner];
    if way == NONE {
        return from_;
    }
    return gone(way, from_, by);
}

// Returns the least positive root t of constant + slope t + bend t² = 0; 2 without a positive root.
fn least_root(constant: f32, slope: f32, bend: f32) -> f32 {
    let discriminant = slope * slope - 4.0 * bend * constant;
    if discriminant < 0.0 {
        return 2.0;
    }
    // Both roots, by the formula without cancellation.
    let half = -0.5 * (slope + select(-1.0, 1.0, slope >= 0.0) * sqrt(discriminant));
    let first = half / bend;
    let second = constant / half;
    return min(
        select(2.0, first, is_positive(first)),
        select(2.0, second, is_positive(second)),
    );
}

// Returns the share at which a triangle's inverse mean ratio reaches its limit; 1 for triangles that are inverted or
// flat beforehand. The ratio is L / (2√3 D), with L the sum of the squared lengths and D the doubled area, so the share
// is the least root of the quadratic D - L / (2√3 limit).
fn gives_way(t: u32) -> f32 {
    let c = corners_of(t);
    let now = imr(edge(c.p, c.q), edge(c.p, c.r));
    if now == 0.0 {
        return 1.0;
    }
    let dp = way_vector(t, 0u, c.p);
    var e = edge(c.p, c.q);
    var f = edge(c.p, c.r);
    var de = way_vector(t, 1u, c.q) - dp;
    var df = way_vector(t, 2u, c.r) - dp;
#if QUADRILATERALS
    if is_right {
        f = 0.5 * e + HEIGHT * f;
        df = 0.5 * de + HEIGHT * df;
    }
#endif
    // Scaled by the largest coordinate of these vectors, so that nothing overflows.
    let most = max(max(abs(e), abs(f)), max(abs(de), abs(df)));
    let unit = 1.0 / max(most.x, most.y);
    e *= unit;
    f *= unit;
    de *= unit;
    df *= unit;
    let weight = 0.28867513459 / limit_of(now);
    let g = f - e;
    let dg = df - de;
    return least_root(
        cross2(e, f) - weight * (dot(e, e) + dot(f, f) + dot(g, g)),
        cross2(e, df) + cross2(de, f) - 2.0 * weight * (dot(e, de) + dot(f, df) + dot(g, dg)),
        cross2(de, df) - weight * (dot(de, de) + dot(df, df) + dot(dg, dg)),
    );
}

// Returns whether a triangle respects its limit after its vertices have gone a share of their ways.
fn holds(t: u32, by: f32) -> bool {
    let c = corners_of(t);
    let now = imr(edge(c.p, c.q), edge(c.p, c.r));
    if now == 0.0 {
        return true;
    }
    let p = going(t, 0u, c.p, by);
    let then = imr(edge(p, going(t, 1u, c.q, by)), edge(p, going(t, 2u, c.r, by)));
    return then > 0.0 && then <= limit_of(now);
}

@compute @workgroup_size(FINISH_WORKGROUP)
fn find_share(@builtin(local_invocation_index) local: u32) {
    if local == 0u {
        atomicStore(&least, bitcast<u32>(1.0f));
    }
    workgroupBarrier();
    for (var t = local; t < movement.triangles; t += FINISH_WORKGROUP) {
        // Floats that are not negative compare as their bits do.
        atomicMin(&least, bitcast<u32>(gives_way(t)));
    }
    workgroupBarrier();
    if local == 0u {
        let found = bitcast<f32>(atomicLoad(&least));
        share = select(found * (1.0 - SHORTEN_FIRST), 1.0, found >= 1.0);
        goes_on = 1u;
    }
    // The share and the positions are rounded, so a triangle may exceed its limit: lowers the share until no triangle
    // exceeds its limit.
    for (var shorten = SHORTEN_FIRST; shorten < 1.0; shorten *= SHORTEN_MORE) {
        // These loads are barriers as well.
        if workgroupUniformLoad(&goes_on) == 0u {
            break;
        }
        let by = workgroupUniformLoad(&share);
        for (var t = local; t < movement.triangles; t += FINISH_WORKGROUP) {
            if !holds(t, by) {
                atomicStore(&too_long, 1u);
                break;
            }
        }
        workgroupBarrier();
        if local == 0u {
            goes_on = atomicLoad(&too_long);
            if goes_on != 0u {
                let longer = shorten * SHORTEN_MORE;
                share = select(0.0, by * (1.0 - shorten), longer < 1.0);
            }
            atomicStore(&too_long, 0u);
        }
    }
    workgroupBarrier();
    if local == 0u {
        shares[movement.share] = share;
    }
}
