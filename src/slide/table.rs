//! The sliding vertices of a run as flat lists, for a device.

use std::ops::Range;

use crate::layout::{OPPOSITE, Problem};
use crate::patch::Fan;
pub(crate) use crate::slide::curve::Knot;
use crate::slide::on_curves::OnCurves;
use crate::slide::track::Track;

/// The curves and the sliding vertices of a run, in normalized coordinates and with parameters in the same unit.
#[derive(Debug, Default)]
pub(crate) struct CurveTable {
    /// The knots of each curve, followed by those of the partners' curve.
    pub(crate) knots: Vec<Knot>,
    /// The sliding vertices by color, partners not counted.
    pub(crate) vertices: Vec<SlidingVertex>,
    /// Ranges of `vertices`. Vertices of a color, and their partners, share no triangle and no line, so they can be visited
    /// at the same time.
    pub(crate) colors: Vec<Range<u32>>,
    /// The other two vertices of each corner around a sliding vertex, as of [`Fan::marked_others`].
    pub(crate) corners: Vec<[u32; 2]>,
}

/// A sliding vertex with its partner. Indices of places count all vertices of curves, curve by curve.
#[derive(Clone, Debug)]
pub(crate) struct SlidingVertex {
    /// The vertex in the problem.
    pub(crate) vertex: u32,
    pub(crate) partner: Option<u32>,
    pub(crate) place: u32,
    /// Places of the two neighbors on the curve.
    pub(crate) neighbors: [u32; 2],
    /// Range of the knots of the vertex's own curve.
    pub(crate) knots: Range<u32>,
    pub(crate) is_closed: bool,
    /// Index of the vertex on its curve.
    pub(crate) own: u32,
    /// Ranges of the triangles around the vertex and around its partner.
    pub(crate) corners: [Range<u32>; 2],
    /// Largest distance from the given position; infinite for no bound.
    pub(crate) reach: f64,
}

/// The present place of a vertex on its curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// Curve parameter in the unit of normalized coordinates.
    pub(crate) param: f64,
    /// Index of the vertex on its curve.
    pub(crate) own: u32,
    /// Number of latest sweeps that pressed the vertex against a bound, negative toward smaller parameters.
    pub(crate) presses: i8,
}

impl OnCurves {
    /// Returns the curves and the sliding vertices as flat lists.
    pub(crate) fn table(&self, problem: &Problem) -> CurveTable {
        let mut table = CurveTable::default();
        let mut first_place = 0;
        for (track, reach) in self.sliding().tracks.iter().zip(self.reach()) {
            table.add(track, reach, first_place, problem);
            first_place += track.count() as u32;
        }
        table.color(problem);
        table
    }

    /// Returns the present places of all vertices of curves, in the order of the table's indices.
    pub(crate) fn places(&self, problem: &Problem) -> Vec<Place> {
        let (_, scale) = problem.normalization();
        let of_track = |(params, presses): (&Vec<f64>, &Vec<i8>)| {
            let all = (0..).zip(params).zip(presses);
            let place = |((own, param), &presses)| Place { param: param * scale, own, presses };
            all.map(place).collect::<Vec<_>>()
        };
        self.params().iter().zip(self.presses()).flat_map(of_track).collect()
    }

    /// Returns the state with the vertices at the given places, in the order of [`places`](Self::places).
    pub(crate) fn at_places(&self, problem: &Problem, places: &[Place]) -> Self {
        let (_, scale) = problem.normalization();
        let mut left = places.iter();
        let mut of_count = |count: usize| left.by_ref().take(count).copied().collect::<Vec<_>>();
        let of_tracks: Vec<_> = self.params().iter().map(|of| of_count(of.len())).collect();
        let mut at = self.clone();
        let params = of_tracks.iter().map(|of| of.iter().map(|place| place.param / scale));
        at.set_params(&params.map(Iterator::collect).collect());
        at.set_presses(of_tracks.iter().map(|of| of.iter().map(|place| place.presses).collect()));
        at
    }
}

impl CurveTable {
    fn add(&mut self, track: &Track, reach: &[f64], first_place: u32, problem: &Problem) {
        let (center, scale) = problem.normalization();
        let first_knot = self.knots.len() as u32;
        for side in &track.sides {
            self.knots.extend(side.curve.knots().map(|knot| Knot {
                point: (knot.point - center) * scale,
                param: knot.param * scale,
                slopes: knot.slopes,
                length: knot.length * scale,
                bound: knot.bound * scale,
            }));
        }
        let knots = (self.knots.len() as u32 - first_knot) / track.sides.len() as u32;
        let count = track.count() as u32;
        for k in 0..count {
            let Some(own) = &track.sides[0].fans[k as usize] else { continue };
            let partner = track.sides.get(1).and_then(|side| side.fans[k as usize].as_ref());
            let corners = [self.add_corners(Some(own)), self.add_corners(partner)];
            self.vertices.push(SlidingVertex {
                vertex: own.own(),
                partner: partner.map(Fan::own),
                place: first_place + k,
                neighbors: [(k + count - 1) % count, (k + 1) % count].map(|k| first_place + k),
                knots: first_knot..first_knot + knots,
                is_closed: track.is_closed(),
                own: k,
                corners,
                reach: reach[k as usize] * scale,
            });
        }
    }

    fn add_corners(&mut self, fan: Option<&Fan>) -> Range<u32> {
        let first = self.corners.len() as u32;
        self.corners.extend(fan.into_iter().flat_map(Fan::marked_others));
        first..self.corners.len() as u32
    }

    /// Colors the vertices greedily in their order along the curves, and sorts them by color.
    fn color(&mut self, problem: &Problem) {
        let Self { vertices, corners, colors, .. } = self;
        let mut number = vec![u32::MAX; problem.positions().len()];
        for (i, vertex) in (0..).zip(&*vertices) {
            number[vertex.vertex as usize] = i;
            vertex.partner.into_iter().for_each(|partner| number[partner as usize] = i);
        }
        // Places ascend.
        let at_place =
            |place: &u32| vertices.binary_search_by_key(place, |vertex| vertex.place).ok();
        let mut color_of: Vec<Option<usize>> = vec![None; vertices.len()];
        for (i, vertex) in vertices.iter().enumerate() {
            let around = vertex.corners.iter().cloned().flatten();
            let around = around.flat_map(|corner| corners[corner as usize]);
            let sharing = around.map(|v| number[(v & !OPPOSITE) as usize] as usize);
            let others = sharing.chain(vertex.neighbors.iter().filter_map(at_place));
            let known = others.filter_map(|other| color_of.get(other).copied().flatten());
            let taken: Vec<usize> = known.collect();
            color_of[i] = (0..).find(|color| !taken.contains(color));
        }
        let mut order: Vec<usize> = (0..vertices.len()).collect();
        order.sort_by_key(|&i| color_of[i]);
        let runs = order.chunk_by(|&a, &b| color_of[a] == color_of[b]);
        let mut first = 0;
        for run in runs {
            let end = first + run.len() as u32;
            colors.push(first..end);
            first = end;
        }
        *vertices = order.iter().map(|&i| vertices[i].clone()).collect();
    }
}
