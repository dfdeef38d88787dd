//! The stages of an untangling, one after the other.

use std::borrow::Cow;
use std::ops::ControlFlow;

use glam::DVec2;

use super::distant::{brought_back, distant_vertices};
use super::judge::{Judge, Judgment};
use super::newton::{Newton, next_epsilon};
use super::result::{Untangled, Untangling};
use super::stages::{DESCENTS, Descent, NEWTON, STAGES, Stage, Start};
use super::state::{Region, State};
use crate::error::{BadTriangle, MeshError};
use crate::layout::{Coloring, Problem, target_areas};
use crate::mesh::Mesh;
use crate::parallel::pace::now;
use crate::plane::Storage;
use crate::run::multilevel::Hierarchy;
use crate::run::regularization::epsilon;
use crate::topology::predicates::{is_positive, not_positive};
use crate::topology::{Topology, overlapping_star};

/// Share of bad triangles (0 to 1) above which all vertices move from the start.
const MANY: f64 = 0.05;

/// Regularization of the first period of Newton steps, in units of the target area (Garanzha et al., section 2.3).
const FIRST_EPSILON: f64 = 1.0;
/// Regularization at which Newton steps end.
const LAST_EPSILON: f64 = 1e-4;
/// Largest number of Newton steps in a period.
const STEPS_PER_PERIOD: u32 = 300;
/// Relative decrease of the energy by a step, below which a period ends.
const MIN_GAIN: f64 = 1e-5;

/// Largest number of results of cuts that are kept for [`Start::Nearest`].
const ENDS: usize = 3;

/// Untangles a mesh, as [`Untangle`](super::Untangle) describes.
pub(super) fn untangled(
    mesh: &Mesh,
    stored: Storage<'_>,
    observe: &mut dyn FnMut(&Untangling) -> ControlFlow<()>,
) -> Result<Untangled, MeshError> {
    let topology = Topology::by_area(mesh)?;
    let distant = distant_vertices(mesh, &topology);
    let start = match distant.is_empty() {
        true => Cow::Borrowed(mesh),
        false => Cow::Owned(brought_back(mesh, &topology, &distant)),
    };
    let problem = Problem::new(&start, &topology, &Coloring::new(&topology));
    let judge = Judge { mesh: &start, topology: &topology, problem: &problem, stored };
    let (mut before, exactly_bad) = judge.bad_corners(&mesh.points);
    // Double precision cannot judge triangles of distant vertices. Exact predicates suffice, as the vertices move anyway.
    before.retain(|bad| {
        let is_distant = |v: &u32| distant.binary_search(v).is_ok();
        !bad.vertices.iter().any(is_distant) || !is_positive(&mesh.points, &bad.vertices)
    });
    if !before.is_empty()
        && let Some(element) = topology.closed_part()
    {
        return Err(MeshError::Closed { element });
    }
    let is_hopeless = |bad: &BadTriangle| {
        let [p, q, r] =
            bad.vertices.map(|v| (!topology.free()[v as usize], mesh.points[v as usize]));
        let coincide = |(a, b): ((bool, [f64; 2]), (bool, [f64; 2]))| a.0 && a == b;
        !bad.vertices.iter().any(|&v| topology.free()[v as usize])
            || [(p, q), (q, r), (r, p)].into_iter().any(coincide)
    };
    let hopeless: Vec<BadTriangle> = before.iter().copied().filter(is_hopeless).collect();
    let mut result = Untangled {
        points: mesh.points.clone(),
        bad_before: before.len(),
        left: before.clone(),
        hopeless,
        left_quadrilaterals: Vec::new(),
        hopeless_quadrilaterals: Vec::new(),
        overlapping: None,
        sweeps: 0,
        moved: 0,
    };
    if result.left.is_empty() {
        let (corners, free) = (topology.corner_list(), topology.free());
        result.overlapping =
            overlapping_star(&mesh.points, corners, free).map(|(vertex, _)| vertex);
    }
    if result.left.len() == result.hopeless.len() && result.overlapping.is_none() {
        return Ok(result.separated(&topology, &mesh.points));
    }
    let mut work = Work::new(judge, &distant, exactly_bad == 0);
    if distant.is_empty() || !work.is_done(&mut result) {
        work.run(&mut result, observe);
    }
    let differs = |(now, was): &(&[f64; 2], &[f64; 2])| now != was;
    result.moved = result.points.iter().zip(&mesh.points).filter(differs).count();
    Ok(result.separated(&topology, &mesh.points))
}

struct Work<'m> {
    judge: Judge<'m>,
    /// Whether exact predicates find the given mesh valid. A valid mesh is replaced only by valid results.
    was_valid: bool,
    problem: &'m Problem,
    state: State<'m>,
    /// Coarser levels of all free vertices. `None` until [`Start::Means`] builds the levels.
    levels: Option<Hierarchy>,
    /// Held vertices of each cut so far, as one flag for each vertex. A cut with the held vertices of an earlier cut is
    /// skipped.
    tried: Vec<Vec<bool>>,
    /// Results of stages after cuts: [`Assessment::inverted_area`](super::state::Assessment::inverted_area) and the positions, in ascending order
    /// of the former. At most [`ENDS`] results are kept.
    ends: Vec<(f64, Vec<DVec2>)>,
}

impl<'m> Work<'m> {
    fn new(judge: Judge<'m>, distant: &[u32], was_valid: bool) -> Self {
        let problem = judge.problem;
        let mut positions = problem.positions().to_vec();
        // The areas of triangles around vertices that were brought back tell no size.
        for (position, v) in positions.iter_mut().zip(problem.vertices()) {
            if distant.binary_search(v).is_ok() {
                *position = DVec2::NAN;
            }
        }
        let targets = target_areas(problem, &positions);
        let state = State::new(problem, targets);
        let (levels, tried, ends) = (None, Vec::new(), Vec::new());
        Self { judge, was_valid, problem, state, levels, tried, ends }
    }

    /// Judges the present positions, and stores the points in `result` if fewer triangles are bad than before. Returns
    /// true if only hopeless triangles of `result` are bad, and no triangles wind twice around a vertex.
    fn is_done(&self, result: &mut Untangled) -> bool {
        let Judgment { points, left, exactly_bad, overlapping } =
            self.judge.judged(&self.state.positions);
        let separates = result.overlapping.is_some() && overlapping.is_none();
        let is_better = left.len() < result.left.len() || left.is_empty() && separates;
        if is_better && !(self.was_valid && exactly_bad > 0) {
            result.points = points;
            result.left = left;
            result.overlapping = overlapping;
        }
        result.left.len() == result.hopeless.len() && result.overlapping.is_none()
    }

    fn run(
        &mut self,
        result: &mut Untangled,
        observe: &mut dyn FnMut(&Untangling) -> ControlFlow<()>,
    ) {
        for stage in &STAGES {
            let Some(region) = self.begin(&stage.start, result) else { continue };
            let has_moved = !matches!(stage.start, Start::Near(_));
            if has_moved && self.is_done(result) {
                return;
            }
            if self.sweep(stage, &region, result, observe).is_break() {
                return;
            }
        }
        let Judge { mesh, topology, .. } = self.judge;
        // If edges between fixed vertices cross, no positions are feasible, and the steps would take minutes in vain.
        if topology.crossings(&mesh.points, 1).is_ok_and(|crossings| !crossings.is_empty()) {
            return;
        }
        for descent in &DESCENTS {
            let own = descent.has_equal_targets.then(|| self.state.equalize_targets());
            let ended = self.descend(descent, result, observe);
            if let Some(targets) = own {
                self.state.set_targets(targets);
            }
            if ended.is_break() {
                return;
            }
        }
    }

    /// Moves the vertices to the start of a stage, and returns the region that the stage sweeps. Returns `None` to skip
    /// the stage.
    fn begin(&mut self, start: &Start, result: &Untangled) -> Option<Region> {
        match *start {
            Start::Near(rings) => {
                let share = result.left.len() as f64 / self.problem.corners().all().len() as f64;
                // If sweeps have not lowered the number of bad triangles, sweeps over more rings are not tried.
                let in_vain = result.sweeps > 0 && result.left.len() == result.bad_before;
                let is_useful = share <= MANY && !in_vain;
                return is_useful.then(|| Region::around(self.problem, &self.bad(), rings));
            }
            Start::Means => {
                let nobody = vec![false; self.problem.free_count()];
                let levels = self.levels.take().unwrap_or_else(|| self.state.hierarchy(&nobody));
                self.state.make_harmonic(&levels, &nobody);
                self.levels = Some(levels);
            }
            // Cuts go along edges of triangles.
            Start::Cut(_) if self.problem.has_quadrilaterals() => return None,
            Start::Cut(short) => {
                let held = self.state.cut(short);
                // Without holes, all rules find equal cuts, or none.
                if self.tried.contains(&held) {
                    return None;
                }
                // Levels of the free vertices that are not held find the means in a fifth of the iterations.
                self.state.make_harmonic(&self.state.hierarchy(&held), &held);
                self.tried.push(held);
            }
            Start::Nearest if self.ends.is_empty() => return None,
            Start::Nearest => self.state.positions = self.ends.remove(0).1,
        }
        Some(Region::whole(self.problem))
    }

    /// Moves all free vertices from the given positions by Newton steps, while the regularization falls from period to
    /// period. Breaks if only hopeless triangles are bad, or if `observe` breaks.
    fn descend(
        &mut self,
        descent: &Descent,
        result: &mut Untangled,
        observe: &mut dyn FnMut(&Untangling) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let region = Region::whole(self.problem);
        self.state.positions = self.problem.positions().to_vec();
        let mut now = self.state.assess(&region);
        let began = result.sweeps;
        let mut judged = (began, now);
        let mut epsilon = FIRST_EPSILON;
        while result.sweeps - began < NEWTON.most && epsilon > LAST_EPSILON {
            if result.sweeps - judged.0 >= NEWTON.often {
                let before = std::mem::replace(&mut judged, (result.sweeps, now)).1;
                if !NEWTON.goes_on(before, now) {
                    break;
                }
            }
            let mut search = Newton::new(&region, epsilon, descent.residual, &self.state);
            let first = search.energy();
            for _ in 0..STEPS_PER_PERIOD {
                let last = search.energy();
                if !search.step(&mut self.state) {
                    break;
                }
                result.sweeps += 1;
                now = self.state.assess(&region);
                if now.bad <= result.hopeless.len() && self.is_done(result) {
                    return ControlFlow::Break(());
                }
                if observe(&result.progress(now.bad)).is_break() {
                    self.is_done(result);
                    return ControlFlow::Break(());
                }
                if last - search.energy() <= MIN_GAIN * last {
                    break;
                }
            }
            epsilon = next_epsilon(epsilon, now.least, [first, search.energy()]);
        }
        match self.is_done(result) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// Sweeps the region until the stage ends. Breaks if only hopeless triangles are bad, or if `observe` breaks.
    fn sweep(
        &mut self,
        stage: &Stage,
        region: &Region,
        result: &mut Untangled,
        observe: &mut dyn FnMut(&Untangling) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let patience = stage.patience();
        let mut now = self.state.assess(region);
        let mut before = None;
        for sweep in 0..patience.most {
            if sweep % patience.often == 0 {
                let goes_on =
                    before.replace(now).is_none_or(|before| patience.goes_on(before, now));
                if sweep >= patience.fewest && !goes_on {
                    break;
                }
            }
            let epsilon = epsilon(now.least);
            self.state.sweep(region, epsilon);
            if !matches!(stage.start, Start::Near(_))
                && let Some(levels) = &self.levels
            {
                self.state.global_step(region, levels, epsilon);
            }
            result.sweeps += 1;
            now = self.state.assess(region);
            // The exact judgment takes a pass over the whole mesh, so sweeps first wait for a good count in double
            // precision.
            if now.bad <= result.hopeless.len() && self.is_done(result) {
                return ControlFlow::Break(());
            }
            if observe(&result.progress(now.bad)).is_break() {
                self.is_done(result);
                return ControlFlow::Break(());
            }
        }
        if self.is_done(result) {
            return ControlFlow::Break(());
        }
        if matches!(stage.start, Start::Cut(_)) {
            self.ends.push((now.inverted_area(), self.state.positions.clone()));
            self.ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            self.ends.truncate(ENDS);
        }
        ControlFlow::Continue(())
    }

    /// Returns the triangles of the problem that are inverted or flat, either exactly or in double precision.
    fn bad(&self) -> Vec<u32> {
        let positions = &self.state.positions;
        let points: Vec<[f64; 2]> = positions.iter().map(|p| p.to_array()).collect();
        let mut bad = now(not_positive(&points, self.problem.corners().all()));
        bad.extend(now(self.problem.beyond_precision(positions)));
        bad
    }
}
