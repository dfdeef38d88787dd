// Copies each element once. The rate is an upper bound for kernels that read and write memory.

@group(0) @binding(0) var<storage, read> source: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> copied: array<vec4<u32>>;

@compute @workgroup_size(256)
fn copy(
    @builtin(global_invocation_id) at: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
) {
    for (var i = at.x; i < arrayLength(&source); i += workgroups.x * 256u) {
        copied[i] = source[i];
    }
}
