// The graph Laplacian on the free vertices, which is never stored: `entries` are the sizes of the elements at each
// vertex, `a` is twice the stiffness of the metric.

// Weight of the edge between two free vertices.
fn edge_weight(v: u32, k: u32) -> f32 {
    return op.a / (values[op.entries + v] + values[op.entries + k]);
}
