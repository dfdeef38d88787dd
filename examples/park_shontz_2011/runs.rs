//! Execution of runs sweep by sweep, which gives the time of each sweep.

use std::collections::HashSet;
use std::time::Instant;

use gpu_smooth::{
    Gpu, Mesh, Metric, Scheme, Topology,
    internal::{Coloring, Plan, Problem, Stepwise, StopRule, run_on_cpu, run_on_gpu},
    metric::{Corner, Ideal},
    options::{Derivatives, PNormExponent},
};

use super::Result;
use super::domains::{Domain, started};
use super::store::{BINS, DesiredRecord, DistributionRecord, MeshRecord, RunRecord, Sample};
use super::study::{Batch, Case, Place, Setting, Size, Start, Study};

/// Fraction of the way at which Figures 4 and 5 take their distributions, as in the paper.
const CONVERGED: f64 = 0.95;

/// A mesh before a run, prepared for the engines.
pub(crate) struct Prepared {
    mesh: Mesh,
    problem: Problem,
}

impl Prepared {
    fn new(mesh: Mesh) -> Result<Self> {
        let topology = Topology::new(&mesh)?;
        let problem = Problem::new(&mesh, &topology, &Coloring::new(&topology));
        Ok(Self { mesh, problem })
    }
}

/// Executes runs. The last mesh is cached, because successive runs mostly share a mesh.
pub(crate) struct Runner {
    gpu: Option<Gpu>,
    /// Size of the meshes in the tables.
    size: Size,
    reference_sweeps: u32,
    last: Option<((String, Size, Start), Prepared)>,
    /// Schemes and settings whose kernels are compiled.
    warm: HashSet<(String, Setting)>,
}

impl Runner {
    pub(crate) fn new(gpu: Option<Gpu>, study: &Study) -> Self {
        let Study { size, reference_sweeps, .. } = *study;
        Self { gpu, size, reference_sweeps, last: None, warm: HashSet::new() }
    }

    /// Returns the record of a domain's mesh before any displacement.
    pub(crate) fn mesh(&self, domain: &Domain, size: Size) -> Result<MeshRecord> {
        let mesh = domain.mesh(size)?;
        Ok(MeshRecord {
            domain: domain.name.into(),
            size,
            vertices: mesh.points.len(),
            elements: mesh.triangles.len(),
            boundary: support::boundary(&mesh).iter().filter(|on| **on).count(),
            min_angle: support::min_angle(&mesh),
        })
    }

    /// Searches the optimum of a metric with over-relaxed sweeps from two starts: the triangulated mesh, and the same
    /// mesh with random displacements. Returns the lower f.
    pub(crate) fn desired(
        &self,
        domain: &Domain,
        size: Size,
        metric: Metric,
    ) -> Result<DesiredRecord> {
        let mesh = domain.mesh(size)?;
        let mut best = f64::INFINITY;
        let mut tried = Vec::new();
        let starts =
            [("as triangulated", mesh.clone()), ("perturbed", started(&mesh, Start::Random))];
        for (name, mesh) in starts {
            let Prepared { problem, .. } = Prepared::new(mesh)?;
            let plan = Plan {
                omega: own_omega(),
                stop: StopRule { goal: None, tolerance: 1e-7, max_sweeps: self.reference_sweeps },
                ..plain(metric.into())
            };
            let mut engine = run_on_cpu(&problem, problem.positions(), plan);
            let log = engine.advance(self.reference_sweeps)?;
            let f = log.iter().filter_map(|o| o.of(metric)).fold(f64::INFINITY, f64::min);
            let stop = engine.stop().map_or("", |stop| stop.name());
            tried.push(format!("{name}: {f} after {} sweeps ({stop})", log.len() - 1));
            best = best.min(f);
        }
        let (domain, metric) = (domain.name.into(), metric.name().into());
        Ok(DesiredRecord { domain, size, metric, f: best, origin: tried.join("; ") })
    }

    /// Executes a run. The recorded time covers the sweeps and their evaluations of f.
    pub(crate) fn run(&mut self, batch: &Batch, case: &Case, desired: f64) -> Result<RunRecord> {
        let wall = Instant::now();
        let scheme: Scheme = case.scheme.parse()?;
        let base = scheme.base();
        self.prepare(case)?;
        self.warm_up(batch, case, &scheme)?;
        let Some((_, prepared)) = &self.last else { return Err("no mesh".into()) };
        let problem = &prepared.problem;
        let mut plan = plan(batch, scheme.clone());
        let mut engine = self.engine(case.place, problem, plan.clone())?;
        let f = |log: &[gpu_smooth::outcome::Objectives]| log.last().and_then(|o| o.of(base));
        let initial = f(&engine.advance(0)?).ok_or("no f before the first sweep")?;
        plan.stop.goal = Some(initial - batch.fraction * (initial - desired));
        drop(engine);

        let mut engine = self.engine(case.place, problem, plan.clone())?;
        engine.advance(0)?;
        let mut history = vec![Sample { seconds: 0.0, f: initial, edge: None, area: None }];
        let mut seconds = 0.0;
        let mut converged = None;
        while engine.stop().is_none() {
            let start = Instant::now();
            let log = engine.advance(1)?;
            seconds += start.elapsed().as_secs_f64();
            let Some(f) = f(&log) else { break };
            history.push(Sample { seconds, f, edge: None, area: None });
            if converged.is_none() && initial - f > CONVERGED * (initial - desired) {
                converged = Some(engine.best_positions()?);
            }
        }
        let stop = engine.stop().map_or("", |stop| stop.name()).to_owned();

        let mut distributions = Vec::new();
        if case.repeat == 0 && case.place == Place::Cpu {
            if matches!(case.scheme.as_str(), "imr" | "ar") {
                self.judge_by_others(problem, &plan, &mut history)?;
            }
            if case.setting == Setting::Published
                && case.size == self.size
                && let Some(positions) = converged
            {
                let points = problem.denormalize(&prepared.mesh, &positions);
                distributions.extend(distribution(case, &prepared.mesh, &points, false));
                if case.scheme == base.name() {
                    let before = &prepared.mesh.points;
                    distributions.extend(distribution(case, &prepared.mesh, before, true));
                }
            }
        }
        let wall_seconds = wall.elapsed().as_secs_f64();
        Ok(RunRecord { case: case.clone(), desired, stop, wall_seconds, history, distributions })
    }

    fn prepare(&mut self, case: &Case) -> Result<()> {
        let key = (case.domain.clone(), case.size, case.start);
        if self.last.as_ref().is_none_or(|(there, _)| *there != key) {
            let mesh = Domain::named(&case.domain)?.mesh(case.size)?;
            self.last = Some((key, Prepared::new(started(&mesh, case.start))?));
        }
        Ok(())
    }

    fn engine<'e>(
        &'e self,
        place: Place,
        problem: &'e Problem,
        plan: Plan,
    ) -> Result<Box<dyn Stepwise + 'e>> {
        let start = problem.positions();
        Ok(match (place, &self.gpu) {
            (Place::Cpu, _) => Box::new(run_on_cpu(problem, start, plan)),
            (Place::Gpu, Some(gpu)) => Box::new(run_on_gpu(gpu, problem, start, plan)?),
            (Place::Gpu, None) => return Err("there is no GPU".into()),
        })
    }

    /// Executes a few sweeps before a scheme's first run on the GPU. Drivers compile kernels at first use, which must
    /// not count as time of a run.
    fn warm_up(&mut self, batch: &Batch, case: &Case, scheme: &Scheme) -> Result<()> {
        if case.place == Place::Gpu && self.warm.insert((case.scheme.clone(), case.setting)) {
            let mesh = Domain::named(&case.domain)?.mesh(Size::Coarse)?;
            let prepared = Prepared::new(mesh)?;
            let plan = plan(batch, scheme.clone());
            self.engine(Place::Gpu, &prepared.problem, plan)?.advance(scheme.period())?;
        }
        Ok(())
    }

    /// Adds f by other metrics to each state of a run, for the figures. Repeats the run on the CPU without timing.
    fn judge_by_others(
        &self,
        problem: &Problem,
        plan: &Plan,
        history: &mut [Sample],
    ) -> Result<()> {
        let plan = Plan { track_all: true, ..plan.clone() };
        let mut engine = run_on_cpu(problem, problem.positions(), plan);
        let log = engine.advance(history.len() as u32 - 1)?;
        for (sample, objectives) in history.iter_mut().zip(&log) {
            sample.edge = objectives.of(Metric::Edge);
            sample.area = objectives.of(Metric::Area);
        }
        Ok(())
    }
}

fn own_omega() -> [f64; Metric::ALL.len()] {
    std::array::from_fn(|i| Metric::ALL[i].properties().omega)
}

/// Returns a plan with one Newton step per visit, analytic derivatives and no over-relaxation.
fn plain(scheme: Scheme) -> Plan {
    Plan {
        scheme,
        omega: [1.0; Metric::ALL.len()],
        unrelaxed_sweeps: 4,
        newton_steps: 1,
        derivatives: [Derivatives::Analytic; Metric::ALL.len()],
        sharpness: PNormExponent::FIXED,
        stop: StopRule { goal: None, tolerance: 0.0, max_sweeps: u32::MAX },
        track_all: false,
        shape_guard: f64::INFINITY,
        worst_guard: f64::INFINITY,
        max_lengthening: 1.0,
        is_guard_penalized: false,
    }
}

/// Returns the plan for a batch's setting.
fn plan(batch: &Batch, scheme: Scheme) -> Plan {
    let alone = scheme.metrics().iter().all(|&m| m == scheme.base());
    let mut plan = Plan { newton_steps: batch.inner, ..plain(scheme) };
    plan.stop.max_sweeps = batch.max_sweeps;
    match batch.setting {
        Setting::Plain => {}
        Setting::Analytic => {
            if alone {
                plan.omega = own_omega();
            }
        }
        Setting::Published => {
            for metric in [Metric::Edge, Metric::Rms, Metric::Area] {
                plan.derivatives[metric as usize] = Derivatives::FiniteDifference;
            }
        }
    }
    plan
}

/// Returns the distributions of the mean ratio and the edge ratio in a mesh.
fn distribution(
    case: &Case,
    mesh: &Mesh,
    points: &[[f64; 2]],
    before: bool,
) -> Vec<DistributionRecord> {
    let of = |name: &str, metric: Metric| {
        let mut counts = vec![0; BINS];
        let mut sum = 0.0;
        for &t in &mesh.triangles {
            let [p, q, r] = t.map(|v| points[v as usize]);
            let to = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
            let corner = Corner { a: to(p, q), b: to(p, r), ideal: Ideal::of_area(1.0) };
            let quality = 1.0 / metric.quality(&corner);
            sum += quality;
            counts[((quality * BINS as f64) as usize).min(BINS - 1)] += 1;
        }
        DistributionRecord {
            domain: case.domain.clone(),
            start: case.start,
            scheme: if before { String::new() } else { case.scheme.clone() },
            quality: name.into(),
            mean: sum / mesh.triangles.len() as f64,
            counts,
        }
    };
    vec![of("edge", Metric::Edge), of("mean ratio", Metric::Imr)]
}
