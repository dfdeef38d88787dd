//! Checks of meshes and their quality, by plain formulas and exact predicates, independent of the library.

use super::Mesh;
use robust::{Coord, orient2d};
use std::collections::BTreeMap;

fn coord([x, y]: [f64; 2]) -> Coord<f64> {
    Coord { x, y }
}

/// Twice the signed area: positive if counterclockwise. The sign is exact, barring underflow.
pub fn orient([a, b, c]: [[f64; 2]; 3]) -> f64 {
    orient2d(coord(a), coord(b), coord(c))
}

pub fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [[f64; 2]; 3] {
    triangle.map(|v| mesh.points[v as usize])
}

/// Sign of the area of each triangle as it is wound: 1, -1, or 0 if it is flat.
pub fn orientations(mesh: &Mesh) -> Vec<i8> {
    let sign = |&t| match orient(corners(mesh, t)) {
        area if area > 0.0 => 1,
        area if area < 0.0 => -1,
        _ => 0,
    };
    mesh.triangles.iter().map(sign).collect()
}

/// Whether every triangle is wound counterclockwise and none is flat.
pub fn is_ccw(mesh: &Mesh) -> bool {
    orientations(mesh).iter().all(|&sign| sign == 1)
}

/// Whether no triangle is flat in `after` nor turned over against `before`.
pub fn same_orientations(before: &Mesh, after: &Mesh) -> bool {
    let signs = orientations(after);
    !signs.contains(&0) && signs == orientations(before)
}

/// How many triangles each edge has, by its vertices in ascending order.
pub fn edge_uses(mesh: &Mesh) -> BTreeMap<[u32; 2], u32> {
    let mut uses = BTreeMap::new();
    for edge in mesh.triangles.iter().flat_map(|&t| edges(t)) {
        *uses.entry(ascending(edge)).or_insert(0) += 1;
    }
    uses
}

pub fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

fn ascending([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Which vertices end an edge that has one triangle.
pub fn boundary(mesh: &Mesh) -> Vec<bool> {
    // Sorted, as a map of the edges of a million triangles is slow.
    let mut all: Vec<_> = mesh.triangles.iter().flat_map(|&t| edges(t)).map(ascending).collect();
    all.sort_unstable();
    let mut on = vec![false; mesh.points.len()];
    for same in all.chunk_by(|a, b| a == b).filter(|same| same.len() == 1) {
        same[0].into_iter().for_each(|v| on[v as usize] = true);
    }
    on
}

/// Which vertices stay: those of the boundary, the fixed ones and those of no triangle.
pub fn held(mesh: &Mesh) -> Vec<bool> {
    let mut held = boundary(mesh);
    mesh.fixed.iter().for_each(|&v| held[v as usize] = true);
    let mut used = vec![false; held.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    held.iter().zip(used).map(|(&held, used)| held || !used).collect()
}

/// How many vertices may move.
pub fn mover_count(mesh: &Mesh) -> usize {
    held(mesh).iter().filter(|&&held| !held).count()
}

/// Whether the mesh lies in the plane without a fold, however its triangles are wound: all positions
/// finite, no triangle flat, no two triangles on the same side of an edge.
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

/// Sum of the areas of the triangles, each taken positive.
pub fn area(mesh: &Mesh) -> f64 {
    mesh.triangles.iter().map(|&t| orient(corners(mesh, t)).abs() / 2.0).sum()
}

pub fn squared_distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    let (dx, dy) = (p[0] - q[0], p[1] - q[1]);
    dx * dx + dy * dy
}

fn squared_lengths([a, b, c]: [[f64; 2]; 3]) -> [f64; 3] {
    [[a, b], [b, c], [c, a]].map(|[p, q]| squared_distance(p, q))
}

/// Inverse mean ratio of a triangle wound counterclockwise: 1 if equilateral, infinite if flat or inverted.
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

/// Mean over the triangles, in either winding, of the square of the inverse mean ratio.
pub fn f_imr(mesh: &Mesh) -> f64 {
    imrs(mesh).map(|q| q * q).sum::<f64>() / mesh.triangles.len() as f64
}

/// Largest inverse mean ratio, in either winding.
pub fn worst_imr(mesh: &Mesh) -> f64 {
    imrs(mesh).fold(0.0, f64::max)
}

/// Smallest angle of any triangle, in degrees.
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
