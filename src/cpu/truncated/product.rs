//! The product of the Hessian and a vector, without a matrix.

use super::blocks::{Block, Blocks, receive};
use super::derivatives::Numbers;
use super::scalar::Scalar;
use super::terms::{Map, Terms, before_shear, sheared};
use crate::metric::H;
use crate::parallel::paced;
use crate::patch::instructions::with_instructions;

/// Sets `product` to the Hessian times `vector`. Returns the inner product of both.
pub(super) async fn multiply<T: Scalar>(
    blocks: &Blocks,
    numbers: &Numbers<T>,
    vector: &[[T; 2]],
    product: &mut [[T; 2]],
) -> f64 {
    let mut shared = blocks.shared();
    let parts: Vec<_> = blocks.split(product).zip(blocks.split_shared(&mut shared)).collect();
    paced::for_each_part(parts, |at, (product, shared)| {
        let block = &blocks.blocks[at];
        // The vector in the local list, zero at fixed vertices.
        let mut factor = vector[block.own.clone()].to_vec();
        factor.extend(block.others.iter().map(|&other| vector[other as usize]));
        factor.resize(block.vertices.len(), [T::default(); 2]);
        let mut sums = vec![[T::default(); 2]; factor.len()];
        with_instructions!(simd => {
            let _ = simd;
            add_triangles(block, &numbers.terms[at], &numbers.maps[at], &factor, &mut sums);
        });
        product.copy_from_slice(&sums[..product.len()]);
        shared.copy_from_slice(&sums[block.foreign()]);
    })
    .await;
    let parts: Vec<_> = blocks.split(product).collect();
    let inner = paced::map_parts(parts, |at, product| {
        let block = &blocks.blocks[at];
        for (v, received) in block.received() {
            receive(&mut product[v], received, &shared);
        }
        inner(&vector[block.own.clone()], product)
    });
    inner.await.into_iter().sum()
}

/// Adds the Hessians of the corners of a block times `factor` to `sums`.
#[inline(always)]
fn add_triangles<T: Scalar>(
    block: &Block,
    terms: &[Terms<T>],
    maps: &[Map<T>],
    factor: &[[T; 2]],
    sums: &mut [[T; 2]],
) {
    let corners = &block.corners[..terms.len()];
    let triangles = block.triangles.min(terms.len());
    let is_mapped = !maps.is_empty();
    let mut at = 0;
    while at < triangles {
        let [i, j, k] = corners[at];
        let [i, j, k] = [i as usize, j as usize, k as usize];
        let map = if is_mapped { Some(&maps[at]) } else { None };
        let [p, q, r] = of_triangle(&terms[at], map, [factor[i], factor[j], factor[k]]);
        let ([a, b], [c, d], [e, f]) = (sums[i], sums[j], sums[k]);
        sums[i] = [a + p[0], b + p[1]];
        sums[j] = [c + q[0], d + q[1]];
        sums[k] = [e + r[0], f + r[1]];
        at += 1;
    }
    while at < terms.len() {
        let [i, j, k] = corners[at];
        let [i, j, k] = [i as usize, j as usize, k as usize];
        let map = if is_mapped { Some(&maps[at]) } else { None };
        let moved = sheared([factor[i], factor[j], factor[k]]);
        let [p, q, r] = before_shear(of_triangle(&terms[at], map, moved));
        let ([a, b], [c, d], [e, f]) = (sums[i], sums[j], sums[k]);
        sums[i] = [a + p[0], b + p[1]];
        sums[j] = [c + q[0], d + q[1]];
        sums[k] = [e + r[0], f + r[1]];
        at += 1;
    }
}

/// Returns the Hessian of a triangle times the displacements of its corners.
#[inline(always)]
pub(super) fn of_triangle<T: Scalar>(
    terms: &Terms<T>,
    map: Option<&Map<T>>,
    [p, q, r]: [[T; 2]; 3],
) -> [[T; 2]; 3] {
    let (half, h) = (T::of(0.5), T::of(H));
    let middle = [p[0] - half * (q[0] + r[0]), p[1] - half * (q[1] + r[1])];
    let across = [h * (q[0] - r[0]), h * (q[1] - r[1])];
    let mut c = [middle[0] + across[1], middle[1] - across[0]];
    let mut d = [middle[0] - across[1], middle[1] + across[0]];
    if let Some(map) = map {
        [c, d] = map.apply(c, d);
    }
    let Terms { conformal, anticonformal, own, mixed } = *terms;
    let along_c = conformal[0] * c[0] + conformal[1] * c[1];
    let along_d = anticonformal[0] * d[0] + anticonformal[1] * d[1];
    let by_c = mixed[0] * along_c + mixed[1] * along_d;
    let by_d = mixed[1] * along_c + mixed[2] * along_d;
    let mut f = [own[0] * c[0] + by_c * conformal[0], own[0] * c[1] + by_c * conformal[1]];
    let mut g = [own[1] * d[0] + by_d * anticonformal[0], own[1] * d[1] + by_d * anticonformal[1]];
    if let Some(map) = map {
        [f, g] = map.apply(f, g);
    }
    let sum = [f[0] + g[0], f[1] + g[1]];
    let turned = [h * (g[1] - f[1]), h * (f[0] - g[0])];
    [
        sum,
        [turned[0] - half * sum[0], turned[1] - half * sum[1]],
        [-turned[0] - half * sum[0], -turned[1] - half * sum[1]],
    ]
}

/// Returns the inner product of two vectors.
#[inline(always)]
pub(super) fn inner<T: Scalar>(a: &[[T; 2]], b: &[[T; 2]]) -> f64 {
    let mut sums = [0.0; 2];
    let mut at = 0;
    while at < a.len() {
        let ([p, q], [r, s]) = (a[at], b[at]);
        sums = [sums[0] + (p * r).wide(), sums[1] + (q * s).wide()];
        at += 1;
    }
    sums[0] + sums[1]
}
