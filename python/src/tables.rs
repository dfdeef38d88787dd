//! The tables of metrics, measures, options and adapters.

use gpu_smooth::measure::{Better, Measure};
use gpu_smooth::{Metric, gpu};
use gpu_smooth_job::options::{Belongs, Kind, OPTIONS, OptionRow, Spelling};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::engine;
use crate::threads;
use crate::values;
use crate::{mesh_options as of_mesh, run_options as of_run};

/// Returns the names of the options that belong to a mesh.
#[pyfunction]
pub(crate) fn mesh_options() -> Vec<String> {
    of_mesh::names()
}

/// Returns the names of the options of a run.
#[pyfunction]
pub(crate) fn run_options() -> Vec<String> {
    of_run::names()
}

/// Returns the options of the table, as a dict each: the name, whether it belongs to a mesh, its type as in docstrings, its type
/// as an annotation, its default, and its description.
#[pyfunction]
pub(crate) fn options(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |row: &OptionRow| {
        let quoted = |words: &[&str]| {
            words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
        };
        let (kind, annotation) = match row.kind {
            Kind::Flag(_) => ("bool".to_owned(), "bool".to_owned()),
            Kind::Count(..) => ("int".to_owned(), "int".to_owned()),
            Kind::Number(..) | Kind::Seconds(_) => ("float".to_owned(), "float".to_owned()),
            Kind::NumberOrAuto(..) => {
                ("float or \"auto\"".to_owned(), "float | Literal[\"auto\"]".to_owned())
            }
            Kind::Word(words, _) => {
                (format!("{{{}}}", quoted(words)), format!("Literal[{}]", quoted(words)))
            }
            Kind::WordOrFlag(words, _) => (
                format!("bool or {{{}}}", quoted(words)),
                format!("bool | Literal[{}]", quoted(words)),
            ),
            Kind::Scheme(_) => {
                ("str or sequence of str".to_owned(), "str | Sequence[str]".to_owned())
            }
            _ => ("str".to_owned(), "str".to_owned()),
        };
        let default = match row.kind {
            Kind::Flag(_) | Kind::WordOrFlag(..) => "False".to_owned(),
            Kind::Word(..) if !row.default.is_empty() => quoted(&[row.default]),
            _ => row.default.to_owned(),
        };
        let described = PyDict::new(py);
        described.set_item("name", row.name.replace('-', "_"))?;
        described.set_item("is_of_mesh", row.belongs == Belongs::ToMesh)?;
        described.set_item("type", kind)?;
        described.set_item("annotation", annotation)?;
        described.set_item("default", default)?;
        described.set_item("description", row.help(Spelling::Python))?;
        Ok(described)
    };
    OPTIONS.iter().map(row).collect()
}

/// Fails if smoothing has no option of one of these names.
#[pyfunction]
pub(crate) fn check_option_names(given: Vec<String>) -> PyResult<()> {
    let names = of_mesh::all_names();
    match given.iter().find(|name| !names.contains(name)) {
        Some(name) => Err(values::unknown(name, "smoothing", &names)),
        None => Ok(()),
    }
}

/// Returns the metrics, as a dict of keyword arguments each.
#[pyfunction]
pub(crate) fn metrics(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |metric: &Metric| {
        let row = PyDict::new(py);
        row.set_item("name", metric.name())?;
        row.set_item("formula", metric.formula())?;
        row.set_item("purpose", metric.purpose())?;
        row.set_item("ideal", metric.ideal())?;
        row.set_item("has_barrier", metric.has_barrier())?;
        row.set_item("is_scale_invariant", metric.is_scale_invariant())?;
        row.set_item("omega", metric.omega())?;
        row.set_item("source", metric.citation())?;
        Ok(row)
    };
    Metric::ALL.iter().map(row).collect()
}

/// Returns the measures, as a dict of keyword arguments each.
#[pyfunction]
pub(crate) fn measures(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |measure: &Measure| {
        let definition = measure.definition();
        let row = PyDict::new(py);
        row.set_item("name", definition.name)?;
        row.set_item("formula", definition.formula)?;
        row.set_item("unit", definition.unit)?;
        row.set_item("range", (definition.range[0], definition.range[1]))?;
        row.set_item("ideal", definition.ideal)?;
        row.set_item(
            "better",
            if definition.better == Better::Higher { "higher" } else { "lower" },
        )?;
        row.set_item("source", definition.source)?;
        Ok(row)
    };
    Measure::ALL.iter().map(row).collect()
}

/// Opens and checks the adapters of this machine, and returns them as a dict of keyword arguments each.
#[pyfunction]
pub(crate) fn adapters(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    engine::start_drivers(py)?;
    let row = |(adapter, usable): (gpu::AdapterSummary, Result<(), gpu::GpuError>)| {
        let row = PyDict::new(py);
        row.set_item("name", &adapter.name)?;
        row.set_item("driver", &adapter.driver)?;
        row.set_item("backend", &adapter.backend)?;
        row.set_item("kind", adapter.kind)?;
        row.set_item("is_software", adapter.is_software())?;
        row.set_item("problem", usable.err().map(|error| error.to_string()))?;
        Ok(row)
    };
    threads::detached(py, gpu::checked_adapters)?.into_iter().map(row).collect()
}
