//! Changes of order, winding or position, on which the result of smoothing must not depend.

use super::Mesh;
use super::rng::SplitMix64;

/// Reverses the windings of approximately half of the triangles, and rotates the corners of each at
/// random.
pub fn shuffled_windings(mesh: &Mesh, seed: u64) -> Mesh {
    let mut rng = SplitMix64::new(seed);
    let mut shuffled = mesh.clone();
    for triangle in &mut shuffled.triangles {
        triangle.rotate_left(rng.below(3));
        if rng.below(2) == 1 {
            triangle.swap(1, 2);
        }
    }
    shuffled
}

/// Returns the mesh with vertices and triangles in random order, and the new index of each old
/// vertex.
pub fn renumbered(mesh: &Mesh, seed: u64) -> (Mesh, Vec<u32>) {
    let mut rng = SplitMix64::new(seed);
    let mut new_index: Vec<u32> = (0..mesh.points.len() as u32).collect();
    rng.shuffle(&mut new_index);
    let renamed = |v: &u32| new_index[*v as usize];
    let mut points = mesh.points.clone();
    for (&new, &point) in new_index.iter().zip(&mesh.points) {
        points[new as usize] = point;
    }
    let mut triangles: Vec<_> = mesh.triangles.iter().map(|t| t.each_ref().map(renamed)).collect();
    rng.shuffle(&mut triangles);
    let fixed = mesh.fixed.iter().map(renamed).collect();
    (Mesh { points, triangles, fixed, ..Mesh::default() }, new_index)
}

/// Returns the mesh scaled relative to the origin, then translated.
pub fn transformed(mesh: &Mesh, scale: f64, [dx, dy]: [f64; 2]) -> Mesh {
    let points = mesh.points.iter().map(|[x, y]| [x * scale + dx, y * scale + dy]).collect();
    Mesh { points, ..mesh.clone() }
}
