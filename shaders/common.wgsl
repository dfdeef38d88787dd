// Bindings of the kernels that run sweeps, beside params.wgsl.

// The range of one dispatch: free vertices of one color, with the parameters of the sweep; or triangles; or free
// vertices of any color. `ring`, `triangles` and `best_positions` are bound from the first entry that the range needs.
struct Part {
    first: u32,
    count: u32,
    omega: f32,
    sharpness: u32,
    // Up to this inverse mean ratio any step may flatten a triangle. NO_GUARD allows any ratio.
    shape_guard: f32,
    // Entries of `ring` in front of the binding.
    ring_base: u32,
    // How many times as long as Newton's a step may be tried where nearly flat triangles make up most of a patch's
    // objective; 1 for never.
    longest: f32,
    // One over the shape guard that a penalty keeps EDGE off, 0 for none.
    over_guard: f32,
}

@group(0) @binding(1) var<uniform> part: Part;
@group(0) @binding(3) var<storage, read> ring_start: array<u32>; // HELD is set where the vertex must stay
@group(0) @binding(4) var<storage, read> ring: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>;
@group(0) @binding(6) var<storage, read_write> partial_sums: array<vec2<f32>>;
@group(0) @binding(7) var<storage, read_write> control: Control;
@group(0) @binding(8) var<storage, read_write> best_positions: array<vec4<f32>>;

// The index in the bound part of `ring` for an entry of `ring_start`.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - part.ring_base;
}
