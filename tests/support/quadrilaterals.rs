//! Meshes of quadrilaterals, alone and mixed with triangles.

use gpu_smooth::{Mesh, Topology};

use crate::SplitMix64;

/// Makes a square of `n` times `n` cells of side 1. `is_cut` tells which cells are two triangles instead of a quadrilateral.
pub fn with_cells(n: u32, is_cut: impl Fn(u32, u32) -> bool) -> Mesh {
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let mut mesh = Mesh::default();
    for j in 0..=n {
        mesh.points.extend((0..=n).map(|i| [f64::from(i), f64::from(j)]));
    }
    for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        match is_cut(i, j) {
            true => mesh.triangles.extend([[a, b, c], [a, c, d]]),
            false => mesh.quadrilaterals.push([a, b, c, d]),
        }
    }
    mesh
}

/// A lattice of squares.
pub fn squares(n: u32) -> Mesh {
    with_cells(n, |_, _| false)
}

/// A lattice in which a third of the cells, at irregular places, are triangles.
pub fn mixed(n: u32) -> Mesh {
    with_cells(n, |i, j| (i * 7 + j * 5 + i * j) % 3 == 0)
}

/// Returns the mesh with each vertex inside displaced by up to `most` along both axes.
pub fn perturbed(mesh: &Mesh, most: f64) -> Mesh {
    let topology = Topology::new(mesh).unwrap();
    let mut random = SplitMix64::new(7);
    let mut mesh = mesh.clone();
    for (point, _) in mesh.points.iter_mut().zip(topology.free()).filter(|(_, free)| **free) {
        *point = point.map(|x| x + most * random.range(-1.0, 1.0));
    }
    mesh
}
