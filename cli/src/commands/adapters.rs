//! The command `gpu-smooth adapters`, which lists GPU adapters and whether each is usable.

use gpu_smooth::{GpuError, gpu::AdapterSummary};

use crate::args::AdaptersArgs;
use crate::error::CliError;
use crate::run::driver_probe::{self, Trial};
use crate::run::engine::{self, INSTALL};
use crate::terminal::tell::{self, say};

pub(crate) fn run(args: &AdaptersArgs) -> Result<(), CliError> {
    if let Some(name) = &args.name {
        let gpu = engine::open_adapter(Some(name))?;
        say(&line(gpu.adapter(), Ok(())));
        return Ok(());
    }
    let _starting = driver_probe::drivers(Trial::All).map_err(engine::refusal)?;
    let adapters = gpu_smooth::gpu::checked_adapters();
    if adapters.is_empty() {
        say(&format!("no GPU adapter was found. {INSTALL}"));
    }
    for (adapter, usable) in adapters {
        say(&line(&adapter, usable));
    }
    Ok(())
}

/// Describes an adapter in one line, with the error of an unusable adapter.
fn line(adapter: &AdapterSummary, usable: Result<(), GpuError>) -> String {
    let state = match usable {
        Ok(()) if adapter.is_software() => {
            "arithmetic checked, used only where asked for (--engine gpu, --adapter)".to_owned()
        }
        Ok(()) => "arithmetic checked".to_owned(),
        Err(GpuError::Arithmetic { operation, .. }) => {
            format!("wrong arithmetic, not used: {operation}")
        }
        Err(error) => format!("not used: {error}"),
    };
    format!("{} {}; {state}", adapter.name, tell::adapter(adapter))
}
