//! The metric EDGE, the ratio of the longest to the shortest edge.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};
use crate::metric::edge_slopes::{EdgeSlopes, Given};
use crate::metric::properties::Properties;

pub(super) const PROPERTIES: Properties = Properties {
    name: "edge",
    formula: "Lmax / Lmin",
    citation: "Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comp. 23 (2001); Park & Shontz, Table 1 (printed there as its inverse)",
    purpose: "evens out edge lengths; knows no barrier, so flat triangles with three long edges are held off by the shape guard only",
    barrier: false,
    ideal: 1.0,
    least: 1.0,
    scale_invariant: true,
    has_size_weight: false,
    is_inverse_mean_ratio: false,
    quadratic: false,
    eigenvalue_floor: 0.1,
    shape_guard: 30.0,
    omega: 1.5,
    is_corrected: true,
    wgsl: include_str!("edge.wgsl"),
};

/// Returns the squared lengths of the edges. For a corner of a quadrilateral, they are those of the two sides and of the
/// diagonal divided by √2, which are equal in a square. The lengths of the sheared corner would depend on which side comes
/// first.
#[inline(always)]
fn squared_lengths<T: Real>(t: &Corner<T>) -> [T; 3] {
    match t.ideal.is_right {
        true => {
            let [a, b, c] = t.before_shear().squared_lengths();
            [a, b, c * 0.5]
        }
        false => t.squared_lengths(),
    }
}

/// Returns q² - 1 for q = Lmax / Lmin.
#[inline(always)]
pub(super) fn excess<T: Real>(t: &Corner<T>) -> T {
    let [a, b, c] = squared_lengths(t);
    let (least, most) = (a.min(b).min(c), a.max(b).max(c));
    (most - least) / least
}

/// Returns the smooth model of q² - 1 that Newton's method minimizes: a p-norm with exponent k = 2^`sharpness`, minus
/// 1.
#[inline(always)]
pub(super) fn model<T: Real>(t: &Corner<T>, sharpness: u32) -> T {
    // The p-norm over pairs of edges: (max/min) [mean A · mean B]^(1/k) with A = (L/max)^k and B = (min/L)^k, over
    // squared lengths L. Powers of ratios below 1 cannot overflow. The value does not depend on the factors max and
    // min, so both enter as constants.
    let [la, lb, lc] = squared_lengths(t);
    let most = la.max(lb).max(lc).fixed();
    let least = la.min(lb).min(lc).fixed();
    let (mut a0, mut a1, mut a2) = (la / most, lb / most, lc / most);
    let (mut b0, mut b1, mut b2) = (least / la, least / lb, least / lc);
    for _ in 0..sharpness {
        (a0, a1, a2) = (a0 * a0, a1 * a1, a2 * a2);
        (b0, b1, b2) = (b0 * b0, b1 * b1, b2 * b2);
    }
    let (a, b) = (a0 + a1 + a2, b0 + b1 + b2);
    let mut root = a * b * (1.0 / 9.0);
    for _ in 0..sharpness {
        root = root.sqrt();
    }
    root * (most / least) - 1.0
}

/// Returns value, gradient and Hessian of [`model`] with respect to the visited vertex. `edges` has the slopes of the
/// edges by the position of the vertex.
#[inline(always)]
pub(super) fn expansion<E: EdgeSlopes, T: Real>(
    t: &Corner<T>,
    edges: E,
    sharpness: u32,
) -> Dual<T> {
    if !E::IS_OWN && t.ideal.is_right {
        return scaled_expansion(&t.before_shear(), Given::before_shear(edges), 0.5, sharpness);
    }
    scaled_expansion(t, edges, 1.0, sharpness)
}

/// Computes [`expansion`] with the squared length of the edge b - a times `scale`.
#[inline(always)]
fn scaled_expansion<T: Real>(
    t: &Corner<T>,
    edges: impl EdgeSlopes,
    scale: f64,
    sharpness: u32,
) -> Dual<T> {
    let (alpha, beta, third) = (edges.alpha(), edges.beta(), edges.third());
    let [la, lb, lc] = t.squared_lengths();
    let lc = if scale == 1.0 { lc } else { lc * scale };
    let (most, least) = (la.max(lb).max(lc), la.min(lb).min(lc));
    let one = la.constant(1.0);
    let (ia, ib, ic) = (one / la, one / lb, one / lc);
    let over = one / most;
    let (mut a0, mut a1, mut a2) = (la * over, lb * over, lc * over);
    let (mut b0, mut b1, mut b2) = (least * ia, least * ib, least * ic);
    for _ in 0..sharpness {
        (a0, a1, a2) = (a0 * a0, a1 * a1, a2 * a2);
        (b0, b1, b2) = (b0 * b0, b1 * b1, b2 * b2);
    }
    let (a, b) = (a0 + a1 + a2, b0 + b1 + b2);
    let mut root = a * b * (1.0 / 9.0);
    for _ in 0..sharpness {
        root = root.sqrt();
    }
    let q = root * (most * (least.constant(1.0) / least));

    // The shares of the edges a and b in both sums, and the vectors u, v = ∇L/L of the two edges.
    let shares = one / (a * b);
    let (wa, wb) = (b * shares, a * shares);
    let (wa0, wa1, wb0, wb1) = (a0 * wa, a1 * wa, b0 * wb, b1 * wb);
    let (ta, tb) = (ia * (2.0 * alpha), ib * (2.0 * beta));
    let (u, v) = ([t.a[0] * ta, t.a[1] * ta], [t.b[0] * tb, t.b[1] * tb]);
    let mut mean_a = [u[0] * wa0 + v[0] * wa1, u[1] * wa0 + v[1] * wa1];
    let mut mean_b = [u[0] * wb0 + v[0] * wb1, u[1] * wb0 + v[1] * wb1];
    // Hessian of the logarithm: the curvature of each edge, (2 α² - L u uᵀ)/L for the edge a, and the change of the
    // shares, k times the spread of u over the edges.
    let k = f64::from(1u32 << sharpness);
    let (net_a, net_b) = (wa0 - wb0, wa1 - wb1);
    let (more_a, more_b) = ((wa0 + wb0) * k - net_a, (wa1 + wb1) * k - net_b);
    let mut own = (net_a * ia * (alpha * alpha) + net_b * ib * (beta * beta)) * 2.0;
    let mut xx = u[0] * u[0] * more_a + v[0] * v[0] * more_b;
    let mut xy = u[0] * u[1] * more_a + v[0] * v[1] * more_b;
    let mut yy = u[1] * u[1] * more_a + v[1] * v[1] * more_b;
    // The edge b - a moves too, unless both edges start from the visited vertex.
    if third != 0.0 {
        let (wa2, wb2) = (a2 * wa, b2 * wb);
        let tc = ic * (2.0 * third * scale);
        let w = [(t.b[0] - t.a[0]) * tc, (t.b[1] - t.a[1]) * tc];
        mean_a = [mean_a[0] + w[0] * wa2, mean_a[1] + w[1] * wa2];
        mean_b = [mean_b[0] + w[0] * wb2, mean_b[1] + w[1] * wb2];
        let net_c = wa2 - wb2;
        let more_c = (wa2 + wb2) * k - net_c;
        own = own + net_c * ic * (2.0 * third * third * scale);
        xx = xx + w[0] * w[0] * more_c;
        xy = xy + w[0] * w[1] * more_c;
        yy = yy + w[1] * w[1] * more_c;
    }
    let (gx, gy) = (mean_a[0] - mean_b[0], mean_a[1] - mean_b[1]);
    let xx = xx - (mean_a[0] * mean_a[0] + mean_b[0] * mean_b[0]) * k;
    let xy = xy - (mean_a[0] * mean_a[1] + mean_b[0] * mean_b[1]) * k;
    let yy = yy - (mean_a[1] * mean_a[1] + mean_b[1] * mean_b[1]) * k;
    Dual {
        value: q - 1.0,
        gradient: [q * gx, q * gy],
        hessian: [q * (xx + own + gx * gx), q * (xy + gx * gy), q * (yy + own + gy * gy)],
    }
}
