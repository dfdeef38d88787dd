// Shared by the kernels on a coarse level, whose bindings are `Coarse` in src/gpu/kernels/layouts.rs.

// Returns the product of a row of the matrix with x.
fn row_times_x(row: u32) -> vec2<f32> {
    var sum = vec2(0.0);
    let end = structure[op.starts + row + 1u];
    for (var i = structure[op.starts + row]; i < end; i++) {
        sum += values[op.entries + i] * vectors[op.x + structure[op.columns + i]];
    }
    return sum;
}
