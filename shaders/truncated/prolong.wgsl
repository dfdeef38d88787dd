// Adds the motion of each aggregate with its coarser aggregate to the solution.

@compute @workgroup_size(WORKGROUP)
fn prolong(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let row = invocation(id, groups);
    if row >= op.rows || state.is_solved != 0u {
        return;
    }
    let coarse = rows[op.coarse_solution + structure[op.aggregate_of + row]];
    rows[op.solution + row] += STIFFNESS * (motion_of(row) * coarse);
}
