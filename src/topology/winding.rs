//! Makes the windings of elements consistent across edges.

use std::ops::Range;

use crate::error::MeshError;
use crate::parallel::counting_sort::Groups;
use crate::parallel::{map_parts, map_ranges};
use crate::topology::corners::Corners;
use crate::topology::enclosed_area::EnclosedArea;
use crate::topology::predicates;
use crate::topology::stars::others_at_edge;

/// Index in place of a neighbor across a boundary edge, where there is no element.
pub(crate) const NONE: u32 = u32::MAX;

/// Returns for each side of an element the first corner of the element across it, or [`NONE`] for a boundary edge. The sides
/// are in the order of [`Corners::sides`], element by element. Fails with [`MeshError::EdgeOfThree`] if more than two
/// elements share an edge.
pub(crate) fn neighbors(corners: &Corners<'_>, stars: &Groups) -> Result<Vec<u32>, MeshError> {
    let across = |(first, [a, b]): (u32, [u32; 2])| {
        let mut others = others_at_edge(corners, stars, first, [a, b]);
        let Some(other) = others.next() else { return Ok(NONE) };
        let Some(third) = others.next() else { return Ok(other) };
        let mut all: Vec<u32> = [first, other, third].into_iter().chain(others).collect();
        all.sort_unstable();
        let elements = all.into_iter().map(|first| corners.element(first)).collect();
        Err(MeshError::EdgeOfThree { edge: [a, b], elements })
    };
    let across = |range: Range<usize>| {
        range.flat_map(|corner| corners.sides(corner)).map(across).collect::<Result<Vec<_>, _>>()
    };
    let found = map_ranges(corners.all().len(), 1 << 12, across).into_iter();
    Ok(found.collect::<Result<Vec<_>, _>>()?.concat())
}

/// Criterion that decides the winding of an edge-connected part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Majority {
    /// Most elements become counter-clockwise, whatever their sizes. If both orientations are equally frequent, the
    /// sum of the signed areas becomes positive. Areas alone may mislead: a single inverted triangle may be larger than
    /// all others together, for example where a mesh of the globe crosses the date line.
    OfElements,
    /// The sum of the signed areas becomes positive. If the sum is zero, most elements become counter-clockwise.
    OfArea,
}

/// Returns corners with windings that are consistent across edges. `across` has the [`neighbors`] of the given corners, and
/// `decides` chooses the winding of each edge-connected part. The result does not depend on the order of elements and
/// vertices.
pub(crate) fn wind(
    points: &[[f64; 2]],
    given: &Corners<'_>,
    across: &[u32],
    decides: Majority,
) -> Corners<'static> {
    let mut wound = given.clone().into_owned();
    let mut seen = vec![false; given.all().len()];
    let mut part = Vec::new();
    for seed in given.firsts() {
        if seen[seed as usize] {
            continue;
        }
        seen[seed as usize] = true;
        part.clear();
        part.push(seed);
        let (mut majority, mut sum_of_elements) = (0_i64, 0.0);
        let mut enclosed = EnclosedArea::default();
        let mut next = 0;
        while let Some(&element) = part.get(next) {
            next += 1;
            let orientation = orientation_of(points, &wound, element);
            majority += i64::from(orientation > 0.0) - i64::from(orientation < 0.0);
            sum_of_elements += orientation;
            // `across` refers to the corners as given. If the element has been reversed since, its edges run in the opposite
            // direction.
            let is_reversed = wound.all()[element as usize] != given.all()[element as usize];
            let count = if given.is_triangle(element) { 1 } else { 4 };
            let own = element as usize..element as usize + count;
            let first_side = given.first_side(element);
            let sides = own.flat_map(|corner| given.sides(corner));
            for ((_, [mut a, mut b]), &other) in sides.zip(&across[first_side..]) {
                if is_reversed {
                    (a, b) = (b, a);
                }
                if other == NONE {
                    enclosed.add(points, [a, b]);
                    continue;
                }
                if seen[other as usize] {
                    continue;
                }
                if wound.next(other, a) == Some(b) {
                    wound.reverse(other);
                }
                seen[other as usize] = true;
                part.push(other);
            }
        }
        let doubled_area = enclosed.doubled().unwrap_or(sum_of_elements);
        let is_clockwise = match decides {
            Majority::OfElements => majority < 0 || majority == 0 && doubled_area < 0.0,
            Majority::OfArea => doubled_area < 0.0 || doubled_area == 0.0 && majority < 0,
        };
        if is_clockwise {
            part.iter().for_each(|&element| wound.reverse(element));
        }
    }
    wound
}

/// Returns twice the signed area of an element, given its first corner.
fn orientation_of(points: &[[f64; 2]], corners: &Corners<'_>, element: u32) -> f64 {
    let first = corners.all()[element as usize];
    match corners.opposite(element) {
        None => predicates::orientation(points, &first),
        Some(opposite) => {
            let [own, next, last] = first;
            predicates::orientation(points, &[own, next, opposite])
                + predicates::orientation(points, &[own, opposite, last])
        }
    }
}

/// Returns whether every triangle is counter-clockwise.
pub(crate) fn are_positive(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> bool {
    let all_of = |_, chunk: &[[u32; 3]]| chunk.iter().all(|t| predicates::is_positive(points, t));
    !map_parts(triangles.chunks(1 << 12), all_of).contains(&false)
}
