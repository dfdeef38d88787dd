//! Sweeps for an application's command encoder.

use std::sync::Arc;

use crate::error::{GpuError, SmoothError};
use crate::gpu::device::Gpu;
use crate::gpu::device::pending::{Pending, Waiting};
use crate::gpu::embed::corrections::EncodedCorrections;
use crate::gpu::embed::objective::Run;
use crate::gpu::embed::{BoundObjective, Budget, DeviceMesh, Doubt};
use crate::gpu::encode::{Encoder, Passes};
use crate::gpu::kernels::form::Positions;
use crate::gpu::kernels::layouts::RestartBindings;
use crate::gpu::kernels::pipelines::Pipeline;
use crate::gpu::kernels::table::Kernel;
use crate::gpu::run::Dispatches;
use crate::gpu::scope::scoped;
use crate::metric::Scheme;
use crate::options::{Feature, Method, Options};
use crate::parallel::pace::now;
use crate::run::corrections::plan_steps::OMEGA_BETWEEN;
use crate::run::{Plan, SweepParams};

/// A scheme bound to a mesh on the device. Its methods encode sweeps into the application's command encoder, and
/// neither submit nor read back. Sweeps made by [`new`](Self::new) never end. Sweeps made by
/// [`until_converged`](Self::until_converged) do nothing once they have converged.
///
/// Several schemes can be bound to one mesh, and the sweeps of several meshes interleaved in one encoder.
pub struct Sweeps {
    gpu: Gpu,
    run: Run,
    judged: Option<SelfStopping>,
    corrections: Option<EncodedCorrections>,
    doubt: Option<Doubt>,
    done: u32,
}

/// The label of the pass of sweeps.
const LABEL: &str = "gpu-smooth sweeps";

/// The additional resources of sweeps that end by the stop rule.
struct SelfStopping {
    restart: Pipeline,
    resume: Pipeline,
    bind_group: wgpu::BindGroup,
}

impl Sweeps {
    /// Binds the scheme, relaxation and derivatives of `options` to a mesh.
    ///
    /// The sweeps have no stop rule, so the tolerance and the largest number of sweeps have no effect. Options of whole
    /// runs alone are refused: [`Stopping::Goal`](crate::Stopping::Goal), [`Guard::Worst`](crate::Guard::Worst),
    /// [`Options::max_move`], [`Options::keep_altitude`] and [`Options::improve_worst`].
    ///
    /// Metrics without a barrier ([`Metric::has_barrier`](crate::Metric::has_barrier)) leave no triangle with an inverse
    /// mean ratio above 30, unless the patch already had a larger ratio.
    ///
    /// With [`Method::Multilevel`], a correction from coarser levels follows each sweep. A large mesh is near its
    /// optimum after a dozen corrected sweeps instead of hundreds of sweeps alone. A corrected sweep takes as long as
    /// some four sweeps alone. The default, [`Method::Auto`], means sweeps alone here. A correction is taken only if it
    /// lowers f, inverts no triangle and breaks no shape guard; corrections pause while a triangle is inverted. EDGE
    /// and alternating metrics have corrections only in whole runs ([`Smoother`](crate::Smoother)). Sweeps on a mesh with
    /// stretched triangles or a vertex of many neighbors are not corrected; [`doubt`](Self::doubt) tells.
    ///
    /// For corrected sweeps, the call builds the levels on the host, after it has waited for all submitted work and read back
    /// a number for each free vertex. Other sweeps wait for nothing. The numbers come from a copy of the mesh after ten sweeps, so levels of a rough mesh fit the mesh
    /// that the first sweeps make of it. The aggregates of the levels never change; each correction fits the levels to
    /// the present sizes of elements. Levels take some 70 bytes on the device per vertex, and the copy another 16 bytes
    /// during the call.
    ///
    /// Compiles kernels that are not compiled yet; [`Gpu::prepare`] compiles kernels beforehand. Any thread may call
    /// this function.
    ///
    /// # Errors
    /// [`SmoothError::Option`] for an option out of range, an option of whole runs alone, or a scheme whose corrections
    /// cannot be encoded; [`GpuError::Limit`] if the levels are too large for the device; another [`GpuError`] if the device
    /// fails.
    pub fn new<'a>(mesh: &'a DeviceMesh, options: &'a Options) -> Pending<'a, Self, SmoothError> {
        Pending::new(|waiting| Box::pin(Self::by(mesh, options, Ending::Never, waiting)))
    }

    /// Binds options to a mesh like [`new`](Self::new), for sweeps that end by the stop rule on the device. Once f is
    /// within [`Stopping::Tolerance`](crate::Stopping::Tolerance) of its limit, or after [`Options::max_sweeps`],
    /// encoded sweeps do nothing. [`ObjectiveValues::stop`](crate::gpu::ObjectiveValues::stop) reports the end. Ended
    /// sweeps take a GPU next to no time; a software driver still starts every kernel, and takes a fifth of the usual
    /// time.
    ///
    /// The sweeps begin again when the application changes the mesh: an import finds a moved vertex, a move has a share
    /// above 0, [`UntanglingSweeps`](crate::gpu::UntanglingSweeps) find inverted triangles,
    /// [`LastValid`](crate::gpu::LastValid) restores positions, a mask or the pins change, or
    /// [`restart`](Self::restart) is called. Sweeps of other schemes on the mesh restart nothing. An evaluation of f
    /// follows each sweep and takes about a sixth of the sweep's time.
    ///
    /// # Errors
    /// [`SmoothError::Option`] or [`SmoothError::Gpu`]; [`new`](Self::new) gives the conditions.
    pub fn until_converged<'a>(
        mesh: &'a DeviceMesh,
        options: &'a Options,
    ) -> Pending<'a, Self, SmoothError> {
        Pending::new(|waiting| Box::pin(Self::by(mesh, options, Ending::SelfStopping, waiting)))
    }

    async fn by(
        mesh: &DeviceMesh,
        options: &Options,
        ending: Ending,
        waiting: Waiting,
    ) -> Result<Self, SmoothError> {
        let asks_corrections = options.method == Method::Multilevel;
        let mut features = mesh.features();
        features.push(Feature::Encoded);
        features.extend(asks_corrections.then_some(Feature::EncodedCorrections));
        options.check_with(&features)?;
        let doubt = Doubt::of(&mesh.problem);
        let is_corrected = asks_corrections && doubt.is_none();
        let plan = match asks_corrections && !is_corrected {
            true => Plan::new(&Options { method: Method::Auto, ..options.clone() }),
            false => Plan::new(options),
        };
        let endless = plan.clone().endless();
        let steps = match is_corrected {
            true => vec![between(&plan)],
            false => plan.steps(),
        };
        let DeviceMesh { gpu, problem, buffers, .. } = mesh;
        let dispatches = |plan, steps| {
            now(Dispatches::new(gpu, problem, buffers, plan, steps, false)).map(Arc::new)
        };
        let (dispatches, evaluation) = match ending {
            Ending::Never => {
                let both = dispatches(endless, steps)?;
                (Arc::clone(&both), both)
            }
            Ending::SelfStopping => (dispatches(plan, steps)?, dispatches(endless, Vec::new())?),
        };
        let (changes, elements) = (buffers.changes.clone(), problem.judged_count());
        let run = Run { dispatches, evaluation, changes, elements };
        let judged = run.is_judged().then(|| SelfStopping::new(gpu, &run)).transpose()?;
        let corrections = match is_corrected {
            true => {
                let step = between(&run.dispatches.plan);
                Some(EncodedCorrections::new(mesh, &run.dispatches, &step, waiting).await?)
            }
            false => None,
        };
        Ok(Self { gpu: gpu.clone(), run, judged, corrections, doubt, done: 0 })
    }

    /// Encodes `sweeps` further sweeps, each followed by a correction if the sweeps are corrected. Alternating metrics
    /// and over-relaxation count encoded sweeps, so the scheme continues from the last call even if that call's encoder
    /// was never submitted.
    pub fn encode_sweeps(&mut self, encoder: &mut impl Encoder, sweeps: u32) {
        self.encode(&mut encoder.passes(LABEL), sweeps);
    }

    /// Encodes as many sweeps as a budget allows, and returns their number. The device measures the sweeps if the
    /// budget is [timed](Budget::timed_by) by the device. Never waits.
    pub fn encode_within(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        budget: &mut Budget,
    ) -> u32 {
        budget.collect();
        let sweeps = budget.sweeps();
        match &mut budget.clock {
            None => self.encode_sweeps(encoder, sweeps),
            Some(clock) => {
                self.encode(&mut Passes::clocked(encoder, LABEL, clock.writes()), sweeps);
                clock.encode(encoder, &self.run.dispatches.control, sweeps);
            }
        }
        sweeps
    }

    fn encode(&mut self, passes: &mut Passes<'_>, sweeps: u32) {
        let Self { run: Run { dispatches, .. }, judged, corrections, .. } = self;
        if let Some(judged) = judged.as_ref().filter(|_| sweeps > 0) {
            judged.encode(passes, &judged.restart);
            dispatches.encode_evaluation(passes);
            judged.encode(passes, &judged.resume);
        }
        if sweeps > 0 {
            dispatches.encode_take_up(passes);
        }
        for _ in 0..sweeps {
            self.done = self.done.saturating_add(1);
            match corrections {
                None => dispatches.encode_sweep(passes, &dispatches.plan.step(self.done)),
                Some(corrections) => {
                    dispatches.encode_sweep(passes, &between(&dispatches.plan));
                    corrections.encode(passes);
                }
            }
            if judged.is_some() {
                dispatches.encode_evaluation(passes);
            }
        }
    }

    /// Returns why the sweeps are slow on the mesh as it was uploaded, and may end too early. `None` for most meshes. Sweeps with
    /// a doubt have no corrections, which would take longer than the sweeps that they save.
    pub fn doubt(&self) -> Option<Doubt> {
        self.doubt
    }

    /// Returns the scheme of the sweeps.
    pub fn scheme(&self) -> &Scheme {
        &self.run.dispatches.plan.scheme
    }

    /// Starts the scheme again, with plain sweeps before over-relaxed sweeps. Call this method after the application
    /// has moved vertices far. For sweeps [`until_converged`](Self::until_converged), later submissions restart the
    /// stop rule of all schemes on the mesh.
    pub fn restart(&mut self) {
        self.done = 0;
        if self.judged.is_some() {
            // Only a lost device refuses the write, and no sweep runs on a lost device.
            let _ = self.run.changes.count(&self.gpu);
        }
    }

    /// Binds a slice of an application's buffer for the objectives: [`ObjectiveValues`](crate::gpu::ObjectiveValues)
    /// are written to the start of the slice, which is at a multiple of 4 bytes.
    ///
    /// # Errors
    /// [`GpuError::Buffer`] if the slice is too small or misaligned, or if its buffer was created without `STORAGE` or
    /// belongs to another device. Another [`GpuError`] if the device fails.
    pub fn bind_objective(
        &self,
        values: wgpu::BufferSlice<'_>,
    ) -> Result<BoundObjective, GpuError> {
        BoundObjective::new(&self.gpu, &self.run, None, values)
    }
}

/// Returns the step of sweeps between corrections.
fn between(plan: &Plan) -> SweepParams {
    plan.base_step(OMEGA_BETWEEN)
}

/// Whether encoded sweeps end by the stop rule.
enum Ending {
    Never,
    SelfStopping,
}

impl SelfStopping {
    fn new(gpu: &Gpu, run: &Run) -> Result<Self, GpuError> {
        let whole = Positions::Whole;
        let bind_group = scoped(&gpu.device, || {
            let bindings = RestartBindings {
                control: run.dispatches.control.as_entire_binding(),
                changes: run.changes.buffer.as_entire_binding(),
            };
            gpu.pipelines.bind(&gpu.device, whole, bindings)
        })?;
        let pipeline = |kernel| gpu.pipelines.get(&gpu.device, &kernel, whole);
        let (restart, resume) = (pipeline(Kernel::RestartIfChanged)?, pipeline(Kernel::Resume)?);
        Ok(Self { restart, resume, bind_group })
    }

    fn encode(&self, passes: &mut Passes<'_>, pipeline: &Pipeline) {
        passes.run(pipeline, None, |pass| {
            pass.set_bind_group(0, &self.bind_group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
    }
}
