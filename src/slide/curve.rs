//! Curves through the vertices of chains: straight along straight runs, and piecewise cubic elsewhere.

use glam::DVec2;

use crate::slide::chains::Chain;
use crate::slide::options::Slide;

/// The maximum of u (1 - u)² over u from 0 to 1.
const MAX_CUBIC: f64 = 4.0 / 27.0;

/// Number of steps from knot to knot, after which a search bisects the list of knots.
const NEAR: usize = 8;

/// A curve through given vertices, in the unit of the mesh. The parameter at a vertex is the summed length of the lines
/// between the given vertices before. On a closed curve, parameters that differ by the period identify the same point.
///
/// Between two given vertices, the curve is a cubic over the line that joins them. The slope of the cubic at a vertex
/// is the slope of the circle through the vertex and its two neighbors. A factor reduces both slopes of a cubic that
/// would leave its line by more than the bound.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    /// Positions of the given vertices. A closed curve repeats its first vertex at the end.
    knots: Vec<DVec2>,
    /// Parameter of each knot, ascending from 0.
    params: Vec<f64>,
    /// Slopes of each cubic relative to its line, at the start and at the end of the line.
    slopes: Vec<[f64; 2]>,
    /// For each knot, the largest allowed distance from the lines between moved vertices.
    bounds: Vec<f64>,
    is_closed: bool,
}

/// A point of a curve, with its first and second derivative by the parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) point: DVec2,
    pub(crate) first: DVec2,
    pub(crate) second: DVec2,
}

/// A given vertex of a curve, with the piece of the curve that begins at the vertex.
#[cfg(feature = "gpu")]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knot {
    pub(crate) point: DVec2,
    pub(crate) param: f64,
    /// Slopes of the cubic relative to its line, at the start and at the end of the line.
    pub(crate) slopes: [f64; 2],
    /// Length of the line to the next knot; 0 after the last knot.
    pub(crate) length: f64,
    /// Largest allowed distance from the lines between moved vertices.
    pub(crate) bound: f64,
}

/// The bound on the distance of a given vertex from the line between two moved vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    /// The distance as a share of the bound: above 1 where the line breaks the bound.
    pub(crate) used: f64,
    /// Derivatives of `used` by the parameters of both ends.
    pub(crate) slopes: [f64; 2],
}

impl Curve {
    pub(crate) fn new(points: &[[f64; 2]], chain: &Chain, slide: &Slide) -> Self {
        let Chain { vertices, is_closed, straight, .. } = chain;
        let again = is_closed.then_some(&vertices[0]);
        let knots: Vec<DVec2> =
            vertices.iter().chain(again).map(|&v| points[v as usize].into()).collect();
        let lines: Vec<DVec2> = knots.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let pieces = lines.len();
        let mut params = vec![0.0];
        for line in &lines {
            params.push(params[params.len() - 1] + line.length());
        }
        let mut slopes = vec![[None; 2]; pieces];
        for after in 0..pieces {
            let before = match (after, is_closed) {
                (0, false) => continue,
                (0, true) => pieces - 1,
                _ => after - 1,
            };
            let (a, b) = (lines[before], lines[after]);
            let turn = a.perp_dot(b).atan2(a.dot(b));
            // Share of the turn between the line before and the tangent. Next to a straight run, the tangent has the
            // direction of the run.
            let share = match (straight[before], straight[after]) {
                (true, _) => 0.0,
                (false, true) => 1.0,
                (false, false) => a.length() / (a.length() + b.length()),
            };
            slopes[before][1] = Some((turn * share).tan());
            slopes[after][0] = Some((turn * (share - 1.0)).tan());
        }
        let bounded = |(piece, [start, end]): (usize, [Option<f64>; 2])| {
            if straight[piece] {
                return [0.0; 2];
            }
            // At a corner, a piece takes the negative slope of its other end, like an arc of a circle.
            let start = start.or(end.map(|end| -end)).unwrap_or(0.0);
            let end = end.unwrap_or(-start);
            let length = lines[piece].length();
            let height = MAX_CUBIC * length * (start.abs() + end.abs());
            let shorter = (slide.bound(length) / height).min(1.0);
            if height > 0.0 { [start * shorter, end * shorter] } else { [0.0; 2] }
        };
        let slopes: Vec<[f64; 2]> = slopes.into_iter().enumerate().map(bounded).collect();
        let bound = |k: usize| {
            let length = |piece: usize| lines.get(piece).map_or(0.0, |line| line.length());
            let before = if k == 0 { pieces - 1 } else { k - 1 };
            slide.bound(length(before).max(length(k)))
        };
        let bounds = (0..knots.len()).map(bound).collect();
        Self { knots, params, slopes, bounds, is_closed: *is_closed }
    }

    /// Returns the curve through the partners of a chain's vertices, with the parameters of the chain's own curve.
    pub(crate) fn of_partners(
        &self,
        points: &[[f64; 2]],
        chain: &Chain,
        partners: &[u32],
        slide: &Slide,
    ) -> Self {
        let chain = Chain { vertices: partners.to_vec(), image: None, ..chain.clone() };
        Self { params: self.params.clone(), ..Self::new(points, &chain, slide) }
    }

    /// Returns the parameters of the given vertices, without the repeated vertex of a closed curve.
    pub(crate) fn params(&self) -> &[f64] {
        &self.params[..self.params.len() - usize::from(self.is_closed)]
    }

    /// Returns the given vertices with the pieces of the curve after them.
    #[cfg(feature = "gpu")]
    pub(super) fn knots(&self) -> impl Iterator<Item = Knot> + '_ {
        let next = self.params.iter().skip(1).map(Some).chain([None]);
        let pieces = self.slopes.iter().copied().chain([[0.0; 2]]);
        let all = self.knots.iter().zip(&self.params).zip(next).zip(pieces).zip(&self.bounds);
        all.map(|((((&point, &param), next), slopes), &bound)| {
            let length = next.map_or(0.0, |next| next - param);
            Knot { point, param, slopes, length, bound }
        })
    }

    /// Returns the total length of the lines, which is the period of a closed curve.
    pub(crate) fn period(&self) -> f64 {
        self.params[self.params.len() - 1]
    }

    /// Returns the equivalent parameter within the first turn around a closed curve, from 0 to the period.
    fn wrapped(&self, param: f64) -> f64 {
        if self.is_closed { param.rem_euclid(self.period()) } else { param }
    }

    /// Returns the number of knots with parameters up to `param`. The search begins at the knot `near`.
    fn count_up_to(&self, param: f64, near: usize) -> usize {
        let mut count = near.min(self.params.len());
        for _ in 0..NEAR {
            if self.params.get(count).is_some_and(|&next| next <= param) {
                count += 1;
            } else if count > 0 && self.params[count - 1] > param {
                count -= 1;
            } else {
                return count;
            }
        }
        self.params.partition_point(|&knot| knot <= param)
    }

    /// Returns the point at a parameter, with derivatives. The result does not depend on `near`, the index of a knot,
    /// but is found fastest if the knot is near the parameter.
    pub(crate) fn at(&self, param: f64, near: usize) -> Place {
        let param = self.wrapped(param);
        let piece = self.count_up_to(param, near).saturating_sub(1).min(self.slopes.len() - 1);
        let (p, q) = (self.knots[piece], self.knots[piece + 1]);
        let (line, length) = (q - p, self.params[piece + 1] - self.params[piece]);
        let [a, b] = self.slopes[piece];
        let u = ((param - self.params[piece]) / length).clamp(0.0, 1.0);
        let (v, along, across) = (1.0 - u, line / length, line.perp());
        let height = u * v * (v * a - u * b);
        let slope = a * v * (1.0 - 3.0 * u) + b * u * (3.0 * u - 2.0);
        let bend = a * (6.0 * u - 4.0) + b * (6.0 * u - 2.0);
        Place {
            // On a line parallel to an axis, one coordinate stays exactly equal to that of both ends.
            point: p + line * u + across * height,
            first: along + across * (slope / length),
            second: across * (bend / length / length),
        }
    }

    /// Returns the indices of the given vertices strictly between two parameters, each with its parameter. See
    /// [`at`](Self::at) for `near`.
    fn knots_between(
        &self,
        low: f64,
        high: f64,
        near: usize,
    ) -> impl Iterator<Item = (usize, f64)> + '_ {
        let period = if self.is_closed { self.period() } else { 0.0 };
        let turns = if self.is_closed { (low / period).floor() } else { 0.0 };
        let pieces = self.slopes.len();
        let first = self.count_up_to(low - turns * period, near);
        // The last knot of a closed curve is the first knot of the next turn.
        let knot = move |k: usize| match self.is_closed {
            true => (k % pieces, (turns + (k / pieces) as f64) * period + self.params[k % pieces]),
            false => (k, self.params.get(k).copied().unwrap_or(f64::INFINITY)),
        };
        (first..).map(knot).take_while(move |&(_, param)| param < high)
    }

    /// Returns whether the two lines that join the points at `low`, `middle` and `high` pass near all given vertices
    /// between `low` and `high`. For each vertex, `bounds` has the largest allowed distance. See [`at`](Self::at) for
    /// `near`.
    pub(crate) fn is_near(&self, [low, middle, high]: [f64; 3], near: usize) -> bool {
        let [from, over, to] = [low, middle, high].map(|param| self.at(param, near).point);
        self.knots_between(low, high, near).all(|(knot, param)| {
            let ends = if param < middle { [from, over] } else { [over, to] };
            distance(self.knots[knot], ends) <= self.bounds[knot]
        })
    }

    /// Returns the limits of the line between the points at the parameters `low` and `high`. Each given vertex between the
    /// parameters gives a limit. See [`at`](Self::at) for `near`.
    pub(crate) fn limits(
        &self,
        low: f64,
        high: f64,
        near: usize,
    ) -> impl Iterator<Item = Limit> + '_ {
        let [from, to] = [low, high].map(|param| self.at(param, near));
        let line = to.point - from.point;
        let of_knot = move |(knot, _): (usize, f64)| {
            let point = self.knots[knot];
            let share = (point - from.point).dot(line) / line.length_squared();
            let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
            let off = point - (from.point + line * share);
            let (distance, bound) = (off.length(), self.bounds[knot]);
            // The nearest point of the line moves along the line too, which changes the distance in second order alone.
            let toward = if distance > 0.0 { off / distance } else { off };
            let slopes = [(1.0 - share, from.first), (share, to.first)];
            let slopes = slopes.map(|(share, first)| -share * toward.dot(first) / bound);
            Limit { used: distance / bound, slopes }
        };
        self.knots_between(low, high, near).map(of_knot)
    }

    /// Returns the limit that a line uses up most; see [`limits`](Self::limits). `None` without limits.
    pub(crate) fn nearest_limit(&self, low: f64, high: f64, near: usize) -> Option<Limit> {
        self.limits(low, high, near).max_by(|a, b| a.used.total_cmp(&b.used))
    }

    /// Returns whether the line that joins two points of the curve passes near all given vertices between the parameters
    /// `low` and `high` of the points: within the largest allowed distance, plus `tolerance`. See [`at`](Self::at) for
    /// `near`.
    pub(crate) fn is_line_near(
        &self,
        ends: [DVec2; 2],
        [low, high]: [f64; 2],
        near: usize,
        tolerance: f64,
    ) -> bool {
        self.knots_between(low, high, near)
            .all(|(knot, _)| distance(self.knots[knot], ends) <= self.bounds[knot] + tolerance)
    }

    /// Returns the larger of two distances, in the unit of the mesh and as a share of the local edge length. One is the
    /// largest distance of the given vertices between `low` and `high` from the line that joins the points at both
    /// parameters. The other is the distance of the line's start from the line between the two given vertices around
    /// `low`. See [`at`](Self::at) for `near`.
    pub(crate) fn off(&self, low: f64, high: f64, near: usize) -> [f64; 2] {
        let pieces = self.slopes.len();
        let length = |piece: usize| match piece < pieces {
            true => self.params[piece + 1] - self.params[piece],
            false => 0.0,
        };
        // The local edge length of a given vertex is the longer of its two edges, as in the bounds.
        let longer =
            |knot: usize| length(knot.checked_sub(1).unwrap_or(pieces - 1)).max(length(knot));
        let ends = [low, high].map(|param| self.at(param, near).point);
        let of_knot = |(knot, _)| (distance(self.knots[knot], ends), longer(knot));
        let piece = self.count_up_to(self.wrapped(low), near).saturating_sub(1).min(pieces - 1);
        let of_start =
            (distance(ends[0], [self.knots[piece], self.knots[piece + 1]]), length(piece));
        let all = self.knots_between(low, high, near).map(of_knot).chain([of_start]);
        all.fold([0.0; 2], |[far, share], (off, edge)| [off.max(far), share.max(off / edge)])
    }

    /// Returns the parameter of a point on the curve, searching outward from a given vertex. `None` if the point is
    /// farther than `tolerance` from the curve.
    pub(crate) fn find(&self, point: DVec2, vertex: usize, tolerance: f64) -> Option<f64> {
        let pieces = self.slopes.len();
        let steps = if self.is_closed { pieces / 2 + 1 } else { pieces };
        // Pieces in the order of their distance from the given vertex, alternately forward and back.
        let outward = (0..=steps as isize).flat_map(|k| [k, -1 - k]);
        outward.map(|k| vertex as isize + k).find_map(|at| {
            let turns = at.div_euclid(pieces as isize);
            if turns != 0 && !self.is_closed {
                return None;
            }
            let piece = at.rem_euclid(pieces as isize) as usize;
            let (p, length) = (self.knots[piece], self.params[piece + 1] - self.params[piece]);
            let line = self.knots[piece + 1] - p;
            let way = (point - p).dot(line) / line.length_squared() * length;
            let is_within = -tolerance <= way && way <= length + tolerance;
            let param = self.params[piece] + way.clamp(0.0, length);
            let is_there = is_within && self.at(param, piece).point.distance(point) <= tolerance;
            is_there.then(|| param + turns as f64 * self.period())
        })
    }
}

/// Returns the distance of a point from the line segment between two other points.
fn distance(point: DVec2, [from, to]: [DVec2; 2]) -> f64 {
    let line = to - from;
    let share = ((point - from).dot(line) / line.length_squared()).clamp(0.0, 1.0);
    point.distance(from + line * if share.is_nan() { 0.0 } else { share })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns an open curve: a straight run along y = 1, and then an arc of radius 1 around (3, 0).
    fn slot() -> (Curve, Vec<[f64; 2]>) {
        let mut points: Vec<[f64; 2]> = (0..4).map(|k| [f64::from(k), 1.0]).collect();
        points.extend((1..=6).map(|k| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_2 / 6.0).sin_cos();
            [3.0 + sin, cos]
        }));
        let straight = (0..9).map(|piece| piece < 3).collect();
        let chain = Chain { vertices: (0..10).collect(), is_closed: false, straight, image: None };
        (Curve::new(&points, &chain, &Slide::default()), points)
    }

    #[test]
    fn a_curve_goes_through_its_vertices_straight_where_they_are_and_near_the_arc_elsewhere() {
        let (curve, points) = slot();
        for (k, (&param, &point)) in curve.params().iter().zip(&points).enumerate() {
            assert!(curve.at(param, k).point.distance(point.into()) < 1e-15, "{k}");
            assert!((curve.find(point.into(), k, 1e-12).unwrap() - param).abs() < 1e-12, "{k}");
        }
        for k in 0..100 {
            let share = f64::from(k) / 100.0;
            assert_eq!(curve.at(3.0 * share, 0).point.y, 1.0);
            let param = 3.0 + (curve.period() - 3.0) * share;
            let place = curve.at(param, k as usize);
            let radius = place.point.distance(DVec2::new(3.0, 0.0));
            assert!((radius - 1.0).abs() < 2e-4, "{share}: {radius}");
            assert_eq!(curve.find(place.point + DVec2::new(0.1, 0.1), 5, 1e-9), None);
        }
        // The tangent is continuous from the straight run into the arc.
        let [before, after] = [3.0 - 1e-9, 3.0 + 1e-9].map(|at| curve.at(at, 3).first.normalize());
        assert!(before.distance(after) < 1e-7, "{before} {after}");
    }

    #[test]
    fn derivatives_are_those_of_the_point() {
        let (curve, _) = slot();
        let h = 1e-5;
        for param in [0.5, 3.1, 3.2, 4.0, 4.4] {
            let [low, here, high] = [param - h, param, param + h].map(|param| curve.at(param, 9));
            let first = (high.point - low.point) / (2.0 * h);
            let second = (high.first - low.first) / (2.0 * h);
            assert!(first.distance(here.first) < 1e-8, "{param}: {first} {}", here.first);
            assert!(second.distance(here.second) < 1e-8, "{param}: {second} {}", here.second);
        }
    }

    #[test]
    fn vertices_that_would_cut_an_arc_off_are_not_near() {
        let (curve, _) = slot();
        let at = |k: usize| curve.params()[k];
        assert!(curve.is_near([at(0), 1.5, at(3)], 4) && curve.is_near([at(5), at(6), at(7)], 4));
        assert!(curve.is_near([at(4), 0.5 * (at(5) + at(6)), at(7)], 4));
        assert!(
            !curve.is_near([at(4), at(6), at(8)], 4) && !curve.is_near([at(3), at(4), at(9)], 4)
        );
        assert_eq!(curve.off(at(0), at(3), 0), [0.0; 2]);
        let [off, share] = curve.off(at(3), at(9), 3);
        let edge = at(9) - at(8);
        assert!(off > 0.2 && (share * edge - off).abs() < 1e-9, "{off} {share}");
    }

    #[test]
    fn slopes_of_a_limit_are_those_of_the_distance() {
        let (curve, _) = slot();
        let at = |k: usize| curve.params()[k];
        assert!(curve.nearest_limit(at(4), at(5), 4).is_none());
        let (low, high, h) = (at(4) + 0.03, at(7) - 0.1, 1e-6);
        let limit = curve.nearest_limit(low, high, 5).unwrap();
        assert!(limit.used > 1.0 && !curve.is_near([low, high, high + 0.01], 5), "{limit:?}");
        let used = |low, high| curve.nearest_limit(low, high, 5).unwrap().used;
        let differences =
            [used(low + h, high) - used(low - h, high), used(low, high + h) - used(low, high - h)];
        for (slope, difference) in limit.slopes.iter().zip(differences) {
            assert!((slope - difference / (2.0 * h)).abs() < 1e-6, "{limit:?}");
        }
    }

    #[test]
    fn a_closed_curve_goes_on_after_a_turn() {
        let at = |k: usize| {
            let (sin, cos) = (k as f64 * std::f64::consts::TAU / 12.0).sin_cos();
            [cos, sin]
        };
        let points: Vec<[f64; 2]> = (0..12).map(at).collect();
        let straight = vec![false; 12];
        let chain = Chain { vertices: (0..12).collect(), is_closed: true, straight, image: None };
        let curve = Curve::new(&points, &chain, &Slide::default());
        let edge = curve.period() / 12.0;
        for param in [-0.3, 0.2, 5.0] {
            let turned = curve.at(param + curve.period(), 0).point;
            assert!(curve.at(param, 6).point.distance(turned) < 1e-12);
            assert!((turned.length() - 1.0).abs() < 1e-3);
        }
        // First across the first vertex, and then too far across it.
        assert!(curve.is_near([-0.5 * edge, 0.1 * edge, 0.6 * edge], 4));
        assert!(!curve.is_near([-3.5 * edge, -3.0 * edge, 3.0 * edge], 4));
        let before = curve.at(-0.25 * edge, 0).point;
        assert!((curve.find(before, 0, 1e-12).unwrap() + 0.25 * edge).abs() < 1e-9);
    }
}
