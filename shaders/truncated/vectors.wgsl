// The vectors of a Newton step of all vertices, one after the other in `fine`. Each vector has room for `op.vector` vertices.
//
// In order: the residual, the solution, the direction, the product of Hessian and direction (before: the preconditioned
// residual), the places of the vertices in their aggregates, two rows of inverse diagonal blocks (xx, xy and yy), the
// partial sums, the sums of their spans, the coefficients of conjugate gradients, and the tangents of the vertices that are not free: zero for fixed
// vertices.

fn solution_at(v: u32) -> u32 {
    return op.vector + v;
}

fn direction_at(v: u32) -> u32 {
    return 2u * op.vector + v;
}

fn product_at(v: u32) -> u32 {
    return 3u * op.vector + v;
}

fn place_at(v: u32) -> u32 {
    return 4u * op.vector + v;
}

fn inverse_at(v: u32) -> u32 {
    return 5u * op.vector + 2u * v;
}

fn sum_at(invocation: u32) -> u32 {
    return 7u * op.vector + invocation;
}

fn coefficients_at(iteration: u32) -> u32 {
    return 7u * op.vector + op.partials + span_count(op.partials) + iteration;
}

fn tangent_at(v: u32) -> u32 {
    return op.tangents + v - op.vertices;
}
