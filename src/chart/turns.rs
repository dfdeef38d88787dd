//! By how many turns the corners of each triangle are moved, so that longitudes are continuous in it.

use crate::error::MeshError;

/// A full turn, in degrees.
pub(super) const TURN: f64 = 360.0;

/// A corner of a triangle in the chart: a vertex, and the number of turns to be added to its longitude. `None` for a
/// vertex at a pole, whose longitude becomes the mean of those of the other two corners.
pub(super) type Turned = (u32, Option<i32>);

pub(super) fn is_pole(points: &[[f64; 2]], v: u32) -> bool {
    points[v as usize][1].abs() == 90.0
}

/// The corner of a triangle that is at a pole, if it is the only one.
pub(super) fn pole_of(points: &[[f64; 2]], t: &[u32; 3]) -> Option<usize> {
    let mut at = (0..3).filter(|&i| is_pole(points, t[i]));
    at.next().filter(|_| at.next().is_none())
}

/// The edges of a triangle. Those at a single corner at a pole are left out, as all longitudes are the same point
/// there.
fn edges<'t>(points: &[[f64; 2]], t: &'t [u32; 3]) -> impl Iterator<Item = [u32; 2]> + 't {
    let pole = pole_of(points, t);
    (0..3).filter(move |&i| pole.is_none_or(|at| at == (i + 2) % 3)).map(|i| [t[i], t[(i + 1) % 3]])
}

/// The largest difference of longitudes along an edge of the triangle.
pub(super) fn span(points: &[[f64; 2]], t: &[u32; 3]) -> f64 {
    let apart = |[a, b]: [u32; 2]| (points[a as usize][0] - points[b as usize][0]).abs();
    edges(points, t).map(apart).fold(0.0, f64::max)
}

/// Finds the turns of all corners so that longitudes in a triangle differ by less than half a turn. A connected part of
/// the mesh is continued as a whole where that is possible, else only in triangles across the line where longitudes
/// jump.
pub(super) fn turned(
    points: &[[f64; 2]],
    triangles: &[[u32; 3]],
) -> Result<Vec<[Turned; 3]>, MeshError> {
    let x = |v: u32| points[v as usize][0];
    // The number of turns to add to the second longitude to bring it within half a turn of the first.
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

/// Union-find of vertices joined by edges. In each part every vertex has a number of turns.
struct Parts {
    /// For each vertex another vertex of its part, or itself, and how many more turns it has than that one.
    toward: Vec<(u32, i32)>,
    /// Whether a part, identified by its least vertex, closes around the globe.
    is_closed: Vec<bool>,
}

impl Parts {
    fn new(count: usize) -> Self {
        Self { toward: (0..count as u32).map(|v| (v, 0)).collect(), is_closed: vec![false; count] }
    }

    /// Returns the least vertex of a vertex's part, and how many more turns the vertex has than that one.
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

    /// Joins two vertices, the second of which has `turns` more turns.
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
