//! Untangling: moving free vertices until no triangle is inverted or flat.
//!
//! Sweeps of Newton steps lower an `energy` that is finite for inverted triangles too. At first only vertices near bad
//! triangles move, then more. If that does not do it, the free vertices are put at the means of their neighbors, and each
//! sweep is followed by a step from coarser levels. Then the mesh is cut (`cuts`) into pieces in which means are a good start.

mod cuts;
pub(crate) mod energy;
mod judge;
mod patches;
mod pieces;
mod stages;
mod state;

use std::ops::ControlFlow;

use glam::DVec2;

use crate::error::{BadTriangle, MeshError};
use crate::layout::{Coloring, Problem, target_areas};
use crate::mesh::Mesh;
use crate::precision::Precision;
use crate::run::multilevel::Hierarchy;
use crate::run::regularization::epsilon;
use crate::topology::Topology;
use crate::topology::predicates::not_positive;
use judge::{Judge, Judgment};
use stages::{STAGES, Stage, Start};
use state::{Region, State};

/// If more than this share of the triangles are bad, all vertices move from the start.
const MANY: f64 = 0.05;

/// The number of ends of stages that are kept to go on from.
const ENDS: usize = 3;

/// The progress of [`untangle`], for a display.
#[derive(Clone, Copy, Debug)]
pub struct Untangling {
    /// Number of sweeps done.
    pub sweep: u32,
    /// Number of triangles that are inverted or flat.
    pub bad: usize,
}

/// The result of [`untangle`].
#[derive(Clone, Debug)]
pub struct Untangled {
    /// Position of every vertex, in the mesh's order and units. Vertices that are not free are where they were.
    pub points: Vec<[f64; 2]>,
    /// Number of triangles that were inverted or flat, or so flat that double precision cannot judge them.
    pub bad_before: usize,
    /// The triangles that still are, in ascending order, by exact predicates on the values of `points`. None if the mesh is
    /// untangled. Those that double precision cannot judge ([`Smoother::beyond_precision`](crate::Smoother::beyond_precision))
    /// are listed as flat if one of their vertices is free.
    pub left: Vec<BadTriangle>,
    /// Those of `left` that no move can mend, as none of their vertices is free.
    pub hopeless: Vec<BadTriangle>,
    /// A vertex around which triangles wind more than once though none is inverted, if there is one.
    pub overlapping: Option<u32>,
    /// Number of sweeps done.
    pub sweeps: u32,
    /// Number of vertices that are not where they were.
    pub moved: usize,
}

/// Moves free vertices until no triangle is inverted or flat, if that can be done: connectivity, boundary and fixed
/// vertices stay. Triangles so flat that double precision cannot judge them are opened as well. Only vertices near bad triangles move unless that is not enough. On the CPU.
///
/// Windings are made consistent across edges, and such that the area that the boundary of each part encloses is positive.
/// `stored` is the precision in which the points will be stored: they are rounded to it and then judged. `observe` is called
/// after each sweep and can end the work; what is reached by then is returned.
///
/// The energy and its regularization are those of Garanzha et al., *Foldover-free maps in 50 lines of code*, ACM
/// Transactions on Graphics 40 (2021). There is no proof that every mesh that can be untangled is.
///
/// # Errors
/// [`MeshError`] if the mesh cannot be read as one of the plane; see [`Topology::by_area`]. [`MeshError::Closed`] if a part of
/// it has no boundary. Triangles that stay inverted are no error: [`Untangled::left`] lists them.
pub fn untangle(
    mesh: &Mesh,
    stored: Precision,
    observe: &mut dyn FnMut(&Untangling) -> ControlFlow<()>,
) -> Result<Untangled, MeshError> {
    let topology = Topology::by_area(mesh)?;
    let problem = Problem::new(mesh, &topology, &Coloring::new(&topology));
    let judge = Judge { mesh, topology: &topology, problem: &problem, stored };
    let before = judge.bad_triangles(&mesh.points);
    if !before.is_empty()
        && let Some(triangle) = topology.closed_part()
    {
        return Err(MeshError::Closed { triangle });
    }
    let is_hopeless = |bad: &BadTriangle| !topology.can_move(bad.triangle);
    let hopeless: Vec<BadTriangle> = before.iter().copied().filter(is_hopeless).collect();
    let mut result = Untangled {
        points: mesh.points.clone(),
        bad_before: before.len(),
        left: before.clone(),
        hopeless,
        overlapping: None,
        sweeps: 0,
        moved: 0,
    };
    if result.left.len() == result.hopeless.len() {
        return Ok(result);
    }
    Work::new(judge).run(&mut result, observe);
    let differs = |(now, was): &(&[f64; 2], &[f64; 2])| now != was;
    result.moved = result.points.iter().zip(&mesh.points).filter(differs).count();
    Ok(result)
}

struct Work<'m> {
    judge: Judge<'m>,
    problem: &'m Problem,
    state: State<'m>,
    /// The coarser levels of all free vertices, once they are needed.
    levels: Option<Hierarchy>,
    /// The vertices held by each cut so far.
    tried: Vec<Vec<bool>>,
    /// Positions at the ends of stages after cuts, and how far they were from the goal; the nearest first.
    ends: Vec<(f64, Vec<DVec2>)>,
}

impl<'m> Work<'m> {
    fn new(judge: Judge<'m>) -> Self {
        let problem = judge.problem;
        let targets = target_areas(problem, problem.positions());
        let state = State::new(problem, targets);
        Self { judge, problem, state, levels: None, tried: Vec::new(), ends: Vec::new() }
    }

    /// Takes the positions into the result if fewer triangles are bad than there. Returns whether none is left that could be
    /// mended.
    fn is_done(&self, result: &mut Untangled) -> bool {
        let Judgment { points, left, overlapping } = self.judge.judged(&self.state.positions);
        let separates = result.overlapping.is_some() && overlapping.is_none();
        if left.len() < result.left.len() || left.is_empty() && separates {
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
    }

    /// Brings the vertices where a stage starts. Returns those that it moves; `None` if there is no reason for the stage.
    fn begin(&mut self, start: &Start, result: &Untangled) -> Option<Region> {
        match *start {
            Start::Near(rings) => {
                let share = result.left.len() as f64 / self.problem.triangles().len() as f64;
                // Sweeps that have left no fewer bad triangles are not worth going on with.
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
            Start::Cut(short) => {
                let held = self.state.cut(short);
                // Without holes all rules find the same cuts, or none.
                if self.tried.contains(&held) {
                    return None;
                }
                // The levels of the others alone find the means in a fifth of the iterations.
                self.state.make_harmonic(&self.state.hierarchy(&held), &held);
                self.tried.push(held);
            }
            Start::Nearest if self.ends.is_empty() => return None,
            Start::Nearest => self.state.positions = self.ends.remove(0).1,
        }
        Some(Region::whole(self.problem))
    }

    /// Sweeps until the stage ends. Breaks if nothing is left to do, or if `observe` wants so.
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
            // The exact judgment takes a pass over the whole mesh.
            if now.bad <= result.hopeless.len() && self.is_done(result) {
                return ControlFlow::Break(());
            }
            if observe(&Untangling { sweep: result.sweeps, bad: now.bad }).is_break() {
                self.is_done(result);
                return ControlFlow::Break(());
            }
        }
        if self.is_done(result) {
            return ControlFlow::Break(());
        }
        if matches!(stage.start, Start::Cut(_)) {
            self.ends.push((now.far(), self.state.positions.clone()));
            self.ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            self.ends.truncate(ENDS);
        }
        ControlFlow::Continue(())
    }

    /// The triangles of the problem that are inverted or flat, or so by rounding.
    fn bad(&self) -> Vec<u32> {
        let positions = &self.state.positions;
        let points: Vec<[f64; 2]> = positions.iter().map(|p| p.to_array()).collect();
        let mut bad = not_positive(&points, self.problem.triangles());
        bad.extend(self.problem.beyond_precision(positions));
        bad
    }
}
