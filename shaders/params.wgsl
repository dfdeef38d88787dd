// Shared by the kernels that bind `params`, the constants of a run.
//
// Rust writes declarations in front of the source of each kernel: bindings from src/gpu/kernels/layouts.rs, structs that
// are shared with Rust from src/gpu/kernels/uniforms.rs, and constants in CAPITALS from src/gpu/kernels/source.rs.

fn runtime_zero() -> u32 {
    return params.zero;
}
