//! Tangled meshes as in the literature on untangling. Boundary and fixed vertices stay.

use super::Mesh;
use super::check::{area, held};
use super::generate::graded;
use super::rng::SplitMix64;
use super::trig::on_circle;

/// Returns the mesh with `to` applied to all free vertices.
pub fn moved(mesh: &Mesh, mut to: impl FnMut([f64; 2]) -> [f64; 2]) -> Mesh {
    let mut moved = mesh.clone();
    for (point, held) in moved.points.iter_mut().zip(held(mesh)) {
        if !held {
            *point = to(*point);
        }
    }
    moved
}

/// Returns the corners of the bounding box.
fn bounds(mesh: &Mesh) -> [[f64; 2]; 2] {
    [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|pick| [0, 1].map(|i| mesh.points.iter().map(|p| p[i]).reduce(pick).unwrap_or(0.0)))
}

/// Moves all free vertices to random points of the bounding box.
pub fn scattered(mesh: &Mesh, seed: u64) -> Mesh {
    let [low, high] = bounds(mesh);
    let mut rng = SplitMix64::new(seed);
    moved(mesh, |_| [0, 1].map(|i| rng.range(low[i], high[i])))
}

/// Moves all free vertices randomly by up to `edges` edge lengths along each axis.
pub fn noisy(mesh: &Mesh, edges: f64, seed: u64) -> Mesh {
    let far = edges * (area(mesh) / mesh.triangles.len() as f64 * 4.0 / 3f64.sqrt()).sqrt();
    let mut rng = SplitMix64::new(seed);
    moved(mesh, |p| p.map(|x| x + rng.range(-far, far)))
}

/// Moves all free vertices to a common random point of the bounding box.
pub fn collapsed(mesh: &Mesh, seed: u64) -> Mesh {
    let [low, high] = bounds(mesh);
    let mut rng = SplitMix64::new(seed);
    let place = [0, 1].map(|i| rng.range(low[i], high[i]));
    moved(mesh, |_| place)
}

/// Mirrors the free vertices of a random strip, half as wide as the mesh, at the strip's middle line.
pub fn folded(mesh: &Mesh, seed: u64) -> Mesh {
    let [low, high] = bounds(mesh);
    let width = high[0] - low[0];
    let left = low[0] + width * SplitMix64::new(seed).range(0.05, 0.45);
    let strip = left..left + width / 2.0;
    moved(mesh, |[x, y]| [if strip.contains(&x) { 2.0 * left + width / 2.0 - x } else { x }, y])
}

/// Rotates all free vertices around the center of the bounding box by `turn` full turns.
pub fn turned(mesh: &Mesh, turn: f64) -> Mesh {
    let [low, high] = bounds(mesh);
    let center = [0, 1].map(|i| (low[i] + high[i]) / 2.0);
    let [cos, sin] = on_circle(turn);
    moved(mesh, |p| {
        let [x, y] = [0, 1].map(|i| p[i] - center[i]);
        [center[0] + cos * x - sin * y, center[1] + sin * x + cos * y]
    })
}

/// Makes rings between the unit circle and a hole, with the hole's vertices rotated by `turn` full turns.
pub fn turned_hole(around: usize, turn: f64) -> Mesh {
    let mut mesh = graded(around, 0.3);
    let first = mesh.points.len() - around;
    let [cos, sin] = on_circle(turn);
    for p in &mut mesh.points[first..] {
        *p = [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1]];
    }
    mesh
}
