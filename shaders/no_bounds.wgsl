// Replaces bounds.wgsl for a mesh whose vertices are not bounded.

const BOUNDED: bool = false;

struct Disc {
    away: vec2<f32>,
    radius: f32,
}

fn disc_of(v: u32, at: vec4<f32>, unit: f32) -> Disc {
    return Disc(vec2(0.0), 0.0);
}

fn within(disc: Disc, d: vec2<f32>) -> vec2<f32> {
    return d;
}

fn turned(disc: Disc, down: vec3<f32>, sum: Derivatives) -> vec3<f32> {
    return down;
}

fn tangential(disc: Disc, gradient: vec2<f32>) -> vec2<f32> {
    return gradient;
}

fn along_circle(disc: Disc, d: vec2<f32>, gradient: vec2<f32>) -> vec2<f32> {
    return d;
}

fn keeps_altitude(a: vec2<f32>, b: vec2<f32>, moved_a: vec2<f32>, moved_b: vec2<f32>, unit: f32) -> bool {
    return true;
}
