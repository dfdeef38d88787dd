// Sweeps that turn inverted triangles back. Energies are those of src/untangle/energy.rs.

// The range of one dispatch: free vertices of one color, or triangles.
struct UntanglePart {
    first: u32,
    count: u32,
    // Entries of `ring` in front of the binding.
    ring_base: u32,
    // How many vertices are free or held; those after them are on the boundary.
    free: u32,
    // Not zero for the first of the sweeps that are encoded together: it looks at the mesh whatever was found before.
    @size(16) begins: u32,
}

struct Tangle {
    // Not zero where no triangle was found inverted: what is encoded up to the next look at the mesh does nothing.
    valid: u32,
    // How many triangles are inverted or flat and have a vertex that may move.
    inverted: atomic<u32>,
    // The bits of the largest negative area of these, without its sign, in units of the area that the triangle should have.
    // Numbers that are not negative compare as their bits do.
    depth: atomic<u32>,
    epsilon: f32,
    // Number of the last sweep, and of the last one before the present tangle.
    sweep: u32,
    since: u32,
}

struct TangledVertex {
    // The area that triangles here should have.
    area: f32,
    // The number of the sweep in which the vertex came to be among those that move.
    reached: atomic<u32>,
}

@group(0) @binding(1) var<uniform> part: UntanglePart;
@group(0) @binding(3) var<storage, read> ring_start: array<u32>; // HELD is set where the vertex is to stay
@group(0) @binding(4) var<storage, read> ring: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<u32>;
@group(0) @binding(6) var<storage, read_write> tangle: Tangle;
@group(0) @binding(7) var<storage, read_write> vertices: array<TangledVertex>;
// How often a vertex was moved, and how often the host changed what may move.
@group(0) @binding(8) var<storage, read_write> changes: array<u32, 2>;

// The number of invocations of a dispatch. Each visits several vertices or triangles: software drivers start every
// invocation, whether or not there is anything to do for it.
fn invocations(groups: vec3<u32>) -> u32 {
    return groups.x * groups.y * WORKGROUP;
}

// The place in `ring` that a ring start stands for.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - part.ring_base;
}

// The area that a triangle should have where its map shows it.
fn wanted_area(corners: vec3<u32>, map: vec3<f32>) -> f32 {
    let sum = vertices[corners.x].area + vertices[corners.y].area + vertices[corners.z].area;
    if MAPPED {
        return sum / 3.0 * abs(map.x * map.z - map.y * map.y);
    }
    return sum / 3.0;
}
