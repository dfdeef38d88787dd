// The corner of a triangle as metrics see it, and edges between positions held as pairs.

// The ideal triangle of the Rust struct Ideal (src/metric/corner.rs), with the mean area as a pair of floats.
struct Ideal {
    area: vec2<f32>,
    size_weight: f32,
}

// The edge vectors from one vertex of a triangle to the other two, counter-clockwise, and the ideal triangle in the unit
// of the edges.
struct Corner {
    a: vec2<f32>,
    b: vec2<f32>,
    ideal: Ideal,
}

// A value and its derivatives with respect to the vertex that the edges start from. The Hessian holds xx, xy and yy.
struct Derivatives {
    value: f32,
    gradient: vec2<f32>,
    hessian: vec3<f32>,
}

// log2 of the exponent of EDGE's p-norm in this sweep.
var<private> sharpness: u32;
// Reciprocal of the inverse mean ratio toward which EDGE's penalty grows; 0 without a penalty.
var<private> inverse_penalty_guard: f32;

// Returns the edge from one position to another. The differences of the high and of the low parts are opaque: a sum in
// another order, such as head.xy - (tail.xy + tail.zw) + head.zw, would lose the low parts.
fn edge(tail: vec4<f32>, head: vec4<f32>) -> vec2<f32> {
    return opaque2(head.xy - tail.xy) + opaque2(head.zw - tail.zw);
}

fn cross2(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

fn doubled_area(t: Corner) -> f32 {
    return cross2(t.a, t.b);
}

fn squared_length_sum(t: Corner) -> f32 {
    let c = t.b - t.a;
    return dot(t.a, t.a) + dot(t.b, t.b) + dot(c, c);
}

// Returns the corner after its vertex has moved by d.
fn displaced(t: Corner, d: vec2<f32>) -> Corner {
    return Corner(t.a - d, t.b - d, t.ideal);
}

// A patch: a vertex `at` with the triangles around it, given by the entries from `start` to `end` of a list. Edges are
// multiplied by `unit`, which brings them near length one, so that nothing overflows or vanishes.
struct Patch {
    start: u32,
    end: u32,
    at: vec4<f32>,
    unit: f32,
    ideal: Ideal,
    // The target map or local map of the vertex, and the factor that brings its entries near one.
    own: vec3<f32>,
    map_unit: f32,
}

// Returns the power of two that scales an edge to a length near one.
fn unit_of(e: vec2<f32>) -> f32 {
    let exponent = bitcast<u32>(max(abs(e.x), abs(e.y))) & 0x7f800000u;
    return bitcast<f32>(0x7f000000u - clamp(exponent, 0x00800000u, 0x7e800000u));
}

fn inverse_mean_ratio(t: Corner) -> f32 {
    return 0.28867513459 * squared_length_sum(t) / doubled_area(t);
}
