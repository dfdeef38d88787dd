// Shared by the kernels on a coarse level, whose bindings are `Coarse` in src/gpu/kernels/layouts.rs.

// Returns the product of a row of the matrix with x.
fn row_times_x(row: u32) -> vec2<f32> {
    var sum = vec2(0.0);
    let end = structure[op.starts + row + 1u];
    var i = structure[op.starts + row];
    // Four entries are under way at once. The order of the sum is that of a plain loop.
    for (; i + 4u <= end; i += 4u) {
        let at = op.columns + i;
        let k = vec4(structure[at], structure[at + 1u], structure[at + 2u], structure[at + 3u]);
        let first = op.entries + i;
        let m = vec4(values[first], values[first + 1u], values[first + 2u], values[first + 3u]);
        let a = vectors[op.x + k.x];
        let b = vectors[op.x + k.y];
        let c = vectors[op.x + k.z];
        let d = vectors[op.x + k.w];
        sum += m.x * a;
        sum += m.y * b;
        sum += m.z * c;
        sum += m.w * d;
    }
    for (; i < end; i++) {
        sum += values[op.entries + i] * vectors[op.x + structure[op.columns + i]];
    }
    return sum;
}
