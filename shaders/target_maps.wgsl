// Target maps (TargetMap in src/metric/target.rs), one for each vertex: symmetric matrices as xx, xy, yy, stored behind
// the positions. A metric sees a triangle transformed by the mean of the maps at its corners.

const MAPPED: bool = true;
const HAS_TARGETS: bool = true;

fn map_at(v: u32) -> vec3<f32> {
    return position(params.maps + v).xyz;
}

fn map_of(corners: vec3<u32>) -> vec3<f32> {
    return (map_at(corners.x) + map_at(corners.y) + map_at(corners.z)) / 3.0;
}

fn inverse_of(map: vec3<f32>) -> vec3<f32> {
    return vec3(map.z, -map.y, map.x) / (map.x * map.z - map.y * map.y);
}
