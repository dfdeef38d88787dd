// Between the free vertices and the first coarse level. The graph Laplacian on the free vertices is never stored:
// the weight of an edge is the product of the roots of its vertices, which are the `entries`.

@group(0) @binding(2) var<storage, read> ring_start: array<u32>;
@group(0) @binding(3) var<storage, read> ring: array<u32>;
@group(0) @binding(4) var<storage, read> structure: array<u32>;
@group(0) @binding(5) var<storage, read> values: array<f32>;
@group(0) @binding(6) var<storage, read_write> gradient: array<vec2<f32>>;
@group(0) @binding(7) var<storage, read_write> direction: array<vec2<f32>>;
@group(0) @binding(8) var<storage, read_write> vectors: array<vec2<f32>>;

// The square root of a free vertex's weight: the stiffness of the metric over the size of the vertex's elements.
fn root(v: u32) -> f32 {
    return values[op.entries + v];
}
