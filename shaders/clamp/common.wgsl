// Shared by the kernels that move vertices toward an application's targets. Each vertex goes an equal share of its way.
// The bindings are `Move` in src/gpu/kernels/layouts.rs.

fn runtime_zero() -> u32 {
    return movement.zero;
}

fn normalized_target(x: f32, center: vec2<f32>) -> vec2<f32> {
    return pair_times(pair_add(vec2(x, 0.0), -center), movement.scale);
}

// Returns the end of a way: the target or, if the target is not finite, the present position.
fn target_of(way: u32, from_: vec4<f32>) -> vec4<f32> {
    let at = movement.offset + ways[way].y * movement.stride;
    let x = normalized_target(targets[at], movement.center.xz);
    let y = normalized_target(targets[at + 1u], movement.center.yw);
    if is_finite(x.x) && is_finite(y.x) {
        return vec4(x.x, y.x, x.y, y.y);
    }
    return from_;
}

// Returns the position of a vertex after a share of its way. The product is opaque, so that all kernels compute the
// same bits.
fn gone(way: u32, from_: vec4<f32>, share: f32) -> vec4<f32> {
    let to = target_of(way, from_);
    if share >= 1.0 {
        return to;
    }
    return advanced(from_, opaque2(share * edge(from_, to)));
}
