// Begins an iteration of conjugate gradients: ρ, the inner product of the residual and the preconditioned residual, and β, the
// factor of the last direction in the next. Runs in one workgroup.

@compute @workgroup_size(FINISH_WORKGROUP)
fn begin_iteration(@builtin(local_invocation_index) local: u32) {
    let rho = total(local);
    if local != 0u || state.is_solved != 0u {
        return;
    }
    if rho == 0.0 {
        state.is_solved = 1u;
        state.bound = 0.0;
        state.alpha = 0.0;
        return;
    }
    state.beta = select(rho / state.rho, 0.0, state.iterations == 0u);
    state.rho = rho;
}
