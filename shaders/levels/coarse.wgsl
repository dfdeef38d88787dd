// Matrices and vectors of the coarse levels.

@group(0) @binding(2) var<storage, read> structure: array<u32>;
@group(0) @binding(3) var<storage, read> values: array<f32>;
@group(0) @binding(4) var<storage, read_write> vectors: array<vec2<f32>>;

// The product of a row of the matrix with x.
fn row_times_x(row: u32) -> vec2<f32> {
    var sum = vec2(0.0);
    let end = structure[op.starts + row + 1u];
    for (var i = structure[op.starts + row]; i < end; i++) {
        sum += values[op.entries + i] * vectors[op.x + structure[op.columns + i]];
    }
    return sum;
}
