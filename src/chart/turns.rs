//! Whole turns by which longitudes are shifted at the corners of each triangle, so that longitudes are continuous
//! within the triangle.

use crate::error::MeshError;

/// A full turn, in degrees.
pub(super) const TURN: f64 = 360.0;

/// A corner of a triangle in the chart: a vertex, and the turns to add to its longitude. `None` marks a vertex at a
/// pole, whose longitude becomes the mean longitude of the other two corners.
pub(super) type Turned = (u32, Option<i32>);

pub(super) fn is_pole(points: &[[f64; 2]], v: u32) -> bool {
    points[v as usize][1].abs() == 90.0
}

/// Returns the corner of a triangle at a pole, `None` if no corner or several corners are at a pole.
pub(super) fn pole_of(points: &[[f64; 2]], t: &[u32; 3]) -> Option<usize> {
    let mut at = (0..3).filter(|&i| is_pole(points, t[i]));
    at.next().filter(|_| at.next().is_none())
}

/// Returns the edges of a triangle. If exactly one corner is at a pole, only the opposite edge is returned: a pole has
/// all longitudes, so differences along the other two edges mean nothing.
fn edges<'t>(points: &[[f64; 2]], t: &'t [u32; 3]) -> impl Iterator<Item = [u32; 2]> + 't {
    let pole = pole_of(points, t);
    (0..3).filter(move |&i| pole.is_none_or(|at| at == (i + 2) % 3)).map(|i| [t[i], t[(i + 1) % 3]])
}

/// Returns the largest difference of longitudes along an edge of a triangle, in degrees.
pub(super) fn span(points: &[[f64; 2]], t: &[u32; 3]) -> f64 {
    let apart = |[a, b]: [u32; 2]| (points[a as usize][0] - points[b as usize][0]).abs();
    edges(points, t).map(apart).fold(0.0, f64::max)
}

/// Returns the turns of all corners, so that longitudes within a triangle differ by less than half a turn. A connected
/// part of the mesh is continued as a whole unless it closes around the globe. If it does, only triangles across the
/// line where longitudes jump are continued.
///
/// Fails with [`MeshError::Pole`] if a pole is inside a triangle or on an edge.
pub(super) fn turned(
    points: &[[f64; 2]],
    triangles: &[[u32; 3]],
) -> Result<Vec<[Turned; 3]>, MeshError> {
    let x = |v: u32| points[v as usize][0];
    // Turns to add to the longitude of `b` to bring it within half a turn of the longitude of `a`.
    let turns = |a: u32, b: u32| ((x(a) - x(b)) / TURN).round() as i32;
    let mut parts = Parts::new(points.len());
    for (triangle, t) in triangles.iter().enumerate() {
        let (mut around, mut count) = (0, 0);
        for [a, b] in edges(points, t) {
            if (x(a) - x(b)).abs().rem_euclid(TURN) == TURN / 2.0 {
                return Err(MeshError::Pole { triangle });
            }
            (around, count) = (around + turns(a, b), count + 1);
            parts.join(a, b, turns(a, b));
        }
        if count == 3 && around != 0 {
            return Err(MeshError::Pole { triangle });
        }
    }
    let mut corners = |t: &[u32; 3]| {
        let pole = pole_of(points, t);
        let others = (0..3).filter(|&i| Some(i) != pole).map(|i| t[i]);
        let east = others.reduce(|east, v| if x(v) > x(east) { v } else { east }).unwrap_or(t[0]);
        [0, 1, 2].map(|i| {
            let (part, own) = parts.find(t[i]);
            match parts.is_closed[part as usize] {
                _ if Some(i) == pole => (t[i], None),
                true => (t[i], Some(turns(east, t[i]))),
                false => (t[i], Some(own)),
            }
        })
    };
    Ok(triangles.iter().map(&mut corners).collect())
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
