// Declarations of the sweeps that untangle a mesh. The energies are those of src/untangle/energy.rs.

// The range of one dispatch: free vertices of one color, or triangles.
struct UntanglePart {
    first: u32,
    count: u32,
    // Number of entries of `ring` before the start of the binding.
    ring_base: u32,
    // Number of vertices that are free or held. Those behind them are on the boundary.
    free: u32,
    // Not zero for the first of the sweeps that are encoded together, which examines the mesh even if it was valid
    // before.
    @size(16) begins: u32,
}

struct Tangle {
    // Not zero if no triangle was found inverted. The kernels then do nothing until the mesh is examined again.
    valid: u32,
    // Number of triangles that are inverted or flat and have a vertex that may move.
    inverted: atomic<u32>,
    // The bits of the largest negative area of these triangles, without its sign, relative to the area that the
    // triangle should have. The bits of non-negative floats compare as the floats do.
    depth: atomic<u32>,
    epsilon: f32,
    // The number of the last sweep, and that of the last sweep before the present tangle.
    sweep: u32,
    since: u32,
}

struct TangledVertex {
    // The area that triangles around the vertex should have.
    area: f32,
    // The number of the sweep in which the vertex began to move.
    reached: atomic<u32>,
}

@group(0) @binding(1) var<uniform> part: UntanglePart;
@group(0) @binding(3) var<storage, read> ring_start: array<u32>; // HELD is set where the vertex must stay
@group(0) @binding(4) var<storage, read> ring: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>;
@group(0) @binding(6) var<storage, read_write> tangle: Tangle;
@group(0) @binding(7) var<storage, read_write> vertices: array<TangledVertex>;
// Two counters: of changes by kernels to the mesh, and of changes by the host to what may move.
@group(0) @binding(8) var<storage, read_write> changes: array<u32, 2>;

// The number of invocations of a dispatch. Each visits several vertices or triangles: software drivers start every
// invocation, whether or not there is anything to do for it.
fn invocations(groups: vec3<u32>) -> u32 {
    return groups.x * groups.y * WORKGROUP;
}

// The index in the bound part of `ring` for an entry of `ring_start`.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - part.ring_base;
}

// The area that a triangle should have after its target map is applied.
fn wanted_area(corners: vec3<u32>, map: vec3<f32>) -> f32 {
    let sum = vertices[corners.x].area + vertices[corners.y].area + vertices[corners.z].area;
    if MAPPED {
        return sum / 3.0 * abs(map.x * map.z - map.y * map.y);
    }
    return sum / 3.0;
}
