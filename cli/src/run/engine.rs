//! Chooses and opens the engine that a run computes on.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use gpu_smooth::{
    Backend, Checkpoint, Gpu, GpuError, MeshSize, SmoothError, choice::Reason, precision::Precision,
};

use crate::error::CliError;
use crate::request::{EngineRequest, SmoothRequest};
use crate::run::driver_probe::{self, Tried};

pub(crate) const INSTALL: &str = "Install a Vulkan driver (on Debian or Ubuntu, `apt install mesa-vulkan-drivers` \
                       brings one that needs no graphics card), or use --engine cpu";

/// An engine, and the reason for it if the command line left the choice open.
#[derive(Clone)]
pub(crate) struct Taken {
    pub(crate) backend: Arc<Backend>,
    pub(crate) reason: Option<String>,
    /// Locked during a run, if other runs wait for the same device.
    turn: Option<Arc<Mutex<()>>>,
}

impl Taken {
    pub(crate) fn new(backend: Backend, reason: Option<String>) -> Self {
        Self { backend: Arc::new(backend), reason, turn: None }
    }

    /// Waits until no other run uses the device. The device is taken as long as the returned guard lives.
    pub(crate) fn turn(&self) -> Option<MutexGuard<'_, ()>> {
        self.turn.as_ref().map(|turn| turn.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Opens the engine of a request. `None` if the engine is to be chosen by the size of the mesh.
pub(crate) fn open(engine: &EngineRequest) -> Result<Option<Taken>, CliError> {
    let backend = match engine {
        EngineRequest::Auto => return Ok(None),
        EngineRequest::Cpu => Backend::Cpu,
        EngineRequest::Gpu { adapter } => Backend::Gpu(open_adapter(adapter.as_deref())?),
    };
    Ok(Some(Taken::new(backend, None)))
}

/// Chooses the engine for a mesh of this size and opens it.
pub(crate) fn choose(request: &SmoothRequest, size: MeshSize) -> Taken {
    let options = request.options(Precision::Double);
    let (backend, reason) = Backend::auto_tried(size, &options, try_best);
    Taken::new(backend, Some(worded(&reason)))
}

/// Opens the engine that a run was left on, or the CPU if that engine does not open.
pub(crate) fn of_checkpoint(checkpoint: &Checkpoint) -> Taken {
    let Some(name) = checkpoint.adapter() else {
        return Taken::new(Backend::Cpu, Some("where the run was left".into()));
    };
    match tried_and_opened(Some(name)) {
        Ok(gpu) => Taken::new(Backend::Gpu(gpu), Some("where the run was left".into())),
        Err(error) => {
            let reason = format!("the run was last on {name}, which cannot be opened: {error}");
            Taken::new(Backend::Cpu, Some(reason))
        }
    }
}

/// Words the reason of a choice, with the option that makes another.
fn worded(reason: &Reason) -> String {
    match reason {
        Reason::GpuFails(_) => reason.to_string(),
        Reason::GpuIsFaster { .. } => format!("{reason}; --engine cpu to use the CPU"),
        _ => format!("{reason}; --engine gpu to force"),
    }
}

/// The engines of many runs. A device is opened once, and runs take turns on it.
pub(crate) struct Engines<'a> {
    request: &'a SmoothRequest,
    /// The engine that the command line asks for, if it asks for one.
    asked: Option<Taken>,
    found: Mutex<Found>,
}

/// The engines that earlier choices found.
#[derive(Default)]
struct Found {
    /// A device, and the least number of vertices for which it is taken.
    gpu: Option<(Taken, usize)>,
    /// The CPU, and the most vertices for which it is taken because no GPU is faster.
    small: Option<(Taken, usize)>,
    /// The CPU, and the least number of vertices for which it is taken because there is no GPU.
    large: Option<(Taken, usize)>,
}

impl<'a> Engines<'a> {
    /// Opens the engine that the command line asks for, if it asks for one.
    pub(crate) fn new(request: &'a SmoothRequest) -> Result<Self, CliError> {
        let asked = open(&request.engine)?.map(in_turns);
        Ok(Self { request, asked, found: Mutex::default() })
    }

    /// Returns the engine for a mesh of this size. Must not be called from a thread of a rayon pool, as the choice
    /// counts the threads.
    pub(crate) fn take(&self, size: MeshSize) -> Taken {
        if let Some(asked) = &self.asked {
            return asked.clone();
        }
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        let Found { gpu, small, large } = &mut *found;
        if let Some((taken, least)) = gpu
            && size.vertices >= *least
            && let Backend::Gpu(gpu) = &*taken.backend
            && gpu.check_size(size).is_ok()
        {
            return taken.clone();
        }
        if let Some((taken, _)) = small.as_ref().filter(|(_, most)| size.vertices <= *most) {
            return taken.clone();
        }
        if let Some((taken, _)) = large.as_ref().filter(|(_, least)| size.vertices >= *least) {
            return taken.clone();
        }
        let (backend, reason) =
            Backend::auto_tried(size, &self.request.options(Precision::Double), try_best);
        let taken = in_turns(Taken::new(backend, Some(worded(&reason))));
        let known = (taken.clone(), size.vertices);
        match reason {
            Reason::GpuIsFaster { pays_from } => *gpu = Some((taken.clone(), pays_from)),
            Reason::CpuIsFaster { .. } => *small = Some(known),
            Reason::OnlySoftware(_)
            | Reason::GpuFails(GpuError::NoAdapter { .. } | GpuError::Crashed(_)) => {
                *large = Some(known);
            }
            // The GPU may have room for a smaller mesh, so nothing is remembered.
            _ => {}
        }
        taken
    }
}

/// Makes runs take turns on an engine that they share.
fn in_turns(taken: Taken) -> Taken {
    match &*taken.backend {
        Backend::Cpu => taken,
        Backend::Gpu(_) => Taken { turn: Some(Arc::default()), ..taken },
    }
}

/// Opens an adapter, for a command that needs one.
pub(crate) fn open_adapter(name: Option<&str>) -> Result<Gpu, CliError> {
    tried_and_opened(name).map_err(refusal)
}

/// Opens an adapter after it was tried in a process of its own, as a driver that crashes would end this one without a
/// message.
fn tried_and_opened(name: Option<&str>) -> Result<Gpu, GpuError> {
    driver_probe::drivers(Tried::Adapter(name)).and_then(|()| Gpu::open(name))
}

/// Tries the adapter that would be taken by default, in a process of its own.
fn try_best() -> Result<(), GpuError> {
    driver_probe::drivers(Tried::Adapter(None))
}

/// Words why there is no adapter, and what to do.
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
        // There is a driver, but it fails.
        error => CliError::from(error).with_remedy("Use --engine cpu, or another driver"),
    }
}

/// The error if the thread that starts a driver ended by a panic.
pub(crate) fn driver_crashed() -> CliError {
    CliError::device("the graphics driver crashed on start")
}

/// Whether a run failed because the GPU cannot hold the mesh.
pub(crate) fn is_too_large(error: &SmoothError) -> bool {
    matches!(error, SmoothError::Gpu(error) if is_too_large_for_device(error))
}

/// Whether a device has no room for what is asked of it.
pub(crate) fn is_too_large_for_device(error: &GpuError) -> bool {
    matches!(error, GpuError::Limit { .. } | GpuError::TooLarge { .. } | GpuError::OutOfMemory(_))
}
