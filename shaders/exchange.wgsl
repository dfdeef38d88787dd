// Shared by the kernels that copy positions between this library's buffer and an application's vertex buffer. Their
// bindings are `Exchange` in src/gpu/kernels/layouts.rs.

fn runtime_zero() -> u32 {
    return exchange.zero;
}

// Returns a position in the application's coordinates, rounded to single precision.
fn exported(p: vec4<f32>) -> vec2<f32> {
    let x = pair_times(p.xz, exchange.inverse_scale);
    let y = pair_times(p.yw, exchange.inverse_scale);
    return vec2(
        pair_add(vec2(exchange.center.x, exchange.center.z), x).x,
        pair_add(vec2(exchange.center.y, exchange.center.w), y).x,
    );
}
