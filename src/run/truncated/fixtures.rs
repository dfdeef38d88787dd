//! Meshes on which tests of both engines take Newton steps.

use crate::layout::{Problem, prepare};
use crate::mesh::Mesh;
use crate::targets::Targets;

/// A displaced lattice of right triangles with `side` vertices on a side, stretched by `ratio`.
pub(crate) fn lattice(side: u32, ratio: f64) -> Mesh {
    let shift = |k: u32, by: f64| 0.3 * (f64::from(k) * by).sin();
    let is_inside = |k: u32| k > 0 && k + 1 < side;
    let point = |k: u32| {
        let (column, row) = (k % side, k / side);
        let by = if is_inside(column) && is_inside(row) { 1.0 } else { 0.0 };
        [ratio * (f64::from(column) + by * shift(k, 1.7)), f64::from(row) + by * shift(k, 2.9)]
    };
    let cells = (0..side * (side - 1)).filter(|k| k % side + 1 < side);
    let triangles = cells.flat_map(|k| [[k, k + 1, k + side + 1], [k, k + side + 1, k + side]]);
    Mesh {
        points: (0..side * side).map(point).collect(),
        triangles: triangles.collect(),
        ..Mesh::default()
    }
}

/// The lattice of [`lattice`], widened toward the top so that no mesh of squares fits it, with quadrilaterals in place of the
/// triangles of some cells. `is_whole` tells these cells by their numbers.
pub(crate) fn quadrilaterals(side: u32, is_whole: impl Fn(usize) -> bool) -> Mesh {
    let mut mesh = lattice(side, 1.0);
    mesh.points.iter_mut().for_each(|[x, y]| *x *= 1.0 + 0.02 * *y);
    let triangles = std::mem::take(&mut mesh.triangles);
    for (cell, pair) in triangles.chunks_exact(2).enumerate() {
        match is_whole(cell) {
            true => mesh.quadrilaterals.push([pair[0][0], pair[0][1], pair[0][2], pair[1][2]]),
            false => mesh.triangles.extend(pair),
        }
    }
    mesh
}

/// A hub of `around` neighbors, with rings around it.
pub(crate) fn hub(around: u32) -> Mesh {
    let mut points = vec![[0.1, 0.05]];
    for ring in 1..5u32 {
        points.extend((0..around).map(|k| {
            let turn =
                std::f64::consts::TAU * (f64::from(k) + 0.2 * f64::from(ring)) / f64::from(around);
            let radius = f64::from(ring) * (1.0 + if ring < 4 { 0.05 * turn.sin() } else { 0.0 });
            [radius * turn.cos(), radius * turn.sin()]
        }));
    }
    let at = |ring: u32, k: u32| 1 + ring * around + k % around;
    let mut triangles: Vec<[u32; 3]> = (0..around).map(|k| [0, at(0, k), at(0, k + 1)]).collect();
    for (ring, k) in (0..3).flat_map(|ring| (0..around).map(move |k| (ring, k))) {
        triangles.push([at(ring, k), at(ring + 1, k), at(ring + 1, k + 1)]);
        triangles.push([at(ring, k), at(ring + 1, k + 1), at(ring, k + 1)]);
    }
    Mesh { points, triangles, ..Mesh::default() }
}

pub(crate) fn problem(mesh: &Mesh) -> Problem {
    prepare(mesh).unwrap().1
}

/// Makes a problem whose targets change direction and stretching from vertex to vertex.
pub(crate) fn with_targets(mesh: &Mesh) -> Problem {
    let mut problem = problem(mesh);
    let tensor = |p: &[f64; 2]| {
        let (sin, cos) = (0.1 * p[0] + 0.05 * p[1]).sin_cos();
        [1.0 + 2.0 * cos * cos, 2.0 * sin * cos, 1.0 + 2.0 * sin * sin]
    };
    let tensors: Vec<[f64; 3]> = mesh.points.iter().map(tensor).collect();
    problem.set_targets(&Targets::tensors(&tensors).unwrap());
    problem
}
