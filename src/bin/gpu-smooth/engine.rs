//! Which engine a run gets.

use gpu_smooth::{Backend, Gpu, GpuError, SmoothError};

use crate::cli::{EngineChoice, SmoothArgs};
use crate::tell;

pub(crate) const INSTALL: &str = "Install a Vulkan driver (on Debian or Ubuntu, `apt install mesa-vulkan-drivers` \
                       brings one that needs no graphics card), or use --engine cpu";

/// Opens the engine that the command line asks for. Without an adapter, `auto` is the CPU; the remark
/// that comes along says so.
pub(crate) fn open(args: &SmoothArgs) -> Result<(Backend, Option<String>), String> {
    if args.engine == EngineChoice::Cpu {
        return Ok((Backend::Cpu, None));
    }
    match Gpu::open(args.adapter.as_deref()) {
        Ok(gpu) => Ok((Backend::Gpu(gpu), None)),
        Err(error) if is_optional(args) => {
            let cause = match error {
                // Its own remedy is what happens already.
                GpuError::Arithmetic { adapter, operation } => {
                    format!("the adapter {adapter} cannot be used ({operation})")
                }
                error => error.to_string(),
            };
            Ok((Backend::Cpu, Some(format!("{cause}: smoothing on the CPU"))))
        }
        Err(error) => Err(refusal(error)),
    }
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

/// Whether a run that failed for this reason may be done on the CPU instead; says so if it may.
pub(crate) fn may_fall_back(args: &SmoothArgs, error: &SmoothError) -> bool {
    let falls_back = is_optional(args) && is_too_large(error);
    if falls_back {
        tell::note(args.quiet, &format!("{error}: smoothing on the CPU"));
    }
    falls_back
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

fn is_optional(args: &SmoothArgs) -> bool {
    args.engine == EngineChoice::Auto && args.adapter.is_none()
}
