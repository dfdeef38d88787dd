// Arithmetic in pairs of floats, and the numbering of invocations. Needs `opaque`.

// a + b exactly, as the rounded sum and what rounding lost (Knuth's two-sum).
fn two_sum(a: f32, b: f32) -> vec2<f32> {
    let s = opaque(a + b);
    let bb = opaque(s - a);
    return vec2(s, (a - opaque(s - bb)) + (b - bb));
}

fn pair_add(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let s = two_sum(a.x, b.x);
    return two_sum(s.x, s.y + (a.y + b.y));
}

fn pair_less(a: vec2<f32>, b: vec2<f32>) -> bool {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

// The position moved by d, with its low part kept below half a unit of its high part.
fn advanced(at: vec4<f32>, d: vec2<f32>) -> vec4<f32> {
    let x = pair_add(at.xz, vec2(d.x, 0.0));
    let y = pair_add(at.yw, vec2(d.y, 0.0));
    return vec4(x.x, y.x, x.y, y.y);
}

// The number of an invocation in a dispatch folded to two dimensions.
fn invocation(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return id.x + id.y * groups.x * WORKGROUP;
}
