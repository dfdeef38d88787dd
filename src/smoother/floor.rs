//! The floor under the worst elements: a run with default options leaves no smaller angle and no larger inverse mean
//! ratio than the mesh before the run had, among the elements that can move and in the coordinates as stored.

use glam::DVec2;

use crate::error::MeshError;
use crate::layout::Problem;
use crate::options::{Options, WorstBy};
use crate::outcome::Floored;
use crate::parallel::paced;
use crate::patch::FourTriangles;
use crate::patch::instructions::with_instructions;
use crate::slide::OnCurves;
use crate::whole::altitude::{self, Limits};
use crate::worst::{Penalties, WorstShapes};

use super::prepared::Smoother;
use super::rounds::{Aim, Movable, PlacedCorner, Present};

/// Number of triangles that one task measures.
const CHUNK: usize = 1 << 12;

/// The floor under the triangles of a run that ended with a worse triangle than the mesh before the run had.
pub(super) struct Floor<'s> {
    movable: Movable<'s>,
    /// Worst shapes before the run and after its sweeps.
    worst: [WorstShapes; 2],
}

/// The rounds that raise worst shapes to an aim.
struct ToShapes {
    aim: WorstShapes,
    penalties: Penalties,
}

impl Aim for ToShapes {
    /// Most meshes need one to three.
    const ROUNDS: u32 = 20;
    const RINGS: u32 = 2;

    fn penalties(&self, round: u32) -> Penalties {
        self.penalties.in_round(round)
    }

    fn is_beyond(&self, corner: PlacedCorner<'_>) -> bool {
        !corner.shapes().is_within(self.penalties.limits())
    }

    fn heavy(&self, _: &Movable<'_>, _: &[[f64; 2]]) -> Vec<[u32; 3]> {
        Vec::new()
    }

    fn demands_more(&self, corner: PlacedCorner<'_>) -> bool {
        !corner.shapes().is_within(self.aim)
    }
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
        // Equilateral triangles on the sphere are targets too, as their sizes differ in the projection.
        let is_usual_on_sphere = self.problem.is_projected() && !self.problem.is_stretched();
        let has_targets = self.problem.targets().is_some() && !is_usual_on_sphere;
        if !is_usual || has_targets || self.field.is_some() {
            return None;
        }
        let movable = Movable::new(self);
        let worst = movable.worst_shapes([&self.mesh.points, points]).await;
        (!worst[1].is_within(worst[0])).then_some(Floor { worst, movable })
    }
}

impl Movable<'_> {
    /// Returns the worst shapes of the corners that can move, for each of some lists of points.
    pub(super) async fn worst_shapes<const LISTS: usize>(
        &self,
        lists: [&[[f64; 2]]; LISTS],
    ) -> [WorstShapes; LISTS] {
        let none = [WorstShapes::NONE; LISTS];
        let both = |a: [WorstShapes; LISTS], b: &[WorstShapes; LISTS]| {
            std::array::from_fn(|k| a[k].and(b[k]))
        };
        let corners = self.smoother.topology.corner_list();
        let of_triangles = |_, part: &[[u32; 3]]| {
            let alone = |triangles| lists.map(|points| self.worst_of(points, triangles, false));
            with_instructions!(simd => {
                let (fours, rest) = part.as_chunks();
                let mut worst = alone(rest);
                for four in fours {
                    for (worst, points) in worst.iter_mut().zip(lists) {
                        match FourTriangles::of(simd, self.surface, points, four) {
                            Some(usual) => worst.add_four(&usual, |k| self.can_move(&four[k])),
                            None => *worst = worst.and(self.worst_of(points, four, false)),
                        }
                    }
                }
                worst
            }, alone => alone(part))
        };
        let parts = paced::map_parts(corners.triangles().chunks(CHUNK), of_triangles).await;
        let worst = parts.iter().fold(none, both);
        let of_quadrilaterals =
            |_, part: &[[u32; 3]]| lists.map(|points| self.worst_of(points, part, true));
        let parts = corners.of_quadrilaterals().chunks(CHUNK);
        paced::map_parts(parts, of_quadrilaterals).await.iter().fold(worst, both)
    }

    /// Returns the worst shapes of some corners, without the corners that cannot move. `is_right` tells whether the corners are of
    /// quadrilaterals.
    fn worst_of(&self, points: &[[f64; 2]], corners: &[[u32; 3]], is_right: bool) -> WorstShapes {
        let moving = corners.iter().filter(|t| self.can_move(t));
        let shapes = moving.map(|t| WorstShapes::of(self.surface, points, t, is_right));
        shapes.fold(WorstShapes::NONE, WorstShapes::and)
    }
}

impl Floor<'_> {
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
        let before = &self.movable.smoother.mesh.points;
        let swept = points.to_vec();
        let aim = self.aim(options);
        let rounds = ToShapes { aim, penalties: Penalties::new(aim) };
        let present = Present { problem, curves, positions, points };
        self.movable.descend(&rounds, options, present, goes_on).await;
        self.bring_back(options, points).await?;
        let bits = |point: [f64; 2]| point.map(f64::to_bits);
        let (mut moved, mut returned) = (0, 0);
        for ((&to, from), before) in points.iter().zip(swept).zip(before) {
            if bits(to) != bits(from) {
                *if bits(to) == bits(*before) { &mut returned } else { &mut moved } += 1;
            }
        }
        let [after] = self.movable.worst_shapes([points]).await;
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

    /// Sets the vertices of triangles that are worse than the worst before the run back to their places in the mesh, until
    /// no triangle is worse, inverted, or too flat for the options.
    async fn bring_back(
        &self,
        options: &Options,
        points: &mut [[f64; 2]],
    ) -> Result<(), MeshError> {
        let smoother = self.movable.smoother;
        let Smoother { mesh, topology, .. } = smoother;
        let is_worse = |corner: PlacedCorner<'_>| !corner.shapes().is_within(self.worst[0]);
        let before = &mesh.points;
        loop {
            let mut worse = self.movable.chosen(points, is_worse).await;
            while !worse.is_empty() {
                let mut touched = Vec::new();
                for &v in worse.iter().flat_map(|&t| &topology.corners()[t as usize]) {
                    let (point, before) = (&mut points[v as usize], before[v as usize]);
                    if point.map(f64::to_bits) != before.map(f64::to_bits) {
                        *point = before;
                        touched.extend(topology.corners_with(v));
                    }
                }
                touched.sort_unstable();
                touched.dedup();
                touched.retain(|&c| self.movable.placed(points, c).is_some_and(is_worse));
                worse = touched;
            }
            let mut more = smoother.certified(points, Some(smoother.storage(options))).await?;
            if options.keep_altitude {
                more += altitude::restore(topology, before, points, Limits::ALTITUDE);
            }
            if more == 0 {
                return Ok(());
            }
        }
    }
}
