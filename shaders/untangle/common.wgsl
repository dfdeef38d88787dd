// Shared by the kernels of untangling sweeps. The energies are those of src/untangle/energy.rs, and the bindings are
// `Untangle` in src/gpu/kernels/layouts.rs.

// Returns the number of invocations of a dispatch. Each invocation visits several vertices or triangles, as software
// drivers start every invocation even without work.
fn invocations(groups: vec3<u32>) -> u32 {
    return groups.x * groups.y * WORKGROUP;
}

// Returns the index in the bound part of `ring` for an offset from `ring_start`.
fn ring_place(start: u32) -> u32 {
    return (start & ~HELD) - part.ring_base;
}

// Returns the desired area of a triangle after the transformation by its target map.
fn wanted_area(corners: vec3<u32>, map: vec3<f32>) -> f32 {
    let sum = vertices[corners.x].area + vertices[corners.y].area + vertices[corners.z].area;
    if HAS_TARGETS {
        return sum / 3.0 * abs(map.x * map.z - map.y * map.y);
    }
    return sum / 3.0;
}
