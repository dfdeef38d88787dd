// Bindings of the mesh itself, with its positions in positions.wgsl, and of two vectors on its free vertices: the
// gradient and the correction.

@group(0) @binding(3) var<storage, read> ring_start: array<u32>;
@group(0) @binding(4) var<storage, read> ring: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>;
@group(0) @binding(6) var<storage, read_write> gradient: array<vec2<f32>>;
@group(0) @binding(7) var<storage, read_write> direction: array<vec2<f32>>;
@group(0) @binding(8) var<storage, read_write> vectors: array<vec2<f32>>;
