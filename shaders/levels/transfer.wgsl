// Weights for the transfer between the free vertices and the first coarse level. The graph Laplacian on the free
// vertices is never stored: the weight of an edge is the product of the roots of its two vertices. The bindings are
// `Transfer` in src/gpu/kernels/layouts.rs.

// The root r(v) = √(mean |eigenvalue| of the Hessian of Σ q² by v / number of neighbors). The edge between v and w
// weighs r(v) r(w).
fn root(v: u32) -> f32 {
    return values[op.roots + v];
}

// The factor that fits the levels to a vertex whose stiffness has changed. The matrix of the free vertices is R M R,
// with R the diagonal matrix of the roots, so its inverse is fitted to other roots by a factor on either side. 1 where
// the levels need no fit.
fn fit(v: u32) -> f32 {
    if op.present_roots == NONE {
        return 1.0;
    }
    let factor = root(v) / vectors[op.present_roots + v].x;
    return select(1.0, factor, is_positive(factor));
}
