//! Facts about a mesh and a run that a user should know. Front ends write the words.

use gpu_smooth::layers::{KeepLayers, Layers};
use gpu_smooth::targets::{Adaptation, Surface};
use gpu_smooth::{Guard, MeshError, Metric, Scheme, Topology};

use crate::target::TargetKind;

/// Stretching above which a mesh counts as adapted. Averages of meshes that are merely poor stay below 2.
const STRETCHED: f64 = 2.5;
/// Gradation above which a mesh counts as graded. Sizes then change by up to a third of themselves in a run without
/// targets.
const GRADED: f64 = 4.0;

/// Relative rise of the worst inverse mean ratio in a run above which the rise is a fact.
const RISE: f64 = 0.01;
/// Relative change of a worst value above which the value counts as improved.
const IMPROVED: f64 = 1e-3;
/// Relative change of f from which the change is a fact.
const COST: f64 = 5e-5;

/// Latitude in degrees above which a degree of longitude is shorter than a degree of latitude by more than 6 %.
const LATITUDE: f64 = 20.0;

/// Number of vertices of a wall from which the wall has a layer, and from which seeds without a layer are a fact.
const FEW: usize = 3;
const MANY: usize = 8;

/// An adapted mesh, which a run without targets makes less adapted; see [`Adaptation`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Adapted {
    /// Triangles are stretched by this factor or more around one vertex in twenty. [`TargetKind::KeepShape`] keeps their
    /// stretching and sizes.
    Stretched(f64),
    /// Sizes differ by this factor from fine to coarse parts. [`TargetKind::KeepSize`] keeps the sizes.
    Graded(f64),
}

impl Adapted {
    /// Measures a mesh before a run by the base metric `metric` with targets of a kind. Returns `None` if the mesh is not
    /// adapted, if the run has targets, or if the metric is one of sizes, which is chosen to make sizes even.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn before_run(
        topology: &Topology<'_>,
        points: &[[f64; 2]],
        surface: Surface,
        kind: TargetKind,
        metric: Metric,
    ) -> Result<Option<Self>, MeshError> {
        if kind != TargetKind::Equilateral || !metric.is_scale_invariant() {
            return Ok(None);
        }
        let Adaptation { stretching, gradation, .. } = Adaptation::of(topology, points, surface)?;
        Ok(match stretching > STRETCHED {
            true => Some(Self::Stretched(stretching)),
            false => (gradation > GRADED).then_some(Self::Graded(gradation)),
        })
    }
}

/// A rise of the worst inverse mean ratio of the triangles with a free vertex in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct WorstRise {
    /// The worst inverse mean ratio before and after the run.
    pub worst: [f64; 2],
    /// The reason for which the run did not prevent the rise.
    pub reason: RiseReason,
}

/// The reason for which a run did not prevent that the worst triangle became worse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RiseReason {
    /// No metric of the scheme judges shapes.
    JudgesNoShape,
    /// f is a mean, which may fall as one triangle gets worse. [`Guard::Worst`] prevents the rise.
    IsMean,
    /// [`Guard::Worst`] bounds triangles as the target transforms them.
    GuardsTargets,
    /// [`Guard::Worst`] bounds triangles before their coordinates are rounded.
    GuardsUnrounded,
}

impl WorstRise {
    /// Returns the rise in a run by a scheme; `None` if the worst inverse mean ratio, before and after the run, rose by 1 % at
    /// most.
    pub fn of(worst: [f64; 2], scheme: &Scheme, guard: Guard, has_target: bool) -> Option<Self> {
        let [before, after] = worst;
        if after <= (1.0 + RISE) * before {
            return None;
        }
        let judges_shape = scheme.metrics().iter().any(|metric| metric.has_barrier());
        let reason = match (judges_shape, guard, has_target) {
            (false, ..) => RiseReason::JudgesNoShape,
            (true, Guard::Worst, true) => RiseReason::GuardsTargets,
            (true, Guard::Worst, false) => RiseReason::GuardsUnrounded,
            (true, ..) => RiseReason::IsMean,
        };
        Some(Self { worst, reason })
    }
}

/// The effect of improving the worst triangles; see [`Options::improve_worst`](gpu_smooth::Options::improve_worst).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorstEffect {
    /// No vertex moved.
    Nothing,
    /// The worst value of all movable triangles is better.
    Worst,
    /// Only triangles with better values than the worst one were improved.
    Others,
}

impl WorstEffect {
    /// Returns the effect of the move of a number of vertices, with the worst value before and after.
    pub fn of(vertices: usize, [before, after]: [f64; 2]) -> Self {
        match vertices {
            0 => Self::Nothing,
            _ if (after / before - 1.0).abs() > IMPROVED => Self::Worst,
            _ => Self::Others,
        }
    }
}

/// Returns the change of f, in percent; `None` if the change is below 0.005 %.
pub fn cost_in_percent([before, after]: [f64; 2]) -> Option<f64> {
    let change = after / before - 1.0;
    (change.abs() >= COST).then_some(100.0 * change)
}

/// Returns whether points seem to be longitudes and latitudes in degrees. Meshes of models of oceans and coasts do if their
/// mean latitude is above 20°, all other meshes if all latitudes are above 20° north, or
/// all are above 20° south.
pub fn look_like_degrees(points: &[[f64; 2]], is_of_oceans: bool) -> bool {
    let fits = |&[x, y]: &[f64; 2]| {
        let is_far = || y.abs() > LATITUDE && y.signum() == points[0][1].signum();
        x.abs() <= 360.0 && y.abs() < 90.0 && (is_of_oceans || is_far())
    };
    let middle = || points.iter().map(|p| p[1]).sum::<f64>() / points.len() as f64;
    points.iter().all(fits) && middle().abs() > LATITUDE
}

/// Returns the number of vertices in the rows of layers, without those on walls.
pub fn vertices_in_rows(layers: &Layers) -> usize {
    let is_in = |of: &[u32], v: &u32| of.binary_search(v).is_ok();
    let is_inner = |v: &&u32| !is_in(&layers.walls, v) && !is_in(&layers.sides, v);
    layers.vertices.iter().filter(is_inner).count()
}

/// Returns whether a layer is at the wall with the given vertices.
pub fn is_at_wall(layers: &Layers, wall: &[u32]) -> bool {
    common(wall, &layers.walls) >= FEW
}

/// Returns whether layers may begin at half of the vertices of a wall, and none was found there. False if `keep` does not find
/// layers by itself.
pub fn overlooks_wall(layers: &Layers, keep: KeepLayers, wall: &[u32]) -> bool {
    if keep != KeepLayers::Auto || layers.seeds.len() < MANY {
        return false;
    }
    let seeds = common(wall, &layers.seeds);
    seeds >= MANY && 2 * seeds >= wall.len() && !is_at_wall(layers, wall)
}

/// Returns whether [`overlooks_wall`] holds for a loop of the boundary.
pub fn overlooks_boundary(layers: &Layers, keep: KeepLayers, topology: &Topology<'_>) -> bool {
    // Loops are found only for the few meshes with seeds.
    let has_seeds = keep == KeepLayers::Auto && layers.seeds.len() >= MANY;
    has_seeds && topology.boundary_loops().iter().any(|wall| overlooks_wall(layers, keep, wall))
}

/// Returns the number of entries of `vertices` that the ascending list `of` has.
fn common(vertices: &[u32], of: &[u32]) -> usize {
    vertices.iter().filter(|v| of.binary_search(v).is_ok()).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_of_the_worst_triangle_has_the_reason_that_a_remedy_needs() {
        let of = |worst, scheme: &str, guard, has_target| {
            let rise = WorstRise::of(worst, &scheme.parse().unwrap(), guard, has_target);
            rise.map(|rise| rise.reason)
        };
        let by = Guard::ByMetric;
        assert_eq!(of([2.0, 2.02], "imr", by, false), None);
        assert_eq!(of([2.0, 2.03], "imr", by, false), Some(RiseReason::IsMean));
        assert_eq!(of([2.0, 3.0], "area", by, true), Some(RiseReason::JudgesNoShape));
        assert_eq!(of([2.0, 3.0], "area+imr", by, true), Some(RiseReason::IsMean));
        assert_eq!(of([2.0, 3.0], "imr", Guard::Worst, true), Some(RiseReason::GuardsTargets));
        assert_eq!(of([2.0, 3.0], "imr", Guard::Worst, false), Some(RiseReason::GuardsUnrounded));
        assert_eq!(of([f64::INFINITY, 3.0], "imr", by, false), None);
    }

    #[test]
    fn improved_worst_triangles_are_told_from_others() {
        assert_eq!(WorstEffect::of(0, [2.0, 1.0]), WorstEffect::Nothing);
        assert_eq!(WorstEffect::of(3, [2.0, 1.9]), WorstEffect::Worst);
        assert_eq!(WorstEffect::of(3, [2.0, 1.999]), WorstEffect::Others);
        assert_eq!(cost_in_percent([1.0, 1.000_04]), None);
        assert!(cost_in_percent([1.0, 0.98]).is_some_and(|cost| (cost + 2.0).abs() < 1e-9));
    }

    #[test]
    fn points_look_like_degrees_far_from_the_equator_alone() {
        let at = |latitude: f64| vec![[-75.0, latitude - 15.0], [-60.0, latitude + 15.0]];
        assert!(look_like_degrees(&at(40.0), true) && look_like_degrees(&at(-40.0), false));
        assert!(look_like_degrees(&at(30.0), true) && !look_like_degrees(&at(30.0), false));
        assert!(!look_like_degrees(&at(10.0), true) && !look_like_degrees(&at(80.0), true));
    }
}
