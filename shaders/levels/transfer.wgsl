// Bindings and weights for the transfer between the free vertices and the first coarse level. The graph Laplacian on
// the free vertices is never stored: the weight of an edge is the product of the roots of its two vertices, which are
// in `entries`.

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

// The factor that fits the levels to a vertex whose stiffness has changed. The matrix of the free vertices is R M R,
// with R the diagonal matrix of the roots, so its inverse is fitted to other roots by a factor on either side. 1 where
// the levels need no fit.
fn fit(v: u32) -> f32 {
    if op.step == NONE {
        return 1.0;
    }
    let factor = root(v) / vectors[op.step + v].x;
    return select(1.0, factor, is_positive(factor));
}
