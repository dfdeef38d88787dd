// Replaces target_maps.wgsl for a strongly stretched mesh. Newton directions and the coarser levels use the coordinates
// of the local map of each vertex (src/layout/local_maps.rs). Metrics measure triangles untransformed.

const MAPPED: bool = true;
const HAS_TARGETS: bool = false;

fn map_at(v: u32) -> vec3<f32> {
    return position(params.maps + v).xyz;
}

fn map_of(corners: vec3<u32>) -> vec3<f32> {
    return vec3(1.0, 0.0, 1.0);
}

fn inverse_of(map: vec3<f32>) -> vec3<f32> {
    return vec3(map.z, -map.y, map.x) / (map.x * map.z - map.y * map.y);
}
