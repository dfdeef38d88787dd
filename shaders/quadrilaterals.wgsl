// The corners of quadrilaterals. A corner of a quadrilateral is the triangle of a vertex and the two vertices beside it. Metrics
// see the corner after the shear of `of_right_angle` in src/metric/corner.rs, which turns a right isosceles triangle into an
// equilateral one. A vertex of a quadrilateral has three of its four corners; src/patch/role.rs has the same roles.

// √3/2, the height of an equilateral triangle.
const HEIGHT: f32 = 0.86602540378;
// The place of the visited vertex in a corner: any vertex of a triangle; the first vertex of its own corner; the third vertex of
// the corner at the next vertex; the second vertex of the corner at the last vertex.
const TRIANGLE: u32 = 0u;
const OWN: u32 = 1u;
const NEXT: u32 = 2u;
const LAST: u32 = 3u;

// Whether the present corner, whose edges metrics see, is of a quadrilateral.
var<private> is_right: bool;
// The weight of the present corner: 1 for a triangle, 1/4 for a corner of a quadrilateral.
var<private> corner_weight: f32;
// The slopes of the edges a and b of the present corner by the position of the visited vertex, in the plane.
var<private> plane_slopes: vec2<f32>;
// The slopes of the edges that metrics see.
var<private> edge_slopes: vec2<f32>;

// An element with the vertex of a patch: the vertices of a quadrilateral after the visited vertex, counter-clockwise (the next, the
// opposite and the last vertex), and edges in the patch's unit: from the visited vertex to the next and to the last vertex, and from
// these two to the opposite vertex. A triangle has its last vertex in place of the opposite vertex.
struct Element {
    vertices: vec3<u32>,
    next: vec2<f32>,
    last: vec2<f32>,
    from_next: vec2<f32>,
    from_last: vec2<f32>,
}

// Sets the role of the visited vertex in the present corner.
fn set_role(role: u32) {
    is_right = role != TRIANGLE;
    corner_weight = select(1.0, 0.25, is_right);
    plane_slopes = vec2(-1.0);
    if role >= NEXT {
        plane_slopes = select(vec2(0.0, 1.0), vec2(1.0, 0.0), role == LAST);
    }
    edge_slopes = slopes_of_metrics(plane_slopes);
}

// Makes a corner of a quadrilateral the present corner, with its own vertex first. Returns the places of the three vertices in the
// list of quadrilaterals.
fn own_corner(quadrilateral: u32, k: u32) -> vec3<u32> {
    set_role(OWN);
    return 4u * quadrilateral + vec3(k, (k + 1u) % 4u, (k + 3u) % 4u);
}

// Returns slopes of the edges that metrics see, from slopes of the edges in the plane.
fn slopes_of_metrics(plane: vec2<f32>) -> vec2<f32> {
    if is_right {
        return vec2(plane.x, 0.5 * plane.x + HEIGHT * plane.y);
    }
    return plane;
}

// Returns the present corner as metrics see it.
fn metric_form(t: Corner) -> Corner {
    if is_right {
        return Corner(t.a, 0.5 * t.a + HEIGHT * t.b, t.ideal);
    }
    return t;
}

// Returns the edge b of a corner of a quadrilateral before the shear.
fn before_shear(t: Corner) -> vec2<f32> {
    return (t.b - 0.5 * t.a) / HEIGHT;
}

// Returns the gradient of the doubled area of the present corner, as metrics see it, by the position of the visited vertex.
fn area_slope(t: Corner) -> vec2<f32> {
    return vec2(
        t.b.y * edge_slopes.x - t.a.y * edge_slopes.y,
        t.a.x * edge_slopes.y - t.b.x * edge_slopes.x,
    );
}

// Returns the present corner of the plane after the visited vertex has moved back by d.
fn moved_back(t: Corner, d: vec2<f32>) -> Corner {
    return Corner(t.a - plane_slopes.x * d, t.b - plane_slopes.y * d, t.ideal);
}

// Returns derivatives of the present corner times its weight.
fn weighted(d: Derivatives) -> Derivatives {
    let w = corner_weight;
    return Derivatives(w * d.value, w * d.gradient, w * d.hessian);
}

// Returns the quadrilateral of the vertex of a patch and three other vertices, counter-clockwise.
fn quadrilateral_of(p: Patch, vertices: vec3<u32>) -> Element {
    let next = position(vertices.x);
    let opposite = position(vertices.y);
    let last = position(vertices.z);
    return Element(
        vertices,
        edge(p.at, next) * p.unit,
        edge(p.at, last) * p.unit,
        edge(next, opposite) * p.unit,
        edge(last, opposite) * p.unit,
    );
}

// Returns the two vertices of a corner that are not the visited vertex, counter-clockwise, from the list of an element.
fn others_of(vertices: vec3<u32>, role: u32) -> vec2<u32> {
    if role == NEXT {
        return vertices.xy;
    }
    return select(vertices.xz, vertices.zy, role == LAST);
}

// Returns a corner of an element in the plane, with the vertex of the patch moved by d, and makes it the present corner.
fn corner_in(p: Patch, e: Element, role: u32, d: vec2<f32>) -> Corner {
    set_role(role);
    if role == NEXT {
        return Corner(e.from_next, d - e.next, p.ideal);
    }
    if role == LAST {
        return Corner(d - e.last, e.from_last, p.ideal);
    }
    return Corner(e.next - d, e.last - d, p.ideal);
}

// Returns a corner of the plane around the vertex of a patch, with the vertex moved by d, and makes it the present corner.
// `first` and `second` are the other two vertices, counter-clockwise.
fn corner_of(p: Patch, role: u32, first: u32, second: u32, d: vec2<f32>) -> Corner {
    set_role(role);
    let x = position(first);
    let y = position(second);
    if role < NEXT {
        return Corner(edge(p.at, x) * p.unit - d, edge(p.at, y) * p.unit - d, p.ideal);
    }
    let side = edge(x, y) * p.unit;
    let back = edge(x, p.at) * p.unit + d;
    if role == NEXT {
        return Corner(side, back, p.ideal);
    }
    return Corner(back, side, p.ideal);
}
