//! Which engine a run gets.

use gpu_smooth::{Backend, Gpu, GpuError, SmoothError};

use crate::cli::{EngineChoice, SmoothArgs};
use crate::tell;

const INSTALL: &str = "Install a Vulkan driver (on Debian or Ubuntu, `apt install mesa-vulkan-drivers` \
                       brings one that needs no graphics card), or use --engine cpu";

/// Opens the engine that the command line asks for. Without an adapter, `auto` is the CPU, and says so.
pub(crate) fn open(args: &SmoothArgs) -> Result<Backend, String> {
    if args.engine == EngineChoice::Cpu {
        return match args.adapter {
            Some(_) => Err("--adapter names a GPU adapter, but --engine is cpu. Drop one".into()),
            None => Ok(Backend::Cpu),
        };
    }
    match Gpu::open(args.adapter.as_deref()) {
        Ok(gpu) => Ok(Backend::Gpu(gpu)),
        Err(error) if is_optional(args) => {
            tell::note(args.quiet, &format!("{error}: smoothing on the CPU"));
            Ok(Backend::Cpu)
        }
        Err(GpuError::NoAdapter { wanted: Some(name), available }) if !available.is_empty() => {
            Err(format!("no GPU adapter has '{name}' in its name. There are: {available}"))
        }
        Err(error) => Err(format!("{error}. {INSTALL}")),
    }
}

/// Whether a run that failed for this reason may be done on the CPU instead; says so if it may.
pub(crate) fn may_fall_back(args: &SmoothArgs, error: &SmoothError) -> bool {
    let too_large =
        matches!(error, SmoothError::Gpu(GpuError::Limit { .. } | GpuError::OutOfMemory(_)));
    let falls_back = is_optional(args) && too_large;
    if falls_back {
        tell::note(args.quiet, &format!("{error}: smoothing on the CPU"));
    }
    falls_back
}

fn is_optional(args: &SmoothArgs) -> bool {
    args.engine == EngineChoice::Auto && args.adapter.is_none()
}
