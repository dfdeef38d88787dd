//! The stage that bounds moves. After some sweeps, vertices too far from their start are moved back to their bound.

use glam::DVec2;

use crate::cpu::steps_at_bound;
use crate::error::MeshError;
use crate::layout::Problem;
use crate::measure::mean_edges;
use crate::mesh::Mesh;
use crate::parallel::pace::now;
use crate::patch::{Circle, batches};
use crate::precision::Precision;
use crate::run::records::{Reader, Writer};
use crate::run::{StopRule, SweepParams};
use crate::slide::{Params, Sliding};
use crate::topology::Topology;
use crate::whole::host::Host;
use crate::whole::stage::{Judgment, Period, PeriodRule, Stage, Worked};

/// Number of sweeps in a period.
const SWEEPS: u32 = 3;
/// Number of times that a period visits the held vertices, which are at their bound.
const VISITS: u32 = 3;
/// Largest number of halvings of a period's move, until the move lowers f and keeps triangles sound.
const MAX_HALVINGS: u32 = 5;
/// Distance from the start at which a vertex is held, as a share of the bound.
const AT_BOUND: f64 = 1.0 - 1e-6;

/// The stage that limits the distance of each vertex from its start, measured in the coordinates of the mesh.
pub(crate) struct MoveLimitStage<'s> {
    problem: &'s Problem,
    /// Largest distance of each vertex of the mesh from its start, in the unit of the mesh.
    all: Vec<f64>,
    /// Largest distance of each free vertex from its start, normalized.
    bounds: Vec<f64>,
    rule: PeriodRule,
}

impl<'s> MoveLimitStage<'s> {
    /// Creates the stage. Each vertex may move by `most` times the mean edge length at the vertex, less a reserve for
    /// positions rounded to the precision `stored`.
    pub(crate) fn new(
        mesh: &Mesh,
        topology: &Topology<'_>,
        problem: &'s Problem,
        most: f64,
        stored: Precision,
        rule: StopRule,
    ) -> Self {
        let edges = mean_edges(topology, &mesh.points);
        let bound = |([x, y], edge): (&[f64; 2], &f64)| {
            let (full, size) = (most * edge, x.abs().max(y.abs()));
            let rounding = 2.0 * stored.error(size);
            // Coordinates may become larger by the move, and so may their rounding errors. The share 1e-9 covers the
            // growth in double precision.
            let growth = 2.0 * stored.error(size + full) - rounding;
            let rounding = rounding + (growth - 1e-9 * full).max(0.0);
            (full * (1.0 - 1e-9) - rounding).max(0.0)
        };
        let all: Vec<f64> = mesh.points.iter().zip(&edges).map(bound).collect();
        let (_, scale) = problem.normalization();
        let free = &problem.vertices()[..problem.free_count()];
        Self {
            problem,
            bounds: free.iter().map(|&v| all[v as usize] * scale).collect(),
            all,
            rule: PeriodRule::new(rule),
        }
    }

    /// Returns the largest distance of each free vertex from its start, normalized.
    pub(crate) fn bounds(&self) -> &[f64] {
        &self.bounds
    }

    /// Returns the largest distance of each sliding vertex from its given position, in the unit of the mesh.
    pub(crate) fn reach(&self, sliding: &Sliding) -> Params {
        sliding.for_each_vertex(|v| self.all[v as usize])
    }

    /// Returns `to` if the position is within the bound of a free vertex, or else the position on the bound that is
    /// nearest in the coordinates of the mesh.
    fn within(&self, v: usize, to: DVec2) -> DVec2 {
        let coordinates = self.problem.coordinates();
        let center = coordinates.at(self.problem.positions()[v]);
        Circle { center, radius: self.bounds[v] }.nearest_position(coordinates, to)
    }

    /// Returns the distance of a free vertex from its start, normalized, with the vertex at `position`.
    fn distance(&self, v: usize, position: DVec2) -> f64 {
        let coordinates = self.problem.coordinates();
        coordinates.at(position).distance(coordinates.at(self.problem.positions()[v]))
    }

    /// Moves each vertex to its swept position, or to its bound if the position is beyond. Halves the moves until f
    /// falls and triangles stay sound. After [`MAX_HALVINGS`] halvings without success, the vertices return, and vertices
    /// swept beyond their bounds are held. Returns whether the vertices moved.
    fn take(&self, host: &mut Host<'_>) -> bool {
        let mut share = 1.0;
        for _ in 0..=MAX_HALVINGS {
            let mut there = host.before.clone();
            let moved = there[..self.bounds.len()].iter_mut().zip(&host.positions);
            for (v, (place, to)) in moved.enumerate() {
                // With a share of 1, the position equals `to` exactly.
                let wanted = if share == 1.0 { *to } else { *place + (*to - *place) * share };
                *place = self.within(v, wanted);
            }
            if host.is_sound(&host.before, &there) && now(host.f(&there)) < host.f_before {
                host.positions = there;
                return true;
            }
            share *= 0.5;
        }
        for (v, held) in host.held.iter_mut().enumerate() {
            *held |= self.within(v, host.positions[v]) != host.positions[v];
        }
        host.positions.clone_from(&host.before);
        false
    }

    /// Takes a step at each held vertex by [`SearchRule::BOUND`](crate::patch::SearchRule::BOUND). Held vertices are at
    /// their bound.
    fn visit_held(&self, host: &mut Host<'_>, step: &SweepParams) {
        // Vertices of a color are not neighbors, so no step reads a position that another step of the color changes.
        for color in self.problem.colors() {
            let held = color.clone().filter(|&v| host.held[v as usize]);
            let batches = batches(&host.problem, held);
            let steps =
                steps_at_bound(&host.problem, &host.positions, &batches, &self.bounds, step);
            for (v, to) in batches.iter().flatten().zip(steps.iter().flatten()) {
                host.positions[*v as usize] = *to;
            }
        }
    }
}

impl Stage for MoveLimitStage<'_> {
    fn name(&self) -> &'static str {
        "move limit"
    }

    fn period(&self) -> u32 {
        SWEEPS
    }

    fn work(
        &mut self,
        host: &mut Host<'_>,
        _: &dyn Fn(&[DVec2]) -> bool,
    ) -> Result<Worked, MeshError> {
        let before = host.held.clone();
        let has_moved = self.take(host);
        let step = host.plan.base_step(1.0);
        for _ in 0..VISITS {
            self.visit_held(host, &step);
        }
        if has_moved {
            self.follow(host);
        }
        let is_settled = has_moved || before == host.held;
        Ok(Worked { is_settled, has_moved_free: false })
    }

    /// Returns whether all free vertices are within their bounds.
    fn allows(&self, positions: &[DVec2]) -> bool {
        let bounds = self.bounds.iter().zip(positions).enumerate();
        bounds.into_iter().all(|(v, (bound, now))| self.distance(v, *now) <= *bound)
    }

    /// Holds the vertices at their bound, and releases all other vertices.
    fn follow(&mut self, host: &mut Host<'_>) {
        for (v, held) in host.held.iter_mut().enumerate() {
            *held = self.distance(v, host.positions[v]) >= AT_BOUND * self.bounds[v];
        }
    }

    fn judge(&mut self, period: &Period) -> Judgment {
        self.rule.judge(period)
    }

    fn save(&self, out: &mut Writer) {
        self.rule.save(out);
    }

    fn restore(&mut self, _: &mut Host<'_>, from: &mut Reader<'_>) -> Option<()> {
        self.rule.restore(from)?;
        Some(())
    }
}
