//! Writer of SELAFIN, in big byte order as TELEMAC writes it.

use crate::export::writer_input::WriterInput;
use crate::precision::Precision;
use crate::visit::items::CellKind;
use std::collections::{HashMap, HashSet};

/// The variable of the height of the bed, by its name in TELEMAC.
pub(crate) const BED: &str = "BOTTOM";

/// Writes points, triangles, boundary numbers, and the height of the bed if the mesh has one. Numbers have single
/// precision if it holds them all.
pub(crate) fn write_selafin(input: &WriterInput<'_>) -> Vec<u8> {
    let content = input.content;
    let bed = input.point_data().find(|data| data.name == BED);
    let mut numbers =
        content.points.as_flattened().iter().chain(bed.iter().flat_map(|bed| &bed.values));
    let is_single = numbers.all(|&x| x.is_nan() || f64::from(x as f32) == x);
    let precision = if is_single { Precision::Single } else { Precision::Double };
    let title = format!("written by {}", input.creator);
    let kind = if is_single { "SERAFIN " } else { "SERAFIND" };
    let mut out = Vec::new();
    record(&mut out, format!("{title:<72.72}{kind}").as_bytes());
    record(&mut out, &ints([i32::from(bed.is_some()), 0]));
    if bed.is_some() {
        record(&mut out, format!("{BED:<16}{:<16}", "M").as_bytes());
    }
    // The first parameter is always 1. Parameters behind the origin are 0: no date, one plane.
    let [x, y] = content.origin;
    record(&mut out, &ints([1, 0, x, y, 0, 0, 0, 0, 0, 0]));
    let triangles = triangles(input);
    let points = content.points.len() as i32;
    record(&mut out, &ints([triangles.len() as i32, points, 3, 1]));
    record(&mut out, &ints(triangles.iter().flatten().map(|&v| v as i32 + 1)));
    record(&mut out, &ints(boundary_numbers(&content.points, &triangles)));
    for axis in 0..2 {
        record(&mut out, &reals(precision, content.points.iter().map(|point| point[axis])));
    }
    if let Some(bed) = bed {
        record(&mut out, &reals(precision, [0.0]));
        record(&mut out, &reals(precision, bed.values.iter().copied()));
    }
    out
}

pub(super) fn triangles(input: &WriterInput<'_>) -> Vec<[u32; 3]> {
    let of = |cell| input.content.cells.of(cell).try_into().expect("a triangle has three corners");
    input.all(CellKind::Triangle).map(of).collect()
}

/// Returns the number of each vertex along the boundary, from 1, and 0 for other vertices. The mesh is on the left of the
/// boundary. Outer boundaries come before islands, and each begins at its vertex of least x + y.
pub(super) fn boundary_numbers(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<i32> {
    let at = |v: u32| points[v as usize];
    let cross =
        |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let mut edges: HashSet<[u32; 2]> = HashSet::new();
    for &[a, b, c] in triangles {
        let [b, c] = if cross([a, b, c].map(at)) < 0.0 { [c, b] } else { [b, c] };
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if !edges.remove(&[to, from]) {
                edges.insert([from, to]);
            }
        }
    }
    // Several edges begin at a vertex where boundaries touch, and the last one counts. Sets have another order in each run.
    let mut edges: Vec<[u32; 2]> = edges.into_iter().collect();
    edges.sort_unstable();
    let next: HashMap<u32, u32> = edges.into_iter().map(|[from, to]| (from, to)).collect();
    let mut starts: Vec<u32> = next.keys().copied().collect();
    let place = |v: u32| at(v)[0] + at(v)[1];
    starts.sort_by(|&a, &b| place(a).total_cmp(&place(b)).then(a.cmp(&b)));
    let mut is_numbered = vec![false; points.len()];
    let (mut outer, mut islands) = (Vec::new(), Vec::new());
    for start in starts {
        let (mut boundary, mut vertex) = (Vec::new(), start);
        while !std::mem::replace(&mut is_numbered[vertex as usize], true) {
            boundary.push(vertex);
            match next.get(&vertex) {
                Some(&next) => vertex = next,
                None => break,
            }
        }
        let area: f64 =
            boundary.windows(2).map(|edge| cross([at(start), at(edge[0]), at(edge[1])])).sum();
        if area > 0.0 { outer.extend(boundary) } else { islands.extend(boundary) }
    }
    let mut numbers = vec![0; points.len()];
    for (number, vertex) in (1..).zip(outer.into_iter().chain(islands)) {
        numbers[vertex as usize] = number;
    }
    numbers
}

/// Appends a Fortran record: its length, its content, and its length again.
fn record(out: &mut Vec<u8>, content: &[u8]) {
    let length = (content.len() as u32).to_be_bytes();
    out.extend(length);
    out.extend_from_slice(content);
    out.extend(length);
}

fn ints(numbers: impl IntoIterator<Item = i32>) -> Vec<u8> {
    numbers.into_iter().flat_map(i32::to_be_bytes).collect()
}

fn reals(precision: Precision, numbers: impl IntoIterator<Item = f64>) -> Vec<u8> {
    let bytes = |number: f64| match precision {
        Precision::Single => (number as f32).to_be_bytes().to_vec(),
        _ => number.to_be_bytes().to_vec(),
    };
    numbers.into_iter().flat_map(bytes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square ring around a square island. Some triangles are clockwise.
    #[test]
    fn outer_boundaries_are_numbered_before_islands_with_the_mesh_on_their_left() {
        let points = [
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [0.0, 3.0],
            [1.0, 1.0],
            [2.0, 1.0],
            [2.0, 2.0],
            [1.0, 2.0],
        ];
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        for side in 0..4 {
            let next = (side + 1) % 4;
            triangles.extend([[side, next, 4 + next], [side, 4 + side, 4 + next]]);
        }
        assert_eq!(boundary_numbers(&points, &triangles), [1, 2, 3, 4, 5, 8, 7, 6]);
    }
}
