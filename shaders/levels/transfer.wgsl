// Between the free vertices and the first coarse level. The graph Laplacian on the free vertices is never stored:
// `entries` are the sizes of the elements at each vertex, `a` is twice the stiffness of the metric.

@group(0) @binding(2) var<storage, read> ring_start: array<u32>;
@group(0) @binding(3) var<storage, read> ring: array<u32>;
@group(0) @binding(4) var<storage, read> structure: array<u32>;
@group(0) @binding(5) var<storage, read> values: array<f32>;
@group(0) @binding(6) var<storage, read_write> gradient: array<vec2<f32>>;
@group(0) @binding(7) var<storage, read_write> direction: array<vec2<f32>>;
@group(0) @binding(8) var<storage, read_write> vectors: array<vec2<f32>>;

// Weight of the edge between two free vertices.
fn edge_weight(v: u32, k: u32) -> f32 {
    return op.a / (values[op.entries + v] + values[op.entries + k]);
}
