//! Cuts a mesh along straight lines into pieces whose boundaries turn inward by less than a sixth of a turn.
//!
//! If the boundary of a mesh is convex, the means of neighbors are a good start for its free vertices. Around holes and
//! in bays, means of neighbors fold triangles over. If a hole was turned or moved elsewhere, sweeps do not find the
//! direction in which the mesh must wind around the hole. A cut fixes the direction: a straight line joins two boundary
//! vertices in the plane, and the vertices of a path of edges between them are moved onto the line. The first lines
//! join all boundaries of a piece to one boundary. The piece can then be laid out without a fold along every path, if
//! it has vertices enough. Further lines cut off the bays. The vertices of all paths are held while the other vertices
//! move to the means of their neighbors, and move freely afterward.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::PI;

use glam::DVec2;

use crate::layout::Problem;
use crate::parallel::map_parts;
use crate::untangle::pieces::{Boundary, Corner, Pieces};

/// Largest number of corners, on all boundaries of a piece together, that are tried as ends of a line.
const TRIED: usize = 1024;
/// Largest number of corners of a single boundary of which all pairs are tried as ends of a line.
const TRIED_WITHIN: usize = 256;
/// Largest factor by which [`Short::ByChance`] raises the rating of a line. The factor makes trials differ, but no
/// trial begins with a bad line.
const CHANCE: f64 = 1.3;
/// Largest number of corners from which a search measures path lengths.
const SOURCES: usize = 24;
/// Largest angle by which a chain of a boundary may turn inward without a cut, in radians: a sixth of a turn.
const INWARD: f64 = PI / 3.0;
/// Largest length of a line within one boundary, relative to the part of the boundary that the line cuts off.
const SHARE: f64 = 0.7;
/// Size of a piece, in triangles, up to which the piece is not cut.
const FEWEST: usize = 8;
/// Largest number of boundaries of a piece that is cut. A piece with more boundaries has many fixed vertices inside,
/// and each fixed vertex is a boundary.
const MAX_BOUNDARIES: usize = 256;
/// Upper limit of the triangles of all pieces that are cut, in units of the triangles of the mesh. The limit keeps the
/// time of cuts below the time of the sweeps.
const MAX_WORK: usize = 256;

/// How candidate lines between two boundaries are ranked, smallest rating first. No ranking leads to the least
/// distorted mesh in all cases.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Short {
    /// Length of the straight line.
    Line,
    /// Rating max³ / min² of the lengths of line and path, which favors short lines with a path of similar length.
    Both,
    /// Length of the path of edges.
    Path,
    /// Rating of `Both` times a pseudorandom factor from 1 to [`CHANCE`], so that another line may win that is nearly
    /// as good. The number selects the random numbers of the trial.
    ByChance(u32),
}

/// The vertices on cuts, with their positions.
pub(super) struct Cuts {
    /// Flag of each vertex: true if the vertex is fixed or on a cut.
    pub(super) held: Vec<bool>,
    /// Position of each vertex. Vertices on no cut keep their positions.
    pub(super) positions: Vec<DVec2>,
}

/// Cuts a mesh by one ranking of lines. `areas` are the target areas at the vertices.
pub(super) fn cut(problem: &Problem, areas: &[f64], positions: &[DVec2], short: Short) -> Cuts {
    let mut cutter = Cutter::new(problem, areas, positions.to_vec(), short);
    let mut open = cutter.pieces.all();
    let mut work = MAX_WORK * problem.triangles().len();
    while let Some(piece) = open.pop() {
        if piece.len() > FEWEST && piece.len() <= work && cutter.cut(&piece) {
            work -= piece.len();
            open.extend(cutter.pieces.parted(&piece));
        }
    }
    Cuts { held: cutter.pieces.into_held(), positions: cutter.positions }
}

/// A corner: index of the boundary, and index of the corner within the boundary.
type Place = (usize, usize);

struct Cutter<'p> {
    problem: &'p Problem,
    pieces: Pieces<'p>,
    /// Target edge length at each vertex, up to a common factor.
    lengths: Vec<f64>,
    positions: Vec<DVec2>,
    short: Short,
    /// For each free vertex of the piece that is cut, the number of edges to the nearest held vertex.
    depth: Vec<u32>,
    /// Cost of the cheapest path found so far to each free vertex.
    cost: Vec<u64>,
    /// Predecessor of each vertex on its cheapest path.
    before: Vec<u32>,
}

impl<'p> Cutter<'p> {
    fn new(problem: &'p Problem, areas: &[f64], positions: Vec<DVec2>, short: Short) -> Self {
        let free = problem.free_count();
        Self {
            problem,
            pieces: Pieces::new(problem),
            lengths: areas.iter().map(|area| area.sqrt()).collect(),
            positions,
            short,
            depth: vec![0; free],
            cost: vec![u64::MAX; free],
            before: vec![0; free],
        }
    }

    /// Cuts a piece once, and moves the vertices of the path onto the line. Returns whether the piece needed a cut and
    /// a path was found.
    fn cut(&mut self, piece: &[u32]) -> bool {
        let boundaries = self.pieces.boundaries(piece);
        let ends = match &boundaries[..] {
            [] => None,
            [boundary] => self.within(boundary),
            all if all.len() > MAX_BOUNDARIES => None,
            all => self.between(all),
        };
        let Some(ends) = ends else { return false };
        let [from, to] = ends.map(|(b, i)| &boundaries[b][i]);
        self.measure_depths(piece);
        let path = self.path(from, to);
        // Distances along the line are proportional to distances along the path.
        let length = |v: u32| self.lengths[v as usize];
        let mut reached = 0.5 * length(from.vertex);
        let mut along = Vec::with_capacity(path.len());
        for &v in &path {
            along.push(reached + 0.5 * length(v));
            reached += length(v);
        }
        let whole = reached + 0.5 * length(to.vertex);
        let [start, end] = [from, to].map(|corner| self.at(corner));
        for (&v, along) in path.iter().zip(along) {
            self.pieces.hold(v);
            self.positions[v as usize] = start.lerp(end, along / whole);
        }
        !path.is_empty()
    }

    fn at(&self, corner: &Corner) -> DVec2 {
        self.positions[corner.vertex as usize]
    }

    /// Returns the line with the best rating between corners of two different boundaries, of the lines inside the
    /// piece.
    fn between(&self, boundaries: &[Boundary]) -> Option<[Place; 2]> {
        let sampled = |most: usize| -> Vec<Place> {
            let most = most.div_ceil(boundaries.len());
            let of = |b: usize| samples(&boundaries[b], most).map(move |i| (b, i));
            (0..boundaries.len()).flat_map(of).collect()
        };
        let corner = |(b, i): Place| &boundaries[b][i];
        let all = sampled(TRIED);
        let sources = match self.short {
            Short::Line => all.clone(),
            Short::Both | Short::Path | Short::ByChance(_) => sampled(SOURCES),
        };
        // The best line from each source.
        let lines = map_parts(sources, |_, from| {
            let paths = match self.short {
                Short::Line => None,
                Short::Both | Short::Path | Short::ByChance(_) => {
                    Some(self.path_lengths(corner(from)))
                }
            };
            let rated = |&to: &Place| {
                let line = self.at(corner(from)).distance(self.at(corner(to)));
                let rating = match &paths {
                    None => line,
                    Some(paths) => {
                        let path = self.reached(paths, corner(to));
                        // The ratio of the two lengths counts twice.
                        let both = line.max(path).powi(3) / line.min(path).powi(2);
                        match self.short {
                            Short::Path => path,
                            Short::ByChance(trial) => {
                                let ends = [from, to].map(|place| corner(place).vertex);
                                both * CHANCE.powf(chance(trial, ends))
                            }
                            Short::Line | Short::Both => both,
                        }
                    }
                };
                (rating, from, to)
            };
            let others = all.iter().filter(|to| to.0 != from.0).map(rated);
            others.filter(|line| line.0.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))
        });
        let mut lines: Vec<_> = lines.into_iter().flatten().collect();
        lines.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut lines = lines.into_iter().map(|(_, from, to)| [from, to]);
        lines.find(|line| self.is_clear(boundaries, line))
    }

    /// Returns the best line between two corners of the only boundary of a piece. `None` if no chain turns inward by
    /// more than [`INWARD`], or if every short line leaves the piece.
    fn within(&self, boundary: &Boundary) -> Option<[Place; 2]> {
        if self.most_inward(boundary) <= INWARD {
            return None;
        }
        let n = boundary.len();
        let mut reached = vec![0.0; n + 1];
        for i in 0..n {
            let [p, q] = [i, (i + 1) % n].map(|i| self.at(&boundary[i]));
            reached[i + 1] = reached[i] + p.distance(q);
        }
        let mut lines = Vec::new();
        for i in samples(boundary, TRIED_WITHIN) {
            for j in samples(boundary, TRIED_WITHIN).filter(|&j| j > i) {
                let along: f64 = reached[j] - reached[i];
                let cut_off = along.min(reached[n] - along);
                let line = self.at(&boundary[i]).distance(self.at(&boundary[j]));
                if line < SHARE * cut_off {
                    lines.push((line / cut_off, i, j));
                }
            }
        }
        lines.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all = std::slice::from_ref(boundary);
        let mut lines = lines.into_iter().map(|(_, i, j)| [(0, i), (0, j)]);
        lines.find(|line| self.is_clear(all, line))
    }

    /// Returns the largest angle by which a chain of a boundary turns inward, in radians.
    fn most_inward(&self, boundary: &Boundary) -> f64 {
        let n = boundary.len();
        let (mut most, mut inward) = (0.0f64, 0.0f64);
        // Two rounds also measure chains that pass the last corner of the boundary.
        for i in n..3 * n {
            let [a, b, c] = [i - 1, i, i + 1].map(|k| self.at(&boundary[k % n]));
            // At the free end of a line, the piece is on both sides and the boundary turns back.
            let turn = if a == c { -PI } else { (b - a).angle_to(c - b) };
            inward = (inward - turn).max(0.0);
            most = most.max(inward);
        }
        most
    }

    /// Returns whether a line between two corners stays inside the piece.
    fn is_clear(&self, boundaries: &[Boundary], line: &[Place; 2]) -> bool {
        let [p, q] = line.map(|(b, i)| self.at(&boundaries[b][i]));
        let opens = |(b, i): Place, to: DVec2| self.opens(&boundaries[b], i, to);
        let crosses = |a: DVec2, b: DVec2| {
            let is_end = |x: DVec2| x == p || x == q;
            let apart = |[p, q]: [DVec2; 2], [a, b]: [DVec2; 2]| {
                (q - p).perp_dot(a - p) * (q - p).perp_dot(b - p) > 0.0
            };
            !is_end(a) && !is_end(b) && !apart([p, q], [a, b]) && !apart([a, b], [p, q])
        };
        let meets = |boundary: &Boundary| {
            let next = boundary.iter().skip(1).chain(boundary.first());
            boundary.iter().zip(next).any(|(a, b)| crosses(self.at(a), self.at(b)))
        };
        p != q && opens(line[0], q) && opens(line[1], p) && !boundaries.iter().any(meets)
    }

    /// Returns whether the line from corner `i` of a boundary toward `to` begins inside the piece.
    fn opens(&self, boundary: &Boundary, i: usize, to: DVec2) -> bool {
        let n = boundary.len();
        let [a, b, c] = [i + n - 1, i, i + 1].map(|k| self.at(&boundary[k % n]));
        let (before, after, along) = (b - a, c - b, to - b);
        let (left, right) = (before.perp_dot(along) > 0.0, after.perp_dot(along) > 0.0);
        let is_inside = match before.perp_dot(after) >= 0.0 {
            true => left && right,
            false => left || right,
        };
        !boundary[i].inside.is_empty() && (a == c || is_inside)
    }

    /// Estimates the length of the path with the fewest edges from a corner to each free vertex. The length is infinite
    /// for vertices without a path, and for held vertices.
    fn path_lengths(&self, from: &Corner) -> Vec<f64> {
        let step = |v: u32, k: u32| 0.5 * (self.lengths[v as usize] + self.lengths[k as usize]);
        let mut length = vec![f64::INFINITY; self.problem.free_count()];
        let mut queue = from.inside.clone();
        for &v in &queue {
            length[v as usize] = step(from.vertex, v);
        }
        let mut next = 0;
        while let Some(&v) = queue.get(next) {
            next += 1;
            for k in self.pieces.neighbors(v) {
                if length[k as usize] == f64::INFINITY {
                    length[k as usize] = length[v as usize] + step(v, k);
                    queue.push(k);
                }
            }
        }
        length
    }

    /// Returns the length of the path to a corner, from the lengths `paths` to the vertices that are not held.
    fn reached(&self, paths: &[f64], to: &Corner) -> f64 {
        let of = |&v: &u32| paths[v as usize] + 0.5 * self.lengths[v as usize];
        let least = to.inside.iter().map(of).fold(f64::INFINITY, f64::min);
        least + 0.5 * self.lengths[to.vertex as usize]
    }

    /// Counts the edges from each vertex of a piece to the nearest boundary, and resets the costs of paths in the
    /// piece.
    fn measure_depths(&mut self, piece: &[u32]) {
        // The list of the piece repeats a vertex for each of its triangles.
        const UNSEEN: u32 = u32::MAX;
        for v in self.pieces.inside(piece) {
            self.depth[v as usize] = UNSEEN;
        }
        let mut front = Vec::new();
        for v in self.pieces.inside(piece) {
            if self.depth[v as usize] != UNSEEN {
                continue;
            }
            self.cost[v as usize] = u64::MAX;
            let touches = self.problem.ring_of(v).iter().any(|&k| self.pieces.is_held(k));
            self.depth[v as usize] = u32::from(touches);
            if touches {
                front.push(v);
            }
        }
        let mut next = 0;
        while let Some(&v) = front.get(next) {
            next += 1;
            for k in self.pieces.neighbors(v) {
                if self.depth[k as usize] == 0 {
                    self.depth[k as usize] = self.depth[v as usize] + 1;
                    front.push(k);
                }
            }
        }
    }

    /// Returns the cheapest path between two corners of a piece, without its ends; empty if no path exists. Cheap paths
    /// are short and keep away from boundaries: held vertices on both sides distort the triangles between a path and a
    /// boundary.
    fn path(&mut self, from: &Corner, to: &Corner) -> Vec<u32> {
        // An edge at a boundary costs twice as much as an edge at a vertex of depth 4.
        let price = |depth: &[u32], v: u32| 100 + 200 / u64::from(depth[v as usize].max(1));
        let mut heap = BinaryHeap::new();
        let start = u32::MAX;
        for &v in &from.inside {
            self.cost[v as usize] = price(&self.depth, v);
            self.before[v as usize] = start;
            heap.push((Reverse(self.cost[v as usize]), v));
        }
        while let Some((Reverse(cost), v)) = heap.pop() {
            if cost > self.cost[v as usize] {
                continue;
            }
            if to.inside.contains(&v) {
                let follow = |&v: &u32| Some(self.before[v as usize]).filter(|&k| k != start);
                let mut path: Vec<u32> = std::iter::successors(Some(v), follow).collect();
                path.reverse();
                return path;
            }
            for k in self.pieces.neighbors(v) {
                let there = cost + price(&self.depth, k);
                if there < self.cost[k as usize] {
                    self.cost[k as usize] = there;
                    self.before[k as usize] = v;
                    heap.push((Reverse(there), k));
                }
            }
        }
        Vec::new()
    }
}

/// Returns a pseudorandom number from 0 to 1 for a trial and two vertices, by the mixing function of SplitMix64.
fn chance(trial: u32, [from, to]: [u32; 2]) -> f64 {
    let seed = u64::from(trial).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut x = (u64::from(from) << 32 | u64::from(to)) ^ seed;
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Returns the indices of at most `most` corners, evenly spaced along a boundary.
fn samples(boundary: &Boundary, most: usize) -> impl Iterator<Item = usize> + use<> {
    let step = boundary.len().div_ceil(most.max(1)).max(1);
    (0..boundary.len()).step_by(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::prepare;
    use crate::mesh::Mesh;

    /// Returns a mesh of nine rings around a hole, with 48 vertices each.
    fn ring() -> Problem {
        let (around, rings) = (48u32, 9u32);
        let mut mesh = Mesh::default();
        for k in 0..rings * around {
            let angle = std::f64::consts::TAU / f64::from(around) * f64::from(k % around);
            let radius = 1.0 + f64::from(k / around) * 0.2;
            mesh.points.push([radius * angle.cos(), radius * angle.sin()]);
        }
        for k in 0..(rings - 1) * around {
            let right = k / around * around + (k + 1) % around;
            let [a, b] = [k, right];
            mesh.triangles.extend([[a, a + around, b], [b, a + around, b + around]]);
        }
        prepare(&mesh).unwrap().1
    }

    fn areas(problem: &Problem) -> Vec<f64> {
        vec![1.0; problem.positions().len()]
    }

    fn cut_ring(problem: &Problem, short: Short) -> Cuts {
        cut(problem, &areas(problem), problem.positions(), short)
    }

    #[test]
    fn pieces_of_a_ring_have_one_boundary_that_turns_inward_but_little() {
        let problem = ring();
        for short in [Short::Line, Short::Both, Short::Path, Short::ByChance(1)] {
            let cuts = cut_ring(&problem, short);
            let mut cutter = Cutter::new(&problem, &areas(&problem), cuts.positions, short);
            for v in (0..problem.free_count()).filter(|&v| cuts.held[v]) {
                cutter.pieces.hold(v as u32);
            }
            let all = cutter.pieces.all();
            assert!(all.len() >= 4, "{} pieces", all.len());
            for piece in all.iter().filter(|piece| piece.len() > FEWEST) {
                let boundaries = cutter.pieces.boundaries(piece);
                assert_eq!(boundaries.len(), 1);
                assert!(cutter.most_inward(&boundaries[0]) < INWARD + 0.2);
            }
        }
    }

    #[test]
    fn vertices_on_cuts_are_spread_along_straight_lines_and_others_stay() {
        let problem = ring();
        let cuts = cut_ring(&problem, Short::Line);
        let free = problem.free_count();
        let on_cuts: Vec<usize> = (0..free).filter(|&v| cuts.held[v]).collect();
        assert!(on_cuts.len() >= 4 * 7 && on_cuts.len() < free / 3, "{}", on_cuts.len());
        for v in 0..problem.positions().len() {
            let moved = cuts.positions[v] != problem.positions()[v];
            assert!(!moved || on_cuts.contains(&v), "{v}");
        }
        // Every vertex on a cut has two held neighbors in opposite directions.
        let mut straight = 0;
        for &v in &on_cuts {
            let held = problem.ring_of(v as u32).iter().filter(|&&k| cuts.held[k as usize]);
            let away: Vec<DVec2> =
                held.map(|&k| cuts.positions[k as usize] - cuts.positions[v]).collect();
            let opposite = |a: &DVec2, b: &DVec2| {
                a.perp_dot(*b).abs() < 1e-9 * a.length() * b.length() && a.dot(*b) < 0.0
            };
            let has_two = away.iter().any(|a| away.iter().any(|b| opposite(a, b)));
            straight += usize::from(has_two);
        }
        assert_eq!(straight, on_cuts.len());
    }
}
