//! Untangling: moving free vertices until no triangle is inverted or flat.
//!
//! Sweeps of Newton steps lower an [`energy`] that is finite for inverted triangles too. At first only vertices near bad
//! triangles move, then more. If that does not do it, the free vertices are put at the means of their neighbors, and each
//! sweep is followed by a step from coarser levels. Then the mesh is [cut](cuts) into pieces in which means are a good start.

mod cuts;
pub(crate) mod energy;
mod patches;
mod pieces;
mod state;

use std::collections::HashSet;
use std::ops::ControlFlow;

use crate::error::{BadTriangle, MeshError};
use crate::layout::{Coloring, Problem, target_areas};
use crate::mesh::Mesh;
use crate::precision::Precision;
use crate::run::regularization::epsilon;
use crate::topology::Topology;
use crate::topology::overlapping_star;
use crate::topology::predicates::{bad_triangles, not_positive};
use cuts::Short;
use state::{Assessment, Region, State};

/// What is done in turn until the mesh is untangled. Cuts by each rule untangle some meshes that the other rules do not.
const STAGES: [Stage; 15] = [
    Stage { start: Start::Near(2), sweeps: 10 },
    Stage { start: Start::Near(6), sweeps: 20 },
    Stage { start: Start::Means, sweeps: 10 },
    Stage { start: Start::Cut(Short::Line), sweeps: 50 },
    Stage { start: Start::Cut(Short::Both), sweeps: 100 },
    Stage { start: Start::Cut(Short::Path), sweeps: 150 },
    Stage { start: Start::Cut(Short::ByChance(1)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(2)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(3)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(4)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(5)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(6)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(7)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(8)), sweeps: 100 },
    Stage { start: Start::Means, sweeps: 100 },
];

/// After a cut, sweeps go on beyond those of the stage while the least area comes this much nearer to 0 in so many of them.
const GOES_ON: (u32, f64) = (50, 0.5);
/// The most sweeps after a cut, in units of those of the stage.
const LONGEST: u32 = 4;

/// If more than this share of the triangles are bad, all vertices move from the start.
const MANY: f64 = 0.05;

struct Stage {
    start: Start,
    /// The number of sweeps after which the next stage begins. After a cut it is a multiple of those of [`GOES_ON`].
    sweeps: u32,
}

/// Where vertices are when a stage begins, and which of them move.
enum Start {
    /// Those move that are within so many edges of bad triangles, from where they are.
    Near(u32),
    /// All move, from the means of their neighbors.
    Means,
    /// The same, from their means within the pieces into which the mesh is [cut](cuts).
    Cut(Short),
}

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
    let mut work = Work { mesh, topology: &topology, problem: &problem, stored };
    let before = work.bad_triangles(&mesh.points);
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
    work.run(&mut result, observe);
    let differs = |(now, was): &(&[f64; 2], &[f64; 2])| now != was;
    result.moved = result.points.iter().zip(&mesh.points).filter(differs).count();
    Ok(result)
}

struct Work<'m> {
    mesh: &'m Mesh,
    topology: &'m Topology<'m>,
    problem: &'m Problem,
    stored: Precision,
}

impl Work<'_> {
    fn run(
        &mut self,
        result: &mut Untangled,
        observe: &mut dyn FnMut(&Untangling) -> ControlFlow<()>,
    ) {
        let targets = target_areas(self.problem, self.problem.positions());
        let mut state = State::new(self.problem, targets);
        let mut hierarchy = None;
        let mut tried = Vec::new();
        let nobody = vec![false; self.problem.free_count()];
        for stage in &STAGES {
            let (region, levels) = match stage.start {
                Start::Near(rings) => {
                    let share = result.left.len() as f64 / self.topology.triangles().len() as f64;
                    // Sweeps that have left no fewer bad triangles are not worth going on with.
                    let in_vain = result.sweeps > 0 && result.left.len() == result.bad_before;
                    if share > MANY || in_vain {
                        continue;
                    }
                    (Region::around(self.problem, &self.bad(&state), rings), None)
                }
                Start::Means | Start::Cut(_) => {
                    let held = match stage.start {
                        Start::Cut(short) => {
                            let held = state.cut(short);
                            // Without holes all rules find the same cuts, or none.
                            if tried.contains(&held) {
                                continue;
                            }
                            tried.push(held.clone());
                            held
                        }
                        _ => nobody.clone(),
                    };
                    // Where vertices are held, levels of the others alone find the means in a fifth of the iterations.
                    let of_others = held.contains(&true).then(|| state.hierarchy(&held));
                    let levels = &*hierarchy.get_or_insert_with(|| state.hierarchy(&nobody));
                    state.make_harmonic(of_others.as_ref().unwrap_or(levels), &held);
                    if self.judge(&state, result) {
                        return;
                    }
                    (Region::whole(self.problem), Some(levels))
                }
            };
            let mut least = state.assess(&region).least;
            let (often, share) = GOES_ON;
            let most = match stage.start {
                Start::Cut(_) => LONGEST * stage.sweeps,
                Start::Near(_) | Start::Means => stage.sweeps,
            };
            let mut before = f64::NEG_INFINITY;
            for sweep in 0..most {
                if sweep % often == 0 {
                    if sweep >= stage.sweeps && least < share * before {
                        break;
                    }
                    before = least;
                }
                let epsilon = epsilon(least);
                state.sweep(&region, epsilon);
                if let Some(levels) = levels {
                    state.global_step(&region, levels, epsilon);
                }
                result.sweeps += 1;
                let Assessment { least: now, bad } = state.assess(&region);
                least = now;
                // The exact judgment takes a pass over the whole mesh.
                if bad <= result.hopeless.len() && self.judge(&state, result) {
                    return;
                }
                if observe(&Untangling { sweep: result.sweeps, bad }).is_break() {
                    self.judge(&state, result);
                    return;
                }
            }
            if self.judge(&state, result) {
                return;
            }
        }
    }

    /// The triangles of the problem that are inverted or flat, or so by rounding.
    fn bad(&self, state: &State<'_>) -> Vec<u32> {
        let points: Vec<[f64; 2]> = state.positions.iter().map(|p| p.to_array()).collect();
        let mut bad = not_positive(&points, self.problem.triangles());
        bad.extend(self.problem.beyond_precision(&state.positions));
        bad
    }

    /// The triangles of the mesh that are inverted or flat with the vertices at `points`, and those with a free vertex that
    /// are so flat that double precision cannot judge them. In ascending order.
    fn bad_triangles(&self, points: &[[f64; 2]]) -> Vec<BadTriangle> {
        let triangles = self.topology.triangles();
        let mut bad = bad_triangles(points, triangles);
        let exact: HashSet<usize> = bad.iter().map(|bad| bad.triangle).collect();
        let beyond = self.problem.beyond_precision(&self.problem.normalized(points, Vec::new()));
        for triangle in self.problem.in_mesh(&beyond, triangles) {
            if !exact.contains(&triangle) && self.topology.can_move(triangle) {
                bad.push(BadTriangle { triangle, vertices: triangles[triangle], flat: true });
            }
        }
        bad.sort_unstable_by_key(|bad| bad.triangle);
        bad
    }

    /// Takes the positions if fewer triangles are bad than in the result. Returns whether none is left that could be
    /// mended.
    fn judge(&self, state: &State<'_>, result: &mut Untangled) -> bool {
        let mut points = self.problem.denormalize(self.mesh, &state.positions);
        for x in points.as_flattened_mut() {
            *x = self.stored.rounded(*x);
        }
        let triangles = self.topology.triangles();
        let left = self.bad_triangles(&points);
        let overlapping = match left.is_empty() {
            true => overlapping_star(&points, triangles, self.topology.free()).map(|(v, _)| v),
            false => None,
        };
        let separates = result.overlapping.is_some() && overlapping.is_none();
        if left.len() < result.left.len() || left.is_empty() && separates {
            result.points = points;
            result.left = left;
            result.overlapping = overlapping;
        }
        result.left.len() == result.hopeless.len() && result.overlapping.is_none()
    }
}
