//! Choice and opening of the engine that computes a run.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use gpu_smooth::BackendReason;
use gpu_smooth::front_ends::BackendChooser;
use gpu_smooth::options::Precision;
use gpu_smooth::{Backend, Checkpoint, Gpu, GpuError, MeshSize, SmoothError};
use gpu_smooth_job::EngineRequest;

use crate::error::CliError;
use crate::request::SmoothRequest;
use crate::run::driver_probe::{self, Starting, Trial};

pub(crate) const INSTALL: &str = "Install a Vulkan driver (on Debian or Ubuntu, `apt install mesa-vulkan-drivers` \
                       brings one that needs no graphics card), or use --engine cpu";

/// An open engine. `reason` explains an automatic choice; `None` if the command line determined the engine.
#[derive(Clone)]
pub(crate) struct OpenEngine {
    pub(crate) backend: Arc<Backend>,
    pub(crate) reason: Option<String>,
    /// Lock that the runs on a shared device hold in turn; `None` for engines without turns.
    turn: Option<Arc<Mutex<()>>>,
}

impl OpenEngine {
    pub(crate) fn new(backend: Backend, reason: Option<String>) -> Self {
        Self { backend: Arc::new(backend), reason, turn: None }
    }

    /// Waits until no other run uses the device, and reserves the device for the life of the returned guard.
    pub(crate) fn turn(&self) -> Option<MutexGuard<'_, ()>> {
        self.turn.as_ref().map(|turn| turn.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Opens the requested engine; `None` if the size of the mesh is to determine the engine.
pub(crate) fn open(engine: &EngineRequest) -> Result<Option<OpenEngine>, CliError> {
    let backend = match engine {
        EngineRequest::Auto => return Ok(None),
        EngineRequest::Cpu => Backend::Cpu,
        EngineRequest::Gpu { adapter } => Backend::Gpu(open_adapter(adapter.as_deref())?),
    };
    Ok(Some(OpenEngine::new(backend, None)))
}

/// Chooses an engine for a mesh by its size, and opens the engine.
pub(crate) fn choose(request: &SmoothRequest, size: MeshSize) -> OpenEngine {
    let options = request.options(Precision::Double);
    let mut starting = None;
    let (backend, reason) = Backend::auto_tried(size, &options, || try_best(&mut starting));
    drop(starting);
    OpenEngine::new(backend, Some(describe(&reason)))
}

/// Opens the engine of a checkpoint's last sweep, or the CPU if that engine fails to open.
pub(crate) fn of_checkpoint(checkpoint: &Checkpoint) -> OpenEngine {
    let Some(name) = checkpoint.adapter() else {
        return OpenEngine::new(Backend::Cpu, Some("where the run was left".into()));
    };
    match tried_and_opened(Some(name)) {
        Ok(gpu) => OpenEngine::new(Backend::Gpu(gpu), Some("where the run was left".into())),
        Err(error) => {
            let reason = format!("the run was last on {name}, which cannot be opened: {error}");
            OpenEngine::new(Backend::Cpu, Some(reason))
        }
    }
}

/// Describes the reason of a choice, with the option that overrides the choice.
fn describe(reason: &BackendReason) -> String {
    match reason {
        BackendReason::GpuFails(_) | BackendReason::NoSweeps => reason.to_string(),
        BackendReason::GpuIsFaster { .. } => format!("{reason}; --engine cpu to use the CPU"),
        _ => format!("{reason}; --engine gpu to force"),
    }
}

/// The engines of many runs. A device is opened once, and its runs take turns.
pub(crate) struct Engines<'a> {
    request: &'a SmoothRequest,
    /// The engine determined by the command line; `None` if meshes determine it.
    asked: Option<OpenEngine>,
    chooser: BackendChooser,
    /// Lock that the runs on a chosen device hold in turn.
    turn: Arc<Mutex<()>>,
}

impl<'a> Engines<'a> {
    /// Opens the engine that the command line determines, if any.
    pub(crate) fn new(request: &'a SmoothRequest) -> Result<Self, CliError> {
        let (chooser, turn) = (BackendChooser::new(), Arc::default());
        let asked = open(&request.engine)?.map(|asked| in_turns(asked, &turn));
        Ok(Self { request, asked, chooser, turn })
    }

    /// Returns the engine for a mesh of a given size. The choice counts rayon's threads, so the caller must not be on
    /// a thread of a rayon pool.
    pub(crate) fn take(&self, size: MeshSize) -> OpenEngine {
        if let Some(asked) = &self.asked {
            return asked.clone();
        }
        let options = self.request.options(Precision::Double);
        let mut starting = None;
        let (backend, reason) = self.chooser.choose(size, &options, || try_best(&mut starting));
        drop(starting);
        in_turns(OpenEngine::new(backend, Some(describe(&reason))), &self.turn)
    }
}

/// Makes the runs on a shared device take turns. The CPU needs no turns.
fn in_turns(taken: OpenEngine, turn: &Arc<Mutex<()>>) -> OpenEngine {
    match &*taken.backend {
        Backend::Cpu => taken,
        Backend::Gpu(_) => OpenEngine { turn: Some(Arc::clone(turn)), ..taken },
    }
}

/// Opens an adapter for a command that requires one.
pub(crate) fn open_adapter(name: Option<&str>) -> Result<Gpu, CliError> {
    tried_and_opened(name).map_err(refusal)
}

/// Opens an adapter after a trial in a child process. A driver that crashes would otherwise end this process without
/// a message.
fn tried_and_opened(name: Option<&str>) -> Result<Gpu, GpuError> {
    let _starting = driver_probe::drivers(Trial::Adapter(name))?;
    Gpu::open(name).block()
}

/// Tries the default adapter in a child process. The caller drops `starting` once the driver has started.
fn try_best(starting: &mut Option<Starting>) -> Result<(), GpuError> {
    *starting = Some(driver_probe::drivers(Trial::Adapter(None))?);
    Ok(())
}

/// Converts the failure to open an adapter to an error with a remedy.
pub(crate) fn refusal(error: GpuError) -> CliError {
    match error {
        GpuError::NoAdapter { wanted: Some(name), available } if !available.is_empty() => {
            CliError::device(format!("no GPU adapter has '{name}' in its name"))
                .with_remedy(format!("There are: {available}"))
        }
        GpuError::NoAdapter { .. } => {
            CliError::device("no GPU adapter was found").with_remedy(INSTALL)
        }
        GpuError::Arithmetic { .. } => error.into(),
        // A driver exists but fails.
        error => CliError::from(error).with_remedy("Use --engine cpu, or another driver"),
    }
}

/// Returns the error for a panic of the thread that opens the engine.
pub(crate) fn driver_crashed() -> CliError {
    CliError::device("the graphics driver crashed on start")
}

/// Returns whether a run failed because the mesh does not fit the GPU.
pub(crate) fn is_too_large(error: &SmoothError) -> bool {
    matches!(error, SmoothError::Gpu(error) if is_too_large_for_device(error))
}

/// Returns whether a device's limits or memory were exceeded.
pub(crate) fn is_too_large_for_device(error: &GpuError) -> bool {
    matches!(error, GpuError::Limit { .. } | GpuError::TooLarge { .. } | GpuError::OutOfMemory(_))
}
