//! The native module of the Python package `gpu_smooth`: conversions between NumPy arrays and the slices of the library,
//! options by the names of the command line, and exceptions. The Python modules in `gpu_smooth/` are the interface of
//! users.

mod arrays;
mod command_line;
mod data;
mod engine;
mod error;
mod files;
mod input;
mod measures;
mod mesh_options;
mod movement;
mod observer;
mod outcome;
mod plane;
mod prepared;
mod recovery;
mod remarks;
mod run_options;
mod smoother;
mod tables;
mod threads;
mod values;

use pyo3::prelude::*;

/// The native part of the package `gpu_smooth`. Interpreters without a global lock may use it from all threads at once: all
/// classes are frozen, and statics are atomic or locked.
#[pymodule(gil_used = false)]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::arrays::{pairs_of, vertex_set_of};
    #[pymodule_export]
    use crate::command_line::command_line;
    #[pymodule_export]
    use crate::data::{compare, interpolate, untangle};
    #[pymodule_export]
    use crate::files::MeshFile;
    #[pymodule_export]
    use crate::measures::{Quality, color_scale, quality, restored_quality};
    #[pymodule_export]
    use crate::outcome::Outcome;
    #[pymodule_export]
    use crate::smoother::{Smoother, run, smooth};
    #[pymodule_export]
    use crate::tables::{
        adapters, check_option_names, measures, mesh_options, metrics, options, run_options,
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
