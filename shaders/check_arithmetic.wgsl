// Runs the arithmetic of pairs on inputs whose low parts are lost where a compiler reorders sums, and `is_positive` on
// areas that are NaN or infinite. The host compares the results with exact ones; see src/gpu/device/arithmetic.rs.

@compute @workgroup_size(WORKGROUP)
fn check_arithmetic(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&inputs) {
        return;
    }
    let a = inputs[id.x].a;
    let b = inputs[id.x].b;
    results[id.x] = ArithmeticResult(
        two_sum(a.x, b.x),
        pair_add(a.xz, b.xz),
        edge(a, b),
        pair_difference(a.xz, b.xz),
        select(0.0, 1.0, is_positive(doubled_area(Corner(a.xy, b.xy, Ideal())))),
        advanced(a, b.xy),
    );
}
