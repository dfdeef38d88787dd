//! A run of a prepared mesh that has not begun: its options, backend, observer and checkpoints.

use std::future::IntoFuture;
use std::ops::ControlFlow;

use crate::error::SmoothError;
use crate::mesh::Mesh;
use crate::options::{Options, Stopping};
use crate::outcome::Outcome;
use crate::parallel::BoxedFuture;
use crate::parallel::pace::{budget_after, paced};
use crate::run::{Checkpoint, CheckpointPolicy, NoCheckpoints, Observer, Progress};
#[cfg(feature = "gpu")]
use crate::whole::Device;

use super::backend::Backend;
use super::prepared::Smoother;

/// A run that has not begun; made by [`Smoother::run`]. [`block`](Self::block) smooths the mesh and blocks until the run
/// ends; `.await` smooths it without blocking the thread while a device works. Without further calls, the run computes on
/// the CPU, reports nothing and takes no checkpoints.
///
/// ```
/// use gpu_smooth::{Backend, Mesh, Options, Progress, Smoother};
/// use std::ops::ControlFlow;
///
/// let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.3, 0.6]];
/// let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
/// let mesh = Mesh { points, triangles, ..Mesh::default() };
/// let smoother = Smoother::new(&mesh)?;
/// let mut sweeps = 0;
/// let mut observe = |progress: &Progress| {
///     sweeps = progress.sweep;
///     ControlFlow::Continue(())
/// };
/// let outcome = smoother.run(&Options::default()).on(&Backend::Cpu).observe(&mut observe).block()?;
/// assert!((outcome.points[4][0] - 0.5).abs() < 1e-3);
/// # Ok::<(), gpu_smooth::SmoothError>(())
/// ```
#[must_use = "a run begins by `block` or `.await`"]
pub struct Run<'r> {
    smoother: &'r Smoother<'r>,
    options: Options,
    backend: Backend,
    observer: Box<dyn Observer + 'r>,
    policy: Box<dyn CheckpointPolicy + 'r>,
    resumed: Option<&'r Checkpoint>,
}

impl Smoother<'_> {
    /// Returns a run with these options, on the CPU. The run begins by [`Run::block`] or `.await`. It borrows the smoother
    /// until it ends, and has copies of the options and of the backend.
    pub fn run(&self, options: &Options) -> Run<'_> {
        let (observer, policy) = (Box::new(unobserved), Box::new(NoCheckpoints));
        let (options, backend) = (options.clone(), Backend::Cpu);
        Run { smoother: self, options, backend, observer, policy, resumed: None }
    }
}

impl<'r> Run<'r> {
    /// Sets the engine of the sweeps.
    pub fn on(self, backend: &Backend) -> Self {
        Self { backend: backend.clone(), ..self }
    }

    /// Sets the observer. The run calls it every few sweeps, and between the iterations of long Newton steps, about ten times a
    /// second. If the observer ends the run, the
    /// outcome has the best positions so far and [`Stop::Canceled`](crate::Stop::Canceled).
    pub fn observe(self, observer: impl Observer + 'r) -> Self {
        Self { observer: Box::new(observer), ..self }
    }

    /// Sets the policy that decides when the run takes checkpoints, and whether the run falls back to the CPU if its
    /// device fails.
    pub fn checkpoints(self, policy: impl CheckpointPolicy + 'r) -> Self {
        Self { policy: Box::new(policy), ..self }
    }

    /// Continues from a checkpoint of a run on the same mesh with equal options. On the engine that took the
    /// checkpoint, the result has the bits of an uninterrupted run. If the checkpoint was taken on the CPU, the run
    /// continues on the CPU, whatever the backend. With `None`, the run starts from the mesh.
    pub fn resume(self, checkpoint: impl Into<Option<&'r Checkpoint>>) -> Self {
        Self { resumed: checkpoint.into(), ..self }
    }

    /// Smooths the mesh, and blocks until the run ends.
    ///
    /// # Errors
    /// [`SmoothError::Option`] if a number is outside its range or two features are mutually exclusive;
    /// [`SmoothError::Mesh`] with [`MeshError::NothingFree`](crate::MeshError::NothingFree) if no vertex is free and no
    /// vertex slides; [`SmoothError::Checkpoint`] if the checkpoint belongs to another run; [`SmoothError::Gpu`] if the
    /// device fails and the policy does not let the run fall back to the CPU. If the mesh does not fit the device, the
    /// error holds [`GpuError::Limit`](crate::GpuError::Limit) or [`GpuError::TooLarge`](crate::GpuError::TooLarge) and
    /// comes before the first sweep.
    pub fn block(self) -> Result<Outcome, SmoothError> {
        pollster::block_on(self.begin(false))
    }

    /// Does the run. If it `is_awaited`, the application polls the device, otherwise this library.
    async fn begin(
        self,
        #[cfg_attr(not(feature = "gpu"), expect(unused_variables))] is_awaited: bool,
    ) -> Result<Outcome, SmoothError> {
        let Self { smoother, mut options, backend, mut observer, mut policy, resumed } = self;
        let device = match &backend {
            Backend::Cpu => None,
            #[cfg(feature = "gpu")]
            Backend::Gpu(gpu) => Some(Device::new(gpu, is_awaited)),
        };
        if smoother.is_all_kept {
            let stopping = Stopping::default();
            options = Options { max_sweeps: 0, stopping, improve_worst: None, ..options };
        }
        let smoother = smoother.serving(&options);
        smoother.run_at(&options, device, resumed, &mut *policy, &mut *observer).await
    }
}

/// A run that is awaited does not block the thread while a device works. The future completes only if the application
/// polls the device meanwhile, as an application that draws frames does (`Device::poll` with `PollType::Poll` is enough).
/// While the run itself computes, also on the CPU, a poll ends at the first pause that comes 4 ms after its start or later,
/// or 0.25 ms if the last poll ended less than 5 ms ago.
/// Dropping the future cancels the run without an outcome. The future is `Send`, except in a browser.
impl<'r> IntoFuture for Run<'r> {
    type Output = Result<Outcome, SmoothError>;
    type IntoFuture = BoxedFuture<'r, Result<Outcome, SmoothError>>;

    fn into_future(self) -> Self::IntoFuture {
        Box::pin(paced(budget_after, Box::pin(self.begin(true))))
    }
}

/// An observer that never ends the run.
fn unobserved(_: &Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Smooths a mesh that is given as slices, in one blocking call, and returns the positions in the order of `points`.
/// `points` are positions in any unit, `triangles` zero-based vertex triples of either winding. The boundary and the vertices
/// `fixed` stay.
///
/// # Errors
/// [`SmoothError`] under the conditions that [`Smoother::new`] and [`Run::block`] give.
pub fn smooth(
    points: &[[f64; 2]],
    triangles: &[[u32; 3]],
    fixed: &[u32],
    options: &Options,
    backend: &Backend,
) -> Result<Vec<[f64; 2]>, SmoothError> {
    let mesh = Mesh {
        points: points.to_vec(),
        triangles: triangles.to_vec(),
        fixed: fixed.to_vec(),
        ..Mesh::default()
    };
    let smoother = Smoother::new(&mesh)?;
    Ok(smoother.run(options).on(backend).block()?.points)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::metric::Metric;
    use crate::options::{Derivatives, Guard, Method, Paper, WorstBy};
    use crate::parallel::pace::polled;
    use crate::patch::instructions::with_each_width;
    use crate::quality::Quality;
    use crate::run::truncated::fixtures;
    use crate::targets::{Surface, Targets};

    /// Returns a lattice of squares cut in two, with its inner vertices moved, and one of them nearly onto an edge.
    fn lattice(n: u32) -> Mesh {
        let mut points = Vec::new();
        for (row, column) in (0..=n).flat_map(|row| (0..=n).map(move |column| (row, column))) {
            let is_inner = |i| 0 < i && i < n;
            let away = if is_inner(row) && is_inner(column) { 0.2 } else { 0.0 };
            let wave = f64::from(7 * row + 3 * column).sin();
            points.push([f64::from(column) + away * wave, f64::from(row) - away * wave]);
        }
        let corner = |row: u32, column: u32| row * (n + 1) + column;
        let mut triangles = Vec::new();
        for (row, column) in (0..n).flat_map(|row| (0..n).map(move |column| (row, column))) {
            let [a, b] = [corner(row, column), corner(row, column + 1)];
            let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
        let [p, q, r] = triangles[2 * (n * (n / 2) + n / 2) as usize].map(|v| v as usize);
        let middle = |i| 0.5 * (points[q][i] + points[r][i]);
        let moved = [0, 1].map(|i| points[p][i] + (1.0 - 1e-7) * (middle(i) - points[p][i]));
        points[p] = moved;
        Mesh { points, triangles, ..Mesh::default() }
    }

    /// Processors with older vector instructions, or without, run other copies of the code.
    #[test]
    fn runs_have_the_same_bits_with_any_vector_instructions_and_without() {
        let mixed = fixtures::quadrilaterals(17, |cell| cell % 3 == 0);
        let meshes = [lattice(20), mixed, fixtures::hub(40), fixtures::lattice(15, 30.0)];
        let with_targets = |mesh: &Mesh| {
            let tensors: Vec<_> =
                mesh.points.iter().map(|p| [2.0 + p[0].sin(), 0.3, 1.5]).collect();
            Targets::tensors(&tensors).unwrap()
        };
        for (mesh, has_targets) in meshes.iter().flat_map(|mesh| [(mesh, false), (mesh, true)]) {
            let mut smoother = Smoother::new(mesh).unwrap();
            if has_targets {
                smoother.set_targets(&with_targets(mesh)).unwrap();
            }
            let by = |metric: Metric| Options { scheme: metric.into(), ..Options::default() };
            let few = |options: Options| Options { max_sweeps: 4, ..options };
            let by_differences =
                Paper { derivatives: Derivatives::FiniteDifference, newton_steps: 2 };
            let all = [
                by(Metric::Imr),
                by(Metric::Rms),
                by(Metric::SoftSize),
                few(by(Metric::Edge)),
                few(by(Metric::Acute)),
                few(Options { max_move: Some(0.05), keep_altitude: true, ..Options::default() }),
                few(Options { guard: Guard::Worst, ..by(Metric::Rms) }),
                few(Options { method: Method::Paper(by_differences), ..Options::default() }),
            ];
            // Differences of targets are refused.
            let all = if has_targets { &all[..all.len() - 1] } else { &all[..] };
            for options in all {
                let run = || {
                    let outcome = smoother.run(options).on(&Backend::Cpu).block().unwrap();
                    let bits: Vec<u64> =
                        outcome.points.as_flattened().iter().map(|x| x.to_bits()).collect();
                    let quality = [Surface::Plane, Surface::Sphere].map(|surface| {
                        let all = [&mesh.points, &outcome.points];
                        all.map(|points| Quality::on(surface, points, smoother.topology()).unwrap())
                    });
                    (bits, quality)
                };
                let [new, old, none] = with_each_width(run);
                assert!(new == old && new == none, "{options:?}, targets: {has_targets}");
            }
        }
    }

    /// With a budget of zero, each thread does one task in a poll: at most [`DEGREE_BLOCK`] visits of a sweep.
    ///
    /// [`DEGREE_BLOCK`]: crate::layout::DEGREE_BLOCK
    fn assert_polls(backend: &Backend, options: &Options) {
        let mesh = lattice(80);
        let smoother = Smoother::new(&mesh).unwrap();
        let blocked = smoother.run(options).on(backend).block().unwrap();
        let run = smoother.run(options).on(backend);
        let (awaited, polls) = polled(Duration::ZERO, run.begin(false));
        let awaited = awaited.unwrap();
        assert_eq!(awaited.points, blocked.points);
        let history = |outcome: &Outcome| format!("{:?}", outcome.history);
        assert_eq!(history(&awaited), history(&blocked));
        let is_on_cpu = matches!(backend, Backend::Cpu);
        let in_f64 = if is_on_cpu { awaited.sweeps } else { awaited.opening_sweeps };
        assert!(in_f64 > 0);
        let tasks = 79 * 79 / crate::layout::DEGREE_BLOCK * in_f64 as usize;
        let least = tasks / rayon::current_num_threads();
        assert!(polls > least, "{polls} polls, {least} expected at least");
    }

    #[test]
    fn an_awaited_run_pauses_within_each_sweep_on_the_cpu() {
        let improved = Options { improve_worst: Some(WorstBy::Imr), ..Options::default() };
        for options in [Options::default(), improved] {
            assert_polls(&Backend::Cpu, &options);
        }
    }

    #[cfg(feature = "gpu")]
    #[test]
    fn an_awaited_run_pauses_while_the_cpu_opens_triangles_for_a_device() {
        let gpu = crate::Gpu::open(None).block().unwrap();
        assert_polls(&Backend::Gpu(gpu), &Options::default());
    }
}
