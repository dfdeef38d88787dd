// Target maps (TargetMap in src/metric/target.rs): symmetric matrices as xx, xy, yy, behind the positions, one for each
// vertex. A metric sees a triangle as the mean of the maps at its corners shows it.

const MAPPED: bool = true;

fn target_of(v: u32) -> vec3<f32> {
    return position(params.targets + v).xyz;
}

fn map_of(corners: vec3<u32>) -> vec3<f32> {
    return (target_of(corners.x) + target_of(corners.y) + target_of(corners.z)) / 3.0;
}

fn inverse_of(map: vec3<f32>) -> vec3<f32> {
    return vec3(map.z, -map.y, map.x) / (map.x * map.z - map.y * map.y);
}
