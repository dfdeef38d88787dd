//! Whole turns by which longitudes are shifted at the vertices of each element, so that longitudes are continuous
//! within the element.

use crate::error::MeshError;
use crate::mesh::Element;

/// A full turn, in degrees.
pub(super) const TURN: f64 = 360.0;

/// A vertex of an element in the chart, and the turns to add to its longitude. `None` marks a vertex at a pole, whose
/// longitude becomes the mean longitude of the two vertices beside it.
pub(super) type Turned = (u32, Option<i32>);

pub(super) fn is_pole(points: &[[f64; 2]], v: u32) -> bool {
    points[v as usize][1].abs() == 90.0
}

/// Returns the place of the vertex of an element at a pole, `None` if no vertex or several vertices are at a pole.
pub(super) fn pole_of(points: &[[f64; 2]], element: &[u32]) -> Option<usize> {
    let mut at = (0..element.len()).filter(|&i| is_pole(points, element[i]));
    at.next().filter(|_| at.next().is_none())
}

/// Returns the edges of an element. If exactly one vertex is at a pole, its two edges are left out: a pole has all longitudes, so
/// differences along these edges mean nothing.
fn edges<'e>(points: &[[f64; 2]], element: &'e [u32]) -> impl Iterator<Item = [u32; 2]> + 'e {
    let (pole, count) = (pole_of(points, element), element.len());
    (0..count)
        .map(move |i| [i, (i + 1) % count])
        .filter(move |ends| pole.is_none_or(|at| !ends.contains(&at)))
        .map(|ends| ends.map(|i| element[i]))
}

/// Returns the largest difference of longitudes along an edge of an element, in degrees.
pub(super) fn span(points: &[[f64; 2]], element: &[u32]) -> f64 {
    let apart = |[a, b]: [u32; 2]| (points[a as usize][0] - points[b as usize][0]).abs();
    edges(points, element).map(apart).fold(0.0, f64::max)
}

/// Returns the turns of the vertices of each element, one after the other, so that longitudes along an edge differ by less than
/// half a turn. A connected part of the mesh is continued as a whole unless it closes around the globe. If it does, only elements
/// across the line where longitudes jump are continued.
///
/// Fails with [`MeshError::Pole`] if a pole is inside an element or on an edge.
pub(super) fn turned<'e>(
    points: &[[f64; 2]],
    elements: impl Iterator<Item = (Element, &'e [u32])> + Clone,
) -> Result<Vec<Turned>, MeshError> {
    let x = |v: u32| points[v as usize][0];
    // Turns to add to the longitude of `b` to bring it within half a turn of the longitude of `a`.
    let turns = |a: u32, b: u32| ((x(a) - x(b)) / TURN).round() as i32;
    let mut parts = Parts::new(points.len());
    for (element, vertices) in elements.clone() {
        let (mut around, mut count) = (0, 0);
        for [a, b] in edges(points, vertices) {
            if (x(a) - x(b)).abs().rem_euclid(TURN) == TURN / 2.0 {
                return Err(MeshError::Pole { element });
            }
            (around, count) = (around + turns(a, b), count + 1);
            parts.join(a, b, turns(a, b));
        }
        if count == vertices.len() && around != 0 {
            return Err(MeshError::Pole { element });
        }
    }
    let mut all = Vec::new();
    for (_, vertices) in elements {
        let pole = pole_of(points, vertices);
        let others = (0..vertices.len()).filter(|&i| Some(i) != pole).map(|i| vertices[i]);
        let east = others.reduce(|east, v| if x(v) > x(east) { v } else { east });
        for (i, &v) in vertices.iter().enumerate() {
            let (part, own) = parts.find(v);
            all.push(match parts.is_closed[part as usize] {
                _ if Some(i) == pole => (v, None),
                true => (v, Some(turns(east.unwrap_or(v), v))),
                false => (v, Some(own)),
            });
        }
    }
    Ok(all)
}

/// Union-find of vertices joined by edges, with the turns of each vertex relative to the least vertex of its part.
struct Parts {
    /// Parent of each vertex in its part (a root is its own parent), and the turns of the vertex relative to its
    /// parent.
    toward: Vec<(u32, i32)>,
    /// Flags of parts that close around the globe, indexed by the least vertex of each part.
    is_closed: Vec<bool>,
}

impl Parts {
    fn new(count: usize) -> Self {
        Self { toward: (0..count as u32).map(|v| (v, 0)).collect(), is_closed: vec![false; count] }
    }

    /// Returns the least vertex of the part that contains `v`, and the turns of `v` relative to this vertex.
    fn find(&mut self, v: u32) -> (u32, i32) {
        let (mut at, mut turns) = (v, 0);
        loop {
            let (next, more) = self.toward[at as usize];
            if next == at {
                return (at, turns);
            }
            // Halves the path for the next search.
            let (over, beyond) = self.toward[next as usize];
            self.toward[at as usize] = (over, more + beyond);
            (at, turns) = (over, turns + more + beyond);
        }
    }

    /// Joins the parts of `a` and `b`, where `b` has `turns` more turns than `a`. If the turns along a cycle of edges
    /// have a nonzero sum, the part is marked as closed.
    fn join(&mut self, a: u32, b: u32, turns: i32) {
        let ((least, of_a), (other, of_b)) = (self.find(a), self.find(b));
        let between = of_a + turns - of_b;
        if least == other {
            self.is_closed[least as usize] |= between != 0;
            return;
        }
        let (from, to, more) =
            if least < other { (other, least, between) } else { (least, other, -between) };
        self.toward[from as usize] = (to, more);
        self.is_closed[to as usize] |= self.is_closed[from as usize];
    }
}
