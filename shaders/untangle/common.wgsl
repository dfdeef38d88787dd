// For the sweeps that untangle a mesh. The energies are those of src/untangle/energy.rs, and the bindings are `Untangle` in
// src/gpu/kernels/layouts.rs.

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
