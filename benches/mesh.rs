//! Generators of large meshes, within seconds.
#![allow(dead_code, reason = "each benchmark uses a part of it")]

use support::Mesh;
use support::{SplitMix64, lattice, perturb_random, renumbered};

/// Makes a perturbed lattice of `side` times `side` cells. Every fourth diagonal is flipped, so that the number of
/// neighbors varies as in real meshes.
pub(crate) fn irregular(side: usize, seed: u64) -> Mesh {
    let mut mesh = lattice(side, side);
    let mut rng = SplitMix64::new(seed);
    for pair in mesh.triangles.as_chunks_mut::<2>().0 {
        if rng.below(4) == 0 {
            // The four corners of the cell in order, starting at an end of the diagonal.
            let [first, second] = *pair;
            let apex = |t: [u32; 3], o: [u32; 3]| (0..3).find(|&i| !o.contains(&t[i])).unwrap();
            let (i, j) = (apex(first, second), apex(second, first));
            let (p, q, r) = (first[i], first[(i + 1) % 3], first[(i + 2) % 3]);
            let s = second[j];
            *pair = [[p, q, s], [p, s, r]];
        }
    }
    perturb_random(&mesh, 0.8, seed)
}

/// Makes the mesh of [`irregular`] with vertices and triangles in random order, the worst case for caches.
pub(crate) fn mixed(side: usize, seed: u64) -> Mesh {
    renumbered(&irregular(side, seed), seed).0
}
