//! Which engine a run gets.

use gpu_smooth::{Backend, Gpu, GpuError, MeshSize, Precision, Reason, SmoothError};

use crate::cli::{EngineChoice, SmoothArgs};

pub(crate) const INSTALL: &str = "Install a Vulkan driver (on Debian or Ubuntu, `apt install mesa-vulkan-drivers` \
                       brings one that needs no graphics card), or use --engine cpu";

/// An engine, and why it was taken if the command line left that open.
pub(crate) struct Taken {
    pub(crate) backend: Backend,
    pub(crate) reason: Option<String>,
}

/// Whether the engine is to be chosen by the size of the mesh.
pub(crate) fn is_open(args: &SmoothArgs) -> bool {
    args.engine == EngineChoice::Auto && args.adapter.is_none()
}

/// Opens the engine that the command line asks for.
pub(crate) fn open(args: &SmoothArgs) -> Result<Taken, String> {
    let backend = match args.engine {
        EngineChoice::Cpu => Backend::Cpu,
        EngineChoice::Gpu | EngineChoice::Auto => {
            Backend::Gpu(open_adapter(args.adapter.as_deref())?)
        }
    };
    Ok(Taken { backend, reason: None })
}

/// Chooses the engine for a mesh of this size and opens it.
pub(crate) fn choose(args: &SmoothArgs, size: MeshSize) -> Taken {
    let (backend, reason) = Backend::auto(size, &args.options(Precision::Double));
    let reason = match reason {
        Reason::GpuFails(_) => reason.to_string(),
        Reason::GpuIsFaster { .. } => format!("{reason}; --engine cpu to use the CPU"),
        _ => format!("{reason}; --engine gpu to force"),
    };
    Taken { backend, reason: Some(reason) }
}

/// Opens an adapter, for a command that needs one.
pub(crate) fn open_adapter(name: Option<&str>) -> Result<Gpu, String> {
    Gpu::open(name).map_err(refusal)
}

/// Why there is no adapter, and what to do.
fn refusal(error: GpuError) -> String {
    match error {
        GpuError::NoAdapter { wanted: Some(name), available } if !available.is_empty() => {
            format!("no GPU adapter has '{name}' in its name. There are: {available}")
        }
        GpuError::NoAdapter { .. } => format!("no GPU adapter was found. {INSTALL}"),
        GpuError::Arithmetic { .. } => error.to_string(),
        error => format!("{error}. {INSTALL}"),
    }
}

/// Whether the GPU cannot hold the mesh.
pub(crate) fn is_too_large(error: &SmoothError) -> bool {
    matches!(
        error,
        SmoothError::Gpu(
            GpuError::Limit { .. } | GpuError::TooLarge { .. } | GpuError::OutOfMemory(_)
        )
    )
}
