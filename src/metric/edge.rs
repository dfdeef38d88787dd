//! The metric EDGE, the ratio of the longest to the shortest edge.

use crate::metric::corner::Corner;
use crate::metric::dual::{Dual, Real};
use crate::metric::properties::Properties;

pub(super) const PROPERTIES: Properties = Properties {
    name: "edge",
    formula: "Lmax / Lmin",
    citation: "Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comp. 23 (2001); Park & Shontz, Table 1 (printed there as its inverse)",
    purpose: "evens out edge lengths; knows no barrier, so flat triangles with three long edges are held off by the shape guard only",
    barrier: false,
    ideal: 1.0,
    scale_invariant: true,
    is_inverse_mean_ratio: false,
    quadratic: false,
    eigenvalue_floor: 0.1,
    shape_guard: 30.0,
    omega: 1.5,
    is_corrected: true,
    wgsl: include_str!("edge.wgsl"),
};

/// q² - 1 for q = Lmax / Lmin.
#[inline(always)]
pub(super) fn excess<T: Real>(t: &Corner<T>) -> T {
    let [a, b, c] = t.squared_lengths();
    let (least, most) = (a.min(b).min(c), a.max(b).max(c));
    (most - least) / least
}

/// The smooth model of q² - 1 that Newton's method minimizes: a p-norm with exponent k = 2^`sharpness`, minus 1.
#[inline(always)]
pub(super) fn model<T: Real>(t: &Corner<T>, sharpness: u32) -> T {
    // The p-norm over pairs of edges: (max/min) [mean A · mean B]^(1/k) with A = (L/max)^k and
    // B = (min/L)^k, over squared lengths L. Powers of ratios below 1 cannot overflow. The value does not
    // depend on the scaling by max and min, so they enter as constants.
    let [la, lb, lc] = t.squared_lengths();
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

/// Value, gradient and Hessian of [`model`].
#[inline(always)]
pub(super) fn expansion<T: Real>(t: &Corner<T>, sharpness: u32) -> Dual<T> {
    let [la, lb, lc] = t.squared_lengths();
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

    // The shares of the two moving edges in both sums, and the vectors u, v = ∇L/L of these edges.
    let shares = one / (a * b);
    let (wa, wb) = (b * shares, a * shares);
    let (wa0, wa1, wb0, wb1) = (a0 * wa, a1 * wa, b0 * wb, b1 * wb);
    let (ta, tb) = (ia * -2.0, ib * -2.0);
    let (u, v) = ([t.a[0] * ta, t.a[1] * ta], [t.b[0] * tb, t.b[1] * tb]);
    let mean_a = [u[0] * wa0 + v[0] * wa1, u[1] * wa0 + v[1] * wa1];
    let mean_b = [u[0] * wb0 + v[0] * wb1, u[1] * wb0 + v[1] * wb1];
    let (gx, gy) = (mean_a[0] - mean_b[0], mean_a[1] - mean_b[1]);
    // Hessian of the logarithm: the curvature of each edge, (2 - L u uᵀ)/L, and the change of the shares, k times the
    // spread of u over the edges.
    let k = f64::from(1u32 << sharpness);
    let (net_a, net_b) = (wa0 - wb0, wa1 - wb1);
    let (more_a, more_b) = ((wa0 + wb0) * k - net_a, (wa1 + wb1) * k - net_b);
    let own = (net_a * ia + net_b * ib) * 2.0;
    let xx = u[0] * u[0] * more_a + v[0] * v[0] * more_b
        - (mean_a[0] * mean_a[0] + mean_b[0] * mean_b[0]) * k;
    let xy = u[0] * u[1] * more_a + v[0] * v[1] * more_b
        - (mean_a[0] * mean_a[1] + mean_b[0] * mean_b[1]) * k;
    let yy = u[1] * u[1] * more_a + v[1] * v[1] * more_b
        - (mean_a[1] * mean_a[1] + mean_b[1] * mean_b[1]) * k;
    Dual {
        value: q - 1.0,
        gradient: [q * gx, q * gy],
        hessian: [q * (xx + own + gx * gx), q * (xy + gx * gy), q * (yy + own + gy * gy)],
    }
}
