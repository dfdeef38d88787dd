//! Makes the windings of triangles consistent across edges.

use std::ops::Range;

use crate::error::MeshError;
use crate::parallel::counting_sort::Groups;
use crate::parallel::{map_parts, map_ranges};
use crate::topology::enclosed_area::EnclosedArea;
use crate::topology::predicates;
use crate::topology::stars::others_at_edge;

/// Index in place of a neighbor across a boundary edge, where there is no triangle.
pub(crate) const NONE: u32 = u32::MAX;

/// Returns for each triangle the triangles across its three edges: entry i is across the edge between the corners i and
/// i + 1. [`NONE`] stands for a boundary edge. Fails with [`MeshError::EdgeOfThree`] if more than two triangles share an
/// edge.
pub(crate) fn neighbors(
    triangles: &[[u32; 3]],
    stars: &Groups,
) -> Result<Vec<[u32; 3]>, MeshError> {
    let across = |t: usize| {
        let corners = &triangles[t];
        let mut found = [NONE; 3];
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let mut others = others_at_edge(triangles, stars, t as u32, [a, b]);
            if let Some(other) = others.next() {
                found[i] = other;
                if let Some(third) = others.next() {
                    let all = [t as u32, other, third].into_iter().chain(others);
                    let mut triangles: Vec<_> = all.map(|o| o as usize).collect();
                    triangles.sort_unstable();
                    return Err(MeshError::EdgeOfThree { edge: [a, b], triangles });
                }
            }
        }
        Ok(found)
    };
    let across = |range: Range<usize>| range.map(across).collect::<Result<Vec<_>, _>>();
    let found = map_ranges(triangles.len(), 1 << 12, across).into_iter();
    Ok(found.collect::<Result<Vec<_>, _>>()?.concat())
}

/// Returns whether corner `b` follows directly after corner `a` in a triangle, cyclically.
fn runs(corners: &[u32; 3], a: u32, b: u32) -> bool {
    (0..3).any(|i| corners[i] == a && corners[(i + 1) % 3] == b)
}

/// Criterion that decides the winding of an edge-connected part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Majority {
    /// Most triangles become counter-clockwise, whatever their sizes. If both orientations are equally frequent, the
    /// sum of the signed areas becomes positive. Areas alone may mislead: a single inverted triangle may be larger than
    /// all others together, for example where a mesh of the globe crosses the date line.
    OfTriangles,
    /// The sum of the signed areas becomes positive. If the sum is zero, most triangles become counter-clockwise.
    OfArea,
}

/// Returns the triangles with windings that are consistent across edges. `decides` chooses the winding of each
/// edge-connected part. The result does not depend on the order of triangles and vertices.
pub(crate) fn wind(
    points: &[[f64; 2]],
    triangles: &[[u32; 3]],
    across: &[[u32; 3]],
    decides: Majority,
) -> Vec<[u32; 3]> {
    let mut wound = triangles.to_vec();
    let mut seen = vec![false; triangles.len()];
    let mut part = Vec::new();
    for seed in 0..triangles.len() {
        if seen[seed] {
            continue;
        }
        seen[seed] = true;
        part.clear();
        part.push(seed as u32);
        let (mut majority, mut sum_of_triangles) = (0_i64, 0.0);
        let mut enclosed = EnclosedArea::default();
        let mut next = 0;
        while let Some(&t) = part.get(next) {
            next += 1;
            let corners = wound[t as usize];
            let orientation = predicates::orientation(points, &corners);
            majority += i64::from(orientation > 0.0) - i64::from(orientation < 0.0);
            sum_of_triangles += orientation;
            // `across` refers to the corners as given. If the last two corners have been swapped since, the edges of
            // the triangle run in the opposite direction.
            let given = triangles[t as usize];
            for (i, &other) in across[t as usize].iter().enumerate() {
                let (mut a, mut b) = (given[i], given[(i + 1) % 3]);
                if corners != given {
                    (a, b) = (b, a);
                }
                if other == NONE {
                    enclosed.add(points, [a, b]);
                    continue;
                }
                if seen[other as usize] {
                    continue;
                }
                if runs(&wound[other as usize], a, b) {
                    wound[other as usize].swap(1, 2);
                }
                seen[other as usize] = true;
                part.push(other);
            }
        }
        let doubled_area = enclosed.doubled().unwrap_or(sum_of_triangles);
        let is_clockwise = match decides {
            Majority::OfTriangles => majority < 0 || majority == 0 && doubled_area < 0.0,
            Majority::OfArea => doubled_area < 0.0 || doubled_area == 0.0 && majority < 0,
        };
        if is_clockwise {
            for &t in &part {
                wound[t as usize].swap(1, 2);
            }
        }
    }
    wound
}

/// Returns whether every triangle is counter-clockwise.
pub(crate) fn are_positive(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> bool {
    let all_of = |_, chunk: &[[u32; 3]]| chunk.iter().all(|t| predicates::is_positive(points, t));
    !map_parts(triangles.chunks(1 << 12), all_of).contains(&false)
}
