//! Checks of meshes and their quality, by plain formulas and exact predicates, independent of the library.

use super::Mesh;
use robust::{Coord, orient2d};
use std::collections::BTreeMap;

fn coord([x, y]: [f64; 2]) -> Coord<f64> {
    Coord { x, y }
}

/// Returns twice the signed area, positive for counterclockwise triangles. The sign is exact, except for
/// underflow.
pub fn orient([a, b, c]: [[f64; 2]; 3]) -> f64 {
    orient2d(coord(a), coord(b), coord(c))
}

/// Returns the positions of the three vertices of a triangle.
pub fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [[f64; 2]; 3] {
    triangle.map(|v| mesh.points[v as usize])
}

/// Returns the sign of each triangle's area in its winding: 1, -1, or 0 for flat triangles.
pub fn orientations(mesh: &Mesh) -> Vec<i8> {
    let sign = |&t| match orient(corners(mesh, t)) {
        area if area > 0.0 => 1,
        area if area < 0.0 => -1,
        _ => 0,
    };
    mesh.triangles.iter().map(sign).collect()
}

/// Returns whether all triangles are counterclockwise and none is flat.
pub fn is_ccw(mesh: &Mesh) -> bool {
    orientations(mesh).iter().all(|&sign| sign == 1)
}

/// Returns whether each triangle of `after` has the orientation of `before`, and none is flat.
pub fn same_orientations(before: &Mesh, after: &Mesh) -> bool {
    let signs = orientations(after);
    !signs.contains(&0) && signs == orientations(before)
}

/// Counts the triangles at each edge, which is given by its vertices in ascending order.
pub fn edge_uses(mesh: &Mesh) -> BTreeMap<[u32; 2], u32> {
    let mut uses = BTreeMap::new();
    for edge in mesh.triangles.iter().flat_map(|&t| edges(t)) {
        *uses.entry(ascending(edge)).or_insert(0) += 1;
    }
    uses
}

/// Returns the edges of a triangle, in its winding.
pub fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

fn ascending([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Returns for each vertex whether it belongs to an edge of a single triangle.
pub fn boundary(mesh: &Mesh) -> Vec<bool> {
    // Edges are sorted, because a map of the edges of a million triangles would be slow.
    let mut all: Vec<_> = mesh.triangles.iter().flat_map(|&t| edges(t)).map(ascending).collect();
    all.sort_unstable();
    let mut on = vec![false; mesh.points.len()];
    for same in all.chunk_by(|a, b| a == b).filter(|same| same.len() == 1) {
        same[0].into_iter().for_each(|v| on[v as usize] = true);
    }
    on
}

/// Returns for each vertex whether it must stay: boundary vertices, fixed vertices, and vertices without
/// triangles.
pub fn held(mesh: &Mesh) -> Vec<bool> {
    let mut held = boundary(mesh);
    mesh.fixed.iter().for_each(|&v| held[v as usize] = true);
    let mut used = vec![false; held.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    held.iter().zip(used).map(|(&held, used)| held || !used).collect()
}

/// Counts the vertices that may move.
pub fn mover_count(mesh: &Mesh) -> usize {
    held(mesh).iter().filter(|&&held| !held).count()
}

/// Returns whether the mesh lies flat in the plane without a fold, in any windings: all positions are
/// finite, no triangle is flat, and no two triangles lie on the same side of an edge.
pub fn is_valid(mesh: &Mesh) -> bool {
    let count = mesh.points.len();
    let mut named = mesh.triangles.iter().flatten().chain(&mesh.fixed);
    if !mesh.points.iter().flatten().all(|x| x.is_finite()) || named.any(|&v| v as usize >= count) {
        return false;
    }
    let mut directed = Vec::with_capacity(3 * mesh.triangles.len());
    for &[a, b, c] in &mesh.triangles {
        match orient(corners(mesh, [a, b, c])) {
            area if area > 0.0 => directed.extend(edges([a, b, c])),
            area if area < 0.0 => directed.extend(edges([a, c, b])),
            _ => return false,
        }
    }
    directed.sort_unstable();
    directed.windows(2).all(|pair| pair[0] != pair[1])
}

/// Returns the sum of the unsigned areas of all triangles.
pub fn area(mesh: &Mesh) -> f64 {
    mesh.triangles.iter().map(|&t| orient(corners(mesh, t)).abs() / 2.0).sum()
}

/// Returns the squared distance of two points.
pub fn squared_distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    let (dx, dy) = (p[0] - q[0], p[1] - q[1]);
    dx * dx + dy * dy
}

fn squared_lengths([a, b, c]: [[f64; 2]; 3]) -> [f64; 3] {
    [[a, b], [b, c], [c, a]].map(|[p, q]| squared_distance(p, q))
}

/// Returns the inverse mean ratio of a counterclockwise triangle: 1 if equilateral, infinite if flat or
/// inverted.
pub fn imr(triangle: [[f64; 2]; 3]) -> f64 {
    let double_area = orient(triangle);
    if double_area > 0.0 {
        squared_lengths(triangle).iter().sum::<f64>() / (2.0 * 3f64.sqrt() * double_area)
    } else {
        f64::INFINITY
    }
}

fn imrs(mesh: &Mesh) -> impl Iterator<Item = f64> {
    mesh.triangles.iter().map(|&t| {
        let [a, b, c] = corners(mesh, t);
        imr([a, b, c]).min(imr([a, c, b]))
    })
}

/// Returns the mean of the squared inverse mean ratio over all triangles, in either winding.
pub fn f_imr(mesh: &Mesh) -> f64 {
    imrs(mesh).map(|q| q * q).sum::<f64>() / mesh.triangles.len() as f64
}

/// Returns the largest inverse mean ratio of all triangles, in either winding.
pub fn worst_imr(mesh: &Mesh) -> f64 {
    imrs(mesh).fold(0.0, f64::max)
}

/// Returns the smallest angle of all triangles, in degrees.
pub fn min_angle(mesh: &Mesh) -> f64 {
    let smallest = mesh.triangles.iter().map(|&t| {
        let corners = corners(mesh, t);
        let mut squared = squared_lengths(corners);
        squared.sort_unstable_by(f64::total_cmp);
        // The smallest angle lies between the two longer edges.
        let cosine_part = (squared[1] + squared[2] - squared[0]) / 2.0;
        orient(corners).abs().atan2(cosine_part)
    });
    smallest.fold(f64::INFINITY, f64::min).to_degrees()
}
