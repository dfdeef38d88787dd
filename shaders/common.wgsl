// What the kernels of a run of sweeps see, beside params.wgsl.

// The free vertices of one color, and how one sweep steps.
struct SweepColor {
    first: u32,
    count: u32,
    omega: f32,
    sharpness: u32,
}

@group(0) @binding(1) var<uniform> color: SweepColor;
// Position of each vertex as a pair of floats: xy + zw, |zw| at most half a unit in the last place of xy.
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> ring_start: array<u32>; // HELD is set where the vertex is to stay
@group(0) @binding(4) var<storage, read> ring: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>;
@group(0) @binding(6) var<storage, read_write> partial_sums: array<vec2<f32>>;
@group(0) @binding(7) var<storage, read_write> control: Control;
@group(0) @binding(8) var<storage, read_write> best_positions: array<vec4<f32>>;
