//! The sliding vertices of a mesh.

use crate::layout::Problem;
use crate::patch::Fan;
use crate::slide::chains::{Chain, Chains};
use crate::slide::newton::Window;
use crate::slide::options::Slide;
use crate::slide::params::Params;
use crate::slide::side::BoundaryCurve;
use crate::slide::track::Track;
use crate::topology::Topology;

/// All curves of a mesh on which vertices slide, alone or in pairs.
#[derive(Clone, Debug)]
pub(crate) struct Sliding {
    pub(super) tracks: Vec<Track>,
    /// Number of pairs that stay because the motion of the other pairs does not fit them.
    unlike: usize,
    /// Number of vertices of curves that have the position of another vertex.
    coincident: usize,
}

impl Sliding {
    /// Finds the curves of a mesh with its vertices at `points`.
    pub(crate) fn new(points: &[[f64; 2]], topology: &Topology<'_>, slide: &Slide) -> Self {
        let Chains { all, unlike, coincident } = Chains::of(points, topology, slide);
        let track = |chain: Chain| Track {
            is_coincident: chain.image.as_ref().is_some_and(|image| image.is_coincident),
            sides: BoundaryCurve::of(points, topology, slide, chain),
        };
        Self { tracks: all.into_iter().map(track).collect(), unlike, coincident }
    }

    /// Replaces vertex indices in the mesh by indices in the problem. The mesh has `vertices` vertices.
    pub(crate) fn numbered(mut self, problem: &Problem, vertices: usize) -> Self {
        let number = problem.numbers(vertices);
        let sides = self.tracks.iter_mut().flat_map(|track| &mut track.sides);
        for fan in sides.flat_map(|side| &mut side.fans).flatten() {
            fan.renumber(&number);
        }
        self
    }

    /// Returns the number of sliding vertices, partners included.
    pub(crate) fn count(&self) -> usize {
        let sides = self.tracks.iter().flat_map(|track| &track.sides);
        sides.flat_map(|side| &side.fans).flatten().count()
    }

    /// Returns the sliding vertices as indices in the problem, in ascending order.
    pub(crate) fn vertices(&self) -> Vec<u32> {
        let sides = self.tracks.iter().flat_map(|track| &track.sides);
        let fans = sides.flat_map(|side| &side.fans).flatten();
        let mut vertices: Vec<u32> = fans.map(Fan::own).collect();
        vertices.sort_unstable();
        vertices
    }

    /// Returns the number of periodic pairs that slide, and the number of pairs that stay because the common motion does not
    /// fit them.
    pub(crate) fn pairs(&self) -> [usize; 2] {
        [self.sliding_pairs(false), self.unlike]
    }

    /// Returns the number of pairs of vertices at the same place that slide together, and the number of other vertices of
    /// curves at the place of another vertex, which stay.
    pub(crate) fn coincident(&self) -> [usize; 2] {
        let pairs = self.sliding_pairs(true);
        [pairs, self.coincident - 2 * pairs]
    }

    fn sliding_pairs(&self, are_coincident: bool) -> usize {
        let tracks = self.tracks.iter().filter(|track| track.is_coincident == are_coincident);
        let second = tracks.flat_map(|track| track.sides.get(1));
        second.flat_map(|side| &side.fans).flatten().count()
    }

    /// Returns the curve parameters of the given positions.
    pub(crate) fn start(&self) -> Params {
        self.tracks.iter().map(|track| track.start().to_vec()).collect()
    }

    /// Replaces the parameters of vertices that have their given positions. `before` has the given positions and `points`
    /// the present ones, in the order of the mesh.
    pub(crate) fn with_returned(
        &self,
        params: &Params,
        before: &[[f64; 2]],
        points: &[[f64; 2]],
    ) -> Params {
        let of_track = |(track, params): (&Track, &Vec<f64>)| {
            let is_back = |k: usize| {
                let v = track.sides[0].vertices[k] as usize;
                points[v] == before[v]
            };
            let param = |k: usize| if is_back(k) { track.start()[k] } else { params[k] };
            (0..params.len()).map(param).collect()
        };
        self.tracks.iter().zip(params).map(of_track).collect()
    }

    /// Returns the vertices whose parameter differs from the given one: index in the mesh, and position in the unit of
    /// the mesh.
    pub(crate) fn moved(&self, params: &Params) -> Vec<(u32, [f64; 2])> {
        let of_side = |(side, params): (&BoundaryCurve, &[f64])| {
            let all = side.vertices.iter().zip(params).zip(side.curve.params()).enumerate();
            let moved = all.filter(|(_, ((_, now), was))| now != was);
            let there = |(k, ((&v, &now), _))| (v, side.curve.at(now, k).point.into());
            moved.map(there).collect::<Vec<_>>()
        };
        self.sides(params).flat_map(of_side).collect()
    }

    /// Iterates over all curves, partner curves included, with the parameters of their vertices.
    fn sides<'a>(
        &'a self,
        params: &'a Params,
    ) -> impl Iterator<Item = (&'a BoundaryCurve, &'a [f64])> {
        let all = self.tracks.iter().zip(params);
        all.flat_map(|(track, params)| track.sides.iter().map(move |side| (side, &params[..])))
    }

    /// Evaluates `of` for the vertices of all curves, given their indices in the mesh. For partners, the smaller of the
    /// two values is returned.
    pub(crate) fn for_each_vertex(&self, of: impl Fn(u32) -> f64) -> Params {
        let least = |track: &Track, k: usize| {
            let all = track.sides.iter().map(|side| of(side.vertices[k]));
            all.fold(f64::INFINITY, f64::min)
        };
        let of_track = |track: &Track| (0..track.count()).map(|k| least(track, k)).collect();
        self.tracks.iter().map(of_track).collect()
    }

    /// Returns whether every sliding vertex is strictly between its neighbors on the curve, and every other vertex at
    /// its given parameter.
    pub(crate) fn is_in_order(&self, params: &Params) -> bool {
        self.tracks.iter().zip(params).all(|(track, params)| {
            let is_in_order = |k: usize| match track.slides(k) {
                true => {
                    let Window { low, at, high } = track.window(params, k);
                    low < at && at < high
                }
                false => params[k] == track.start()[k],
            };
            (0..track.count()).all(is_in_order)
        })
    }

    /// Returns the largest distance between the lines through the vertices at `params` and the lines through the given
    /// positions, in the unit of the mesh and as a share of the local edge length.
    pub(crate) fn off(&self, params: &Params) -> [f64; 2] {
        let larger = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.max(c), b.max(d)];
        let of_track = |(track, params): (&Track, &Vec<f64>)| {
            let edges = (0..params.len()).filter(|&k| track.slides(k) || k == 0);
            let next = |k| track.neighbor(k, 1, |i| params.get(i).copied());
            let off = |low: f64, high: f64, k: usize| {
                track.sides.iter().map(|side| side.curve.off(low, high, k)).fold([0.0; 2], larger)
            };
            let offs = edges.filter_map(|k| next(k).map(|next| off(params[k], next, k)));
            offs.fold([0.0; 2], larger)
        };
        self.tracks.iter().zip(params).map(of_track).fold([0.0; 2], larger)
    }
}
