//! The floor under the worst triangles: a run with default options leaves no smaller angle and no larger inverse mean
//! ratio than the mesh before the run had, among the triangles that can move and in the coordinates as stored.

use std::borrow::Cow;
use std::collections::HashSet;

use glam::DVec2;

use crate::error::MeshError;
use crate::layout::Problem;
use crate::options::{Options, WorstBy};
use crate::outcome::Floored;
use crate::parallel::paced;
use crate::run::Plan;
use crate::slide::{OnCurves, Sliding};
use crate::targets::Surface;
use crate::whole::altitude;
use crate::worst::{Badness, MoveConstraints, Penalties, WorstShapes, floor};

use super::prepared::Smoother;

/// Number of triangles that one task measures.
const CHUNK: usize = 1 << 12;
/// Largest number of rounds of Newton steps. Most meshes need one to three.
const ROUNDS: u32 = 20;
/// Largest number of visits in all rounds: a constant, and a multiple of the number of free vertices. On a regular mesh,
/// every triangle may be as bad as the worst. The limits keep the time of the rounds below that of the run.
const MAX_VISITS: [usize; 2] = [20_000, 4];

/// The floor under the triangles of a run that ended with a worse triangle than the mesh before the run had.
pub(super) struct Floor<'s> {
    smoother: &'s Smoother<'s>,
    surface: Surface,
    /// Whether each vertex of the mesh may move: is free or slides.
    may_move: Cow<'s, [bool]>,
    /// Worst shapes before the run and after its sweeps.
    worst: [WorstShapes; 2],
}

impl Smoother<'_> {
    /// Returns the floor that a run with these options lacks at `points`, its result as stored. `None` if no shape is
    /// worse than before the run, or if an option has named another aim: a metric, a method, a goal, a guard, targets, or
    /// larger altitudes of the worst triangles.
    pub(super) async fn lacking_floor(
        &self,
        options: &Options,
        points: &[[f64; 2]],
    ) -> Option<Floor<'_>> {
        let usual = Options::default();
        let is_usual = options.scheme == usual.scheme
            && options.method == usual.method
            && options.guard == usual.guard
            && options.improve_worst != Some(WorstBy::Altitude)
            && options.stopping.goal().is_none();
        if !is_usual || self.problem.targets().is_some() || self.field.is_some() {
            return None;
        }
        let is_on_sphere = self.problem.is_projected();
        let surface = if is_on_sphere { Surface::Sphere } else { Surface::Plane };
        let mut may_move = Cow::Borrowed(self.topology.free());
        for v in self.sliding.as_deref().map(Sliding::vertices).unwrap_or_default() {
            may_move.to_mut()[self.problem.vertices()[v as usize] as usize] = true;
        }
        let worst = [WorstShapes::NONE; 2];
        let floor = Floor { smoother: self, surface, may_move, worst };
        let worst = floor.worst_shapes([&self.mesh.points, points]).await;
        (!worst[1].is_within(worst[0])).then_some(Floor { worst, ..floor })
    }
}

impl Floor<'_> {
    fn can_move(&self, triangle: &[u32; 3]) -> bool {
        triangle.iter().any(|&v| self.may_move[v as usize])
    }

    /// Returns the worst shapes of the triangles that can move, for each of two lists of points.
    async fn worst_shapes(&self, lists: [&[[f64; 2]]; 2]) -> [WorstShapes; 2] {
        let add = |worst: [WorstShapes; 2], t: &[u32; 3]| {
            let of = |k: usize| worst[k].and(WorstShapes::of(self.surface, lists[k], t));
            [of(0), of(1)]
        };
        let both = |a: [WorstShapes; 2], b: &[WorstShapes; 2]| [a[0].and(b[0]), a[1].and(b[1])];
        let of_part = |_, triangles: &[[u32; 3]]| {
            triangles.iter().filter(|t| self.can_move(t)).fold([WorstShapes::NONE; 2], add)
        };
        let parts = self.smoother.topology.triangles().chunks(CHUNK);
        let parts = paced::map_parts(parts, of_part).await;
        parts.iter().fold([WorstShapes::NONE; 2], both)
    }

    /// Returns whether a triangle that can move is beyond `limits`, given its index in the mesh.
    fn is_beyond(&self, limits: WorstShapes, points: &[[f64; 2]], triangle: u32) -> bool {
        let corners = &self.smoother.topology.triangles()[triangle as usize];
        self.can_move(corners) && !WorstShapes::of(self.surface, points, corners).is_within(limits)
    }

    /// Returns the triangles beyond `limits` that can move, ascending.
    async fn all_beyond(&self, limits: WorstShapes, points: &[[f64; 2]]) -> Vec<u32> {
        let count = self.smoother.topology.triangles().len();
        let beyond = paced::map_ranges(count, CHUNK, |range| -> Vec<u32> {
            let all = range.start as u32..range.end as u32;
            all.filter(|&t| self.is_beyond(limits, points, t)).collect()
        });
        beyond.await.concat()
    }

    /// Raises the worst shapes to those before the run. Free vertices, and vertices that slide on `curves`, around triangles beyond them take Newton steps by
    /// penalties, from `positions`, which are those of `points`, in rounds until no shape is worse, `goes_on` returns
    /// false, or the largest number of visits is reached. Then the vertices of triangles that are still worse go back to
    /// their places in the mesh.
    #[allow(clippy::too_many_arguments)]
    pub(super) async fn raise(
        &self,
        options: &Options,
        problem: &Problem,
        curves: Option<&mut OnCurves>,
        positions: &[DVec2],
        points: &mut [[f64; 2]],
        goes_on: impl FnMut() -> bool,
    ) -> Result<Floored, MeshError> {
        let before = &self.smoother.mesh.points;
        let swept = points.to_vec();
        let rules = MoveConstraints {
            badness: Badness(WorstBy::Imr),
            step: Plan::new(options).base_step(1.0),
            shape: f64::INFINITY,
            floor: if options.keep_altitude { altitude::least_of(problem) } else { 0.0 },
            bounds: problem.radii(),
        };
        self.descend(options, problem, &rules, curves, positions, points, goes_on).await;
        self.bring_back(options, points).await?;
        let bits = |point: [f64; 2]| point.map(f64::to_bits);
        let (mut moved, mut returned) = (0, 0);
        for ((&to, from), before) in points.iter().zip(swept).zip(before) {
            if bits(to) != bits(from) {
                *if bits(to) == bits(*before) { &mut returned } else { &mut moved } += 1;
            }
        }
        let [_, after] = self.worst_shapes([before, points]).await;
        let [first, last] = self.worst;
        let worst = [first, last, after];
        Ok(Floored {
            moved,
            returned,
            least_angle: worst.map(WorstShapes::least_angle),
            worst_imr: worst.map(|worst| worst.imr),
            f: [0.0; 2],
        })
    }

    /// Returns the worst shapes that the rounds aim at: those before the run. A measure that was improved stays as good as it
    /// has become.
    fn aim(&self, options: &Options) -> WorstShapes {
        let [before, swept] = self.worst;
        match options.improve_worst {
            Some(WorstBy::Imr) => WorstShapes { imr: before.imr.min(swept.imr), ..before },
            Some(WorstBy::MinAngle) => {
                WorstShapes { cotangent: before.cotangent.min(swept.cotangent), ..before }
            }
            _ => before,
        }
    }

    /// Does the rounds of [`raise`](Self::raise).
    #[allow(clippy::too_many_arguments)]
    async fn descend(
        &self,
        options: &Options,
        problem: &Problem,
        rules: &MoveConstraints<'_>,
        mut curves: Option<&mut OnCurves>,
        positions: &[DVec2],
        points: &mut [[f64; 2]],
        mut goes_on: impl FnMut() -> bool,
    ) {
        let topology = &self.smoother.topology;
        let aim = self.aim(options);
        let penalties = Penalties::new(aim);
        let number = problem.numbers(points.len());
        let mut positions = paced::copied(positions).await;
        let mut beyond = self.all_beyond(penalties.limits(), points).await;
        let [least, share] = MAX_VISITS;
        let mut visits = least.max(share * problem.free_count());
        for round in 0..ROUNDS {
            let corners = beyond.iter().flat_map(|&t| topology.triangles()[t as usize]);
            let regions = floor::regions(problem, corners.map(|v| number[v as usize]));
            let in_round = regions.iter().map(Vec::len).sum::<usize>() * floor::VISITS as usize;
            if in_round > visits || !goes_on() {
                return;
            }
            visits -= in_round;
            let penalties = penalties.in_round(round);
            let mut near = HashSet::new();
            if curves.is_some() {
                let seeds = beyond.iter().flat_map(|&t| topology.triangles()[t as usize]);
                near.extend(seeds.map(|v| number[v as usize]));
                near.extend(regions.iter().flatten().flat_map(|&v| problem.ring_of(v)));
            }
            let moves = floor::round(problem, rules, penalties, &positions, regions).await;
            for (v, to) in moves {
                positions[v as usize] = to;
                let at = problem.vertices()[v as usize];
                points[at as usize] = problem.point(to).map(|x| options.stored.rounded(x));
                beyond.extend_from_slice(topology.star(at));
            }
            let slid = curves.as_mut().map(|curves| {
                curves.visit_by(&penalties, problem, &mut positions, |v| near.contains(&v))
            });
            for (at, point) in slid.into_iter().flatten() {
                points[at as usize] = point.map(|x| options.stored.rounded(x));
                beyond.extend_from_slice(topology.star(at));
            }
            beyond.sort_unstable();
            beyond.dedup();
            beyond.retain(|&t| self.is_beyond(penalties.limits(), points, t));
            if !beyond.iter().any(|&t| self.is_beyond(aim, points, t)) {
                return;
            }
        }
    }

    /// Sets the vertices of triangles that are worse than the worst before the run back to their places in the mesh, until
    /// no triangle is worse, inverted, or too flat for the options.
    async fn bring_back(
        &self,
        options: &Options,
        points: &mut [[f64; 2]],
    ) -> Result<(), MeshError> {
        let Smoother { mesh, topology, .. } = self.smoother;
        let before = &mesh.points;
        loop {
            let mut worse = self.all_beyond(self.worst[0], points).await;
            while !worse.is_empty() {
                let mut touched = Vec::new();
                for &v in worse.iter().flat_map(|&t| &topology.triangles()[t as usize]) {
                    let (point, before) = (&mut points[v as usize], before[v as usize]);
                    if point.map(f64::to_bits) != before.map(f64::to_bits) {
                        *point = before;
                        touched.extend_from_slice(topology.star(v));
                    }
                }
                touched.sort_unstable();
                touched.dedup();
                touched.retain(|&t| self.is_beyond(self.worst[0], points, t));
                worse = touched;
            }
            let mut more = self.smoother.certified(points, Some(options.stored)).await?;
            if options.keep_altitude {
                more += altitude::restore(topology, before, points, f64::INFINITY);
            }
            if more == 0 {
                return Ok(());
            }
        }
    }
}
