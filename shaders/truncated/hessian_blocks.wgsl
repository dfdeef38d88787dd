// The second derivatives of q² by the visited vertex of a triangle and by all three vertices: of q², or of its positive
// semidefinite part (Curvature in src/metric/curvature.rs).

// √3/2, the imaginary part of w = exp(2πi/3).
const H: f32 = 0.86602540378;

// Returns the product of w and a complex number.
fn by_w(z: vec2<f32>) -> vec2<f32> {
    return vec2(-0.5 * z.x - H * z.y, H * z.x - 0.5 * z.y);
}

// Returns the product of the conjugate of w and a complex number.
fn by_conjugate(z: vec2<f32>) -> vec2<f32> {
    return vec2(-0.5 * z.x + H * z.y, -H * z.x - 0.5 * z.y);
}

fn outer(a: vec2<f32>, b: vec2<f32>) -> mat2x2<f32> {
    return mat2x2(a * b.x, a * b.y);
}

// The second derivatives of a triangle by the visited vertex twice (`own`), and by the visited vertex and the head of the edge a
// or b.
struct Blocks {
    own: mat2x2<f32>,
    a: mat2x2<f32>,
    b: mat2x2<f32>,
    gradient: vec2<f32>,
}

#if QUADRILATERALS
fn product(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

fn conjugate(z: vec2<f32>) -> vec2<f32> {
    return vec2(z.x, -z.y);
}

// Returns the matrix of the product with a complex number.
fn turn_by(z: vec2<f32>) -> mat2x2<f32> {
    return mat2x2(z.x, z.y, -z.y, z.x);
}

// The complex factors of the three vertices of the present corner: a displacement p of a vertex changes the conformal part C by
// the factor times p, and the anticonformal part D by the conjugate of the factor times p.
struct Factors {
    own: vec2<f32>,
    a: vec2<f32>,
    b: vec2<f32>,
}

// Returns the factor of a vertex by whose position the edges have these slopes in the plane: w̄ α + w β with the slopes α and β of
// the edges that metrics see.
fn factor_of(plane: vec2<f32>) -> vec2<f32> {
    let s = slopes_of_metrics(plane);
    return vec2(-0.5 * (s.x + s.y), H * (s.y - s.x));
}

fn factors() -> Factors {
    let apex = factor_of(vec2(-1.0, -1.0));
    let end_of_a = factor_of(vec2(1.0, 0.0));
    let end_of_b = factor_of(vec2(0.0, 1.0));
    if plane_slopes.x < 0.0 {
        return Factors(apex, end_of_a, end_of_b);
    }
    if plane_slopes.x > 0.0 {
        return Factors(end_of_a, apex, end_of_b);
    }
    return Factors(end_of_b, apex, end_of_a);
}

// The factors t_c and t_d, and m_cc, m_cd and m_dd, of the Rust struct Curvature.
struct Bends {
    own: vec2<f32>,
    mixed: vec3<f32>,
}

// Returns the block by the visited vertex and a vertex with a factor.
fn block_by(bends: Bends, c: vec2<f32>, d: vec2<f32>, own: vec2<f32>, other: vec2<f32>) -> mat2x2<f32> {
    let between = product(conjugate(own), other);
    let c_by_own = product(conjugate(own), c);
    let d_by_own = product(own, d);
    let c_by_other = product(conjugate(other), c);
    let d_by_other = product(other, d);
    return bends.own.x * turn_by(between) + bends.own.y * turn_by(conjugate(between))
        + outer(c_by_own, bends.mixed.x * c_by_other + bends.mixed.y * d_by_other)
        + outer(d_by_own, bends.mixed.y * c_by_other + bends.mixed.z * d_by_other);
}

#endif
// Displacements p, q and r of the three vertices change the conformal part C by p + w̄ q + w r and the anticonformal part D by
// p + w q + w̄ r.
fn blocks_of(t: Corner) -> Blocks {
    let s = metric_slopes(t);
    let square = s.unit * s.unit;
    let sum = -0.5 * (t.a + t.b);
    let half = H * (t.a - t.b);
    let c = vec2(sum.x + half.y, sum.y - half.x);
    let d = vec2(sum.x - half.y, sum.y + half.x);
    if op.is_positive != 0u {
        return positive_blocks(s, c, d);
    }
    let along = s.area * s.unit * TARGET_W;
    let across = s.excess * s.unit * (2.0 * TARGET_W) - along;
    let third = s.area_area * square / 3.0;
    let mixed = s.excess_area * square * (2.0 / 3.0);
    let cc = third;
    let cd = mixed - third;
    let dd = s.excess_excess * square * (4.0 / 3.0) - 2.0 * mixed + third;
#if QUADRILATERALS
    let f = factors();
    let bends = Bends(corner_weight * vec2(along, across), corner_weight * vec3(cc, cd, dd));
    var made: Blocks;
    made.gradient = bends.own.x * product(conjugate(f.own), c) + bends.own.y * product(f.own, d);
    made.own = block_by(bends, c, d, f.own, f.own);
    made.a = block_by(bends, c, d, f.own, f.a);
    made.b = block_by(bends, c, d, f.own, f.b);
    return made;
#else
    let turn = mat2x2(-0.5, H, -H, -0.5);
    let back = transpose(turn);
    let one = mat2x2(1.0, 0.0, 0.0, 1.0);
    var made: Blocks;
    made.gradient = along * c + across * d;
    made.own = (along + across) * one + outer(c, cc * c + cd * d) + outer(d, cd * c + dd * d);
    let c_by_a = by_w(c);
    let d_by_a = by_conjugate(d);
    made.a = along * back + across * turn + outer(c, cc * c_by_a + cd * d_by_a)
        + outer(d, cd * c_by_a + dd * d_by_a);
    let c_by_b = by_conjugate(c);
    let d_by_b = by_w(d);
    made.b = along * turn + across * back + outer(c, cc * c_by_b + cd * d_by_b)
        + outer(d, cd * c_by_b + dd * d_by_b);
    return made;
#endif
}

// Returns the blocks of the sum of the squares of X·c + Y·d over three rows (X, Y), with c and d the changes of C and D.
fn positive_blocks(s: Slopes, c: vec2<f32>, d: vec2<f32>) -> Blocks {
    let square = dot(d, d);
    let length = sqrt(square);
    let ahead = select(vec2(1.0, 0.0), d / length, length > 0.0);
    let curvature = max(s.area_area, 0.0) * s.unit * s.unit;
    let first = sqrt(curvature);
    let mixed = s.excess_area * s.unit * s.unit;
    let second = select(0.0, length * mixed / first * (2.0 * TARGET_W), first > 0.0);
    let along = s.excess * s.unit * (2.0 * TARGET_W);
    let rest = along + square * s.excess_excess * s.unit * s.unit * (4.0 / 3.0) - second * second;
    let x = first * TARGET_W * c;
    let y = second * ahead - first * TARGET_W * d;
    let third = sqrt(max(rest, 0.0)) * ahead;
    let across = sqrt(max(along, 0.0)) * vec2(-ahead.y, ahead.x);
#if QUADRILATERALS
    let f = factors();
    let own = product(conjugate(f.own), x) + product(f.own, y);
    let third_by_own = product(f.own, third);
    let across_by_own = product(f.own, across);
    var made: Blocks;
    made.gradient = vec2(0.0);
    made.own = outer(own, own) + outer(third_by_own, third_by_own)
        + outer(across_by_own, across_by_own);
    made.a = outer(own, product(conjugate(f.a), x) + product(f.a, y))
        + outer(third_by_own, product(f.a, third)) + outer(across_by_own, product(f.a, across));
    made.b = outer(own, product(conjugate(f.b), x) + product(f.b, y))
        + outer(third_by_own, product(f.b, third)) + outer(across_by_own, product(f.b, across));
    made.own *= corner_weight;
    made.a *= corner_weight;
    made.b *= corner_weight;
    return made;
#else
    let own = x + y;
    var made: Blocks;
    made.gradient = vec2(0.0);
    made.own = outer(own, own) + outer(third, third) + outer(across, across);
    made.a = outer(own, by_w(x) + by_conjugate(y)) + outer(third, by_conjugate(third))
        + outer(across, by_conjugate(across));
    made.b = outer(own, by_conjugate(x) + by_w(y)) + outer(third, by_w(third))
        + outer(across, by_w(across));
    return made;
#endif
}

// Returns a block by displacements of the plane, given that by transformed ones.
fn block_in_plane(block: mat2x2<f32>, map: vec3<f32>, unit: f32) -> vec4<f32> {
    var made = block;
    if HAS_TARGETS {
        let by = mat2x2(map.x, map.y, map.y, map.z);
        made = by * block * by;
    }
    return vec4(made[0], made[1]) * (unit * unit);
}
