//! The stage in which vertices slide: sweeps along curves, after some sweeps over the free vertices.

use crate::error::MeshError;
use crate::mesh::Mesh;
use crate::outcome::Slid;
use crate::parallel::pace::now;
use crate::run::StopRule;
use crate::run::records::{Reader, Writer};
use crate::slide::{Acceleration, Params, Rule, Sliding, read_params, write_params};
use crate::topology::Topology;
use crate::topology::predicates::orientation;
use crate::whole::host::Host;
use crate::whole::stage::{Judgment, Period, PeriodRule, Stage};

/// Number of sweeps in a period. With two sweeps, a run takes more periods and as many sweeps; with four, more sweeps.
const SWEEPS: u32 = 3;
/// Number of times that a period sweeps along the curves, forward and back. Curves have few vertices, so each time is
/// cheap.
const SLIDES: u32 = 3;

/// Share by which the bound on altitudes is raised, as a reserve for rounding.
const ROUNDING: f64 = 1e-9;

/// The sliding vertices of a run, with their present parameters along the curves.
pub(crate) struct SlideStage<'s> {
    sliding: &'s Sliding,
    params: Params,
    /// Largest distance of each vertex from its given position, in the unit of the mesh.
    reach: Params,
    /// Lower limit of altitudes after sliding, normalized; 0 for no limit.
    floor: f64,
    /// Number of completed periods.
    count: u32,
    memory: Acceleration,
    rule: PeriodRule,
}

impl<'s> SlideStage<'s> {
    /// Creates the stage at the given positions. `reach` limits the distances of vertices from their given positions,
    /// if given. `floor` is the lower limit of altitudes, 0 for no limit.
    pub(crate) fn new(
        sliding: &'s Sliding,
        reach: Option<Params>,
        floor: f64,
        rule: StopRule,
    ) -> Self {
        Self {
            sliding,
            params: sliding.start(),
            reach: reach.unwrap_or_else(|| sliding.for_each_vertex(|_| f64::INFINITY)),
            floor: floor * (1.0 + ROUNDING),
            count: 0,
            memory: Acceleration::default(),
            rule: PeriodRule::new(rule),
        }
    }

    /// Returns the sliding vertices that have moved, as indices in the mesh with their positions. Normalized positions
    /// would lack some digits of the coordinates.
    pub(crate) fn moved(&self) -> Vec<(u32, [f64; 2])> {
        self.sliding.moved(&self.params)
    }

    /// Returns the result of sliding in a run that ended at `points`.
    pub(crate) fn slid(&self, mesh: &Mesh, topology: &Topology<'_>, points: &[[f64; 2]]) -> Slid {
        let (before, free) = (&mesh.points, topology.free());
        let moved = (0..free.len()).filter(|&v| !free[v] && points[v] != before[v]).count();
        let area = |points: &[[f64; 2]]| {
            let of = |t: &[u32; 3]| orientation(points, t);
            topology.triangles().iter().map(of).sum::<f64>()
        };
        let [off, off_share] =
            self.sliding.off(&self.sliding.with_returned(&self.params, before, points));
        Slid {
            vertices: self.sliding.count(),
            moved,
            pairs: self.sliding.pairs()[0],
            coincident: self.sliding.coincident()[0],
            rounds: self.count,
            off,
            off_share,
            area: area(points) / area(before) - 1.0,
        }
    }
}

impl Stage for SlideStage<'_> {
    fn name(&self) -> &'static str {
        "slide"
    }

    fn period(&self) -> u32 {
        SWEEPS
    }

    fn moves_without_sweeps(&self) -> bool {
        true
    }

    /// Sweeps along the curves, then extrapolates the last periods. The extrapolated positions are taken if f is lower
    /// there and all bounds hold.
    fn work(&mut self, host: &mut Host<'_>) -> Result<(), MeshError> {
        self.count = self.count.saturating_add(1);
        let step = host.plan.base_step(1.0);
        let began = self.params.clone();
        for _ in 0..SLIDES {
            let rule = Rule { step: &step, floor: self.floor };
            let Host { problem, positions, .. } = host;
            self.sliding.sweep(problem, &mut self.params, &self.reach, positions, rule);
        }
        let change = self.sliding.change(&began, &self.params);
        let next = self.memory.next(change, &self.params, &host.positions);
        let Some((mut params, mut there)) = next else { return Ok(()) };
        let (safe, reach) = (&self.params, &self.reach);
        if self.sliding.place(&host.problem, &mut params, safe, reach, &mut there)
            && host.is_sound(&host.positions, &there)
            && now(host.f(&there)) < now(host.f(&host.positions))
        {
            (self.params, host.positions) = (params, there);
        } else {
            self.memory.forget();
        }
        Ok(())
    }

    fn judge(&mut self, period: &Period) -> Judgment {
        self.rule.judge(period)
    }

    fn save(&self, out: &mut Writer) {
        out.number(self.count.into());
        write_params(&self.params, out);
        self.memory.save(out);
        self.rule.save(out);
    }

    fn restore(&mut self, host: &mut Host<'_>, from: &mut Reader<'_>) -> Option<()> {
        self.count = from.count()?;
        self.params = read_params(&self.params, from)?;
        self.sliding.is_in_order(&self.params).then_some(())?;
        self.memory = Acceleration::restored(&self.params, host.positions.len(), from)?;
        self.rule.restore(from)?;
        Some(())
    }
}
