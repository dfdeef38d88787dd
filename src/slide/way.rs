//! Moves of all vertices of a curve at once, shortened where they would break a bound.

use crate::slide::curve::Limit;
use crate::slide::newton::Window;
use crate::slide::side::BoundaryCurve;
use crate::slide::track::Track;

/// Share of a bound that a shortened move leaves unused, so that rounding cannot exceed the bound.
const UNUSED: f64 = 1e-9;
/// Number of passes over a curve in which the ends of edges go back to their bounds, each by a step of Newton's method. One
/// pass mends most edges, and the next passes their neighbors.
const PASSES: u32 = 20;
/// Number of passes in which a vertex that would pass a neighbor goes back half of its way, before it returns.
const HALVINGS: u32 = 5;

impl Track {
    /// Shortens the moves of vertices from the parameters `from`, which keep all bounds, to `to`: no vertex passes a neighbor,
    /// all edges stay within their distance from the given vertices, and all vertices within `reach`. Both ends of an edge
    /// that breaks its bound go back together.
    pub(super) fn shorten(&self, from: &[f64], to: &mut [f64], reach: &[f64]) {
        for k in (0..to.len()).filter(|&k| self.slides(k)) {
            self.bring_in_reach(from, to, reach, k);
        }
        for pass in 0..=HALVINGS {
            self.keep_order(from, to, pass == HALVINGS);
        }
        for _ in 0..PASSES {
            if !self.go_back(to) {
                break;
            }
        }
        // A vertex that returns may put an edge out of its bound again, until both ends have returned.
        while self.return_ends(from, to, reach) {}
    }

    /// Moves vertex `k` back toward `from` until the vertex is in reach of its given position.
    fn bring_in_reach(&self, from: &[f64], to: &mut [f64], reach: &[f64], k: usize) {
        let reach = self.reach(reach, k);
        let is_in_reach =
            |param: f64| self.sides.iter().all(|side| reach.allows(&side.curve, param));
        if reach.most.is_infinite() || is_in_reach(to[k]) {
            return;
        }
        let (mut inside, mut outside) = (from[k], to[k]);
        for _ in 0..PASSES {
            let middle = 0.5 * (inside + outside);
            *(if is_in_reach(middle) { &mut inside } else { &mut outside }) = middle;
        }
        to[k] = inside;
    }

    /// Moves vertices that would pass a neighbor back by half of their way, or by their whole way if `whole`.
    fn keep_order(&self, from: &[f64], to: &mut [f64], whole: bool) {
        let is_out = |to: &[f64], k: usize| {
            let Window { low, at, high } = self.window(to, k);
            !(low < at && at < high)
        };
        loop {
            let out: Vec<usize> = (0..to.len())
                .filter(|&k| self.slides(k) && to[k] != from[k] && is_out(to, k))
                .collect();
            for &k in &out {
                to[k] = if whole { from[k] } else { 0.5 * (from[k] + to[k]) };
            }
            if out.is_empty() || !whole {
                return;
            }
        }
    }

    /// Returns the index of the end of each edge, and its parameter with the vertices at `params`, for the edge that begins
    /// at vertex `k`. `None` after the last vertex of an open curve.
    pub(super) fn edge(&self, params: &[f64], k: usize) -> Option<(usize, f64)> {
        if k > 0 && !self.slides(k) {
            return None;
        }
        let high = self.neighbor(k, 1, |i| params.get(i).copied())?;
        Some(((k + 1) % params.len(), high))
    }

    /// Returns the limit that an edge uses up most, on any side.
    pub(super) fn limit(&self, low: f64, high: f64, k: usize) -> Option<Limit> {
        let limits = self
            .sides
            .iter()
            .filter_map(|side: &BoundaryCurve| side.curve.nearest_limit(low, high, k));
        limits.max_by(|a, b| a.used.total_cmp(&b.used))
    }

    /// Moves both ends of each edge that breaks its bound back to the bound, by a step of Newton's method along the slopes of
    /// the limit. Returns whether an edge broke its bound.
    fn go_back(&self, params: &mut [f64]) -> bool {
        let mut breaks = false;
        for k in 0..params.len() {
            let Some((next, high)) = self.edge(params, k) else { continue };
            let Some(Limit { used, slopes }) = self.limit(params[k], high, k) else { continue };
            if used <= 1.0 {
                continue;
            }
            breaks = true;
            let slope = |k: usize, slope: f64| if self.slides(k) { slope } else { 0.0 };
            let slopes = [slope(k, slopes[0]), slope(next, slopes[1])];
            let sum = slopes[0] * slopes[0] + slopes[1] * slopes[1];
            if sum > 0.0 {
                let back = (used - 1.0 + UNUSED) / sum;
                params[k] -= back * slopes[0];
                params[next] -= back * slopes[1];
            }
        }
        breaks
    }

    /// Returns moved ends of edges that break a bound or the order to their parameters in `from`. Returns whether a vertex
    /// has returned.
    fn return_ends(&self, from: &[f64], to: &mut [f64], reach: &[f64]) -> bool {
        let is_sound = |to: &[f64], k: usize, high: f64| {
            let is_near = self.limit(to[k], high, k).is_none_or(|limit| limit.used <= 1.0);
            to[k] < high && is_near
        };
        let is_in_reach = |to: &[f64], k: usize| {
            let reach = self.reach(reach, k);
            self.sides.iter().all(|side| reach.allows(&side.curve, to[k]))
        };
        let mut bad = Vec::new();
        for k in 0..to.len() {
            match self.edge(to, k) {
                Some((next, high)) if !is_sound(to, k, high) => bad.extend([k, next]),
                _ if self.slides(k) && !is_in_reach(to, k) => bad.push(k),
                _ => {}
            }
        }
        bad.retain(|&k| to[k] != from[k]);
        bad.iter().for_each(|&k| to[k] = from[k]);
        !bad.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slide::chains::Chain;
    use crate::slide::curve::Curve;
    use crate::slide::options::Slide;

    /// Returns a curve of 60 jagged edges, closed or open, without triangles.
    fn jagged(is_closed: bool) -> Track {
        let at = |k: u32| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 60.0).sin_cos();
            let radius = 10.0 + [0.0, 0.4, -0.3, 0.1, 0.5][k as usize % 5];
            [radius * cos, radius * sin]
        };
        let points: Vec<[f64; 2]> = (0..60).map(at).collect();
        let edges = if is_closed { 60 } else { 59 };
        let straight = vec![false; edges];
        let chain = Chain { vertices: (0..60).collect(), is_closed, straight, image: None };
        let curve = Curve::new(&points, &chain, &Slide::default());
        Track { sides: vec![BoundaryCurve::without_triangles(curve, chain)], is_coincident: false }
    }

    /// Returns whether a track with its vertices at `params` keeps all bounds.
    fn keeps_bounds(track: &Track, params: &[f64], reach: &[f64]) -> bool {
        (0..params.len()).all(|k| {
            let is_in_reach = track.reach(reach, k).allows(&track.sides[0].curve, params[k]);
            let Some((_, high)) = track.edge(params, k) else { return is_in_reach };
            let is_near = track.limit(params[k], high, k).is_none_or(|limit| limit.used <= 1.0);
            is_in_reach && is_near && params[k] < high
        })
    }

    #[test]
    fn shortened_moves_keep_all_bounds_and_allowed_moves_stay() {
        let mut state = 7_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        for is_closed in [false, true] {
            let track = jagged(is_closed);
            let start = track.start().to_vec();
            let (mut far, mut kept) = (0.0_f64, 0);
            for (size, most) in
                [(0.02, f64::INFINITY), (0.5, f64::INFINITY), (3.0, f64::INFINITY), (0.5, 0.1)]
            {
                let mut from = start.clone();
                let reach = vec![most; 60];
                for _ in 0..50 {
                    let mut to = from.clone();
                    (0..60).filter(|&k| track.slides(k)).for_each(|k| to[k] += size * random());
                    let wanted = to.clone();
                    let is_allowed = keeps_bounds(&track, &to, &reach);
                    track.shorten(&from, &mut to, &reach);
                    assert!(keeps_bounds(&track, &to, &reach), "{is_closed} {size} {most}");
                    assert!(!is_allowed || to == wanted);
                    kept += usize::from(is_allowed);
                    let ends = [0, 59].map(|k| !track.slides(k) && to[k] != start[k]);
                    assert_eq!(ends, [false; 2]);
                    far = (0..60).map(|k| (to[k] - from[k]).abs()).fold(far, f64::max);
                    from = to;
                }
            }
            assert!(far > 0.1 && kept > 10, "{far} {kept}");
        }
    }
}
