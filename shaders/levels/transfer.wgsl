// Weights for the transfer between the free vertices and the first coarse level. The graph Laplacian on the free
// vertices is never stored: the weight of an edge is the product of the roots of its two vertices. The bindings are
// `Transfer` in src/gpu/kernels/layouts.rs.

// The root r(v) = √(mean |eigenvalue| of the Hessian of Σ q² by v / number of neighbors). The edge between v and w
// weighs r(v) r(w).
fn root(v: u32) -> f32 {
    return values[op.roots + v];
}

// Returns the factor that fits the levels to the present stiffness at a vertex; 1 if the levels are not fitted, or if
// the present root vanishes. The matrix of the free vertices is R M R, with R the diagonal matrix of the roots, so a
// factor on either side fits the inverse to other roots.
fn fit(v: u32) -> f32 {
    if op.present_roots == NONE {
        return 1.0;
    }
    let factor = root(v) / vectors[op.present_roots + v].x;
    return select(1.0, factor, is_positive(factor));
}
