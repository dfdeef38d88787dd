// Arithmetic in pairs of floats, and the numbering of invocations. Needs `runtime_zero`.
//
// Compilers may treat floats as real numbers: they reorder sums, simplify (a + b) - a to b, and assume that there are
// no infinities and NaNs. WGSL permits such compilers, and Metal's is one by default. A pair of floats would then lose
// its low part. Every sum that must be rounded exactly as written therefore passes through `opaque`, and tests for NaN
// or infinity look at the bits. tests/fast_math simulates such a compiler; check_arithmetic.wgsl checks the compiler of
// each adapter.

// Returns the bits of x. The exclusive or with a zero that is only known at run time keeps a compiler from relating the
// bits to x.
fn opaque_bits(x: f32) -> u32 {
    return bitcast<u32>(x) ^ runtime_zero();
}

// Returns x as a value that the compiler cannot simplify.
fn opaque(x: f32) -> f32 {
    return bitcast<f32>(opaque_bits(x));
}

fn opaque2(v: vec2<f32>) -> vec2<f32> {
    return bitcast<vec2<f32>>(bitcast<vec2<u32>>(v) ^ vec2(runtime_zero()));
}

// Returns whether x is greater than zero and finite. A plain comparison would fail for NaN, as a compiler may turn !(x
// > 0) into x <= 0.
fn is_positive(x: f32) -> bool {
    return opaque_bits(x) - 1u < 0x7f7fffffu;
}

fn is_finite(x: f32) -> bool {
    return (opaque_bits(x) & 0x7f800000u) != 0x7f800000u;
}

// x + y without error, as the rounded sum and its rounding error (Knuth's two-sum).
fn two_sum(x: f32, y: f32) -> vec2<f32> {
    let a = opaque(x);
    let b = opaque(y);
    let s = opaque(a + b);
    let bb = opaque(s - a);
    let aa = opaque(s - bb);
    return vec2(s, opaque(a - aa) + opaque(b - bb));
}

fn pair_add(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let s = two_sum(a.x, b.x);
    return two_sum(s.x, s.y + (a.y + b.y));
}

// A pair times a float, of which 12 bits and the other 12 bits have exact products with those of the pair's high part
// (Dekker's product).
fn pair_times(a: vec2<f32>, y: f32) -> vec2<f32> {
    let x = a.x;
    let x_high = bitcast<f32>(opaque_bits(x) & 0xfffff000u);
    let y_high = bitcast<f32>(opaque_bits(y) & 0xfffff000u);
    let x_low = opaque(x - x_high);
    let y_low = opaque(y - y_high);
    let product = opaque(x * y);
    let across = opaque(opaque(x_high * y_high) - product) + opaque(x_high * y_low);
    let error = opaque(opaque(across) + opaque(x_low * y_high)) + opaque(x_low * y_low);
    return two_sum(product, opaque(error) + opaque(a.y * y));
}

// Adds a float to a pair, as a term of a long sum. Cheaper than pair_add, but the low part is not renormalized.
fn pair_accumulate(sum: vec2<f32>, term: f32) -> vec2<f32> {
    let s = two_sum(sum.x, term);
    return vec2(s.x, sum.y + s.y);
}

// a - b, rounded to a float.
fn pair_difference(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return opaque(a.x - b.x) + opaque(a.y - b.y);
}

fn pair_less(a: vec2<f32>, b: vec2<f32>) -> bool {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

// Returns the position moved by d. The low parts stay below half a unit in the last place of the high parts.
fn advanced(at: vec4<f32>, d: vec2<f32>) -> vec4<f32> {
    let x = pair_add(at.xz, vec2(d.x, 0.0));
    let y = pair_add(at.yw, vec2(d.y, 0.0));
    return vec4(x.x, y.x, x.y, y.y);
}

// Returns the index of an invocation in a dispatch folded to two dimensions.
fn invocation(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return id.x + id.y * groups.x * WORKGROUP;
}
