//! Smoothing: a prepared mesh and its runs, and the one call that prepares and runs.

use std::sync::Arc;

use gpu_smooth::targets::Surface;
use gpu_smooth::{Backend, Checkpoint, Mesh, MeshError, Options, Smoother as PreparedMesh};
use gpu_smooth_job::{Adapted, CheckpointFile, EngineRequest};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{self, Cells, Points, PointsForm};
use crate::engine;
use crate::error;
use crate::input::{Failure, Input, Layout};
use crate::mesh_options::{CallOptions, MeshOptions, Size, Target};
use crate::observer::RunObserver;
use crate::outcome::Outcome;
use crate::plane;
use crate::prepared::{Prepared, given};
use crate::recovery::{self, Recovery};
use crate::remarks::Remarks;
use crate::run_options::RunOptions;
use crate::threads;

/// A mesh prepared once for any number of runs.
#[pyclass(frozen, module = "gpu_smooth._native")]
pub(crate) struct Smoother(Arc<Prepared>);

#[pymethods]
impl Smoother {
    #[new]
    #[pyo3(signature = (points, triangles, *, quadrilaterals = None, **options))]
    fn new(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        triangles: Bound<'_, PyAny>,
        quadrilaterals: Option<Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let cells = Cells(triangles, quadrilaterals);
        let Call { mesh, form, options } = Call::read(points, &cells, options)?;
        let CallOptions { mesh: options, run } = options;
        let prepared = prepare(py, mesh, form, options, &RunObserver::new(&run))?;
        Ok(Self(Arc::new(prepared)))
    }

    /// Smooths the mesh, from other points or from its points as they were passed.
    #[pyo3(signature = (points = None, **options))]
    fn run(
        &self,
        py: Python<'_>,
        points: Option<&Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Outcome> {
        let mut run = RunOptions::default();
        for (name, value) in options.into_iter().flatten() {
            run.set_named(&name, &value, "Smoother.run")?;
        }
        run.check(py)?;
        let observer = RunObserver::new(&run);
        let prepared = match points {
            None => Arc::clone(&self.0),
            Some(points) => Arc::new(self.at(py, points, &run, &observer)?),
        };
        prepared.options.check(py, &run)?;
        run_prepared(py, &prepared, &run, &observer)
    }

    /// The flags of the vertices that are free: inside of the mesh and not fixed.
    #[getter]
    fn free<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<bool>> {
        let free = self.0.smoother.topology().free();
        numpy::PyArray1::from_slice(py, &free[..self.0.vertices()])
    }

    /// The triangles with consistent windings, counter-clockwise.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.0.triangles(py)
    }

    /// The quadrilaterals with consistent windings, counter-clockwise.
    #[getter]
    fn quadrilaterals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.0.quadrilaterals(py)
    }
}

impl Smoother {
    /// Returns the mesh at other points for a run.
    fn at(
        &self,
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        run: &RunOptions,
        observer: &RunObserver<'_>,
    ) -> PyResult<Prepared> {
        let of = &*self.0;
        let refusals = [
            (
                run.checkpoint_file().is_some(),
                "checkpoint and resume: a checkpoint continues the run of a Smoother from its own points. Drop both",
            ),
            (
                of.options.surface() == Surface::Sphere,
                "surface=\"sphere\": the projection belongs to the points before. Make a Smoother of the new points",
            ),
            (
                of.options.has("only-bad"),
                "only_bad: the free vertices are those near bad triangles of the points before. Make a Smoother of the new \
                 points, or drop only_bad",
            ),
        ];
        if let Some((_, text)) = refusals.iter().find(|(is_refused, _)| *is_refused) {
            return Err(error::option(py, &format!("points does not go with {text}")));
        }
        let points = arrays::points("points", points)?;
        let points = plane::lay_out_again(py, points, &of.form, of.options.z())?;
        let prepared = threads::watched(py, observer, || of.at(points, observer))?;
        finished(py, observer, prepared)
    }
}

/// The arguments of a call.
struct Call {
    mesh: Mesh,
    form: PointsForm,
    options: CallOptions,
}

impl Call {
    fn read(
        points: &Bound<'_, PyAny>,
        cells: &Cells<'_>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let py = points.py();
        let read = arrays::points("points", points)?;
        let mesh = cells.read(read.xy.len())?;
        let triangles = mesh.triangles.len();
        let size = Size {
            vertices: read.xy.len(),
            triangles,
            elements: triangles + mesh.quadrilaterals.len(),
        };
        let mut options = CallOptions::of_call(py, options, size)?;
        let Points { xy, form } =
            plane::lay_out(py, "points", read, options.mesh.z(), options.mesh.surface())?;
        if let Target::Background { points, .. } = &mut options.mesh.target {
            **points = plane::lay_out_likewise(py, "target[0]", std::mem::take(points), &form)?;
        }
        let mesh = Mesh { points: xy, ..mesh };
        Ok(Self { mesh, form, options })
    }
}

/// The options, the engine and the checkpoints of a run.
struct RunPlan {
    options: Options,
    backend: Backend,
    /// Whether the run continues on the CPU if the device fails. True only with `engine="auto"`.
    falls_back: bool,
    checkpoints: Option<CheckpointFile>,
    resumed: Option<Checkpoint>,
}

impl RunPlan {
    fn new(
        py: Python<'_>,
        run: &RunOptions,
        mesh: &MeshOptions,
        form: &PointsForm,
        smoother: &PreparedMesh<'_>,
    ) -> PyResult<Self> {
        let request = &run.settings().run;
        let options = request.options(mesh.target_kind().default_metric(), form.precision());
        let checkpoints = run.checkpoint_file();
        let resumed = run.resume().map(|path| recovery::resumed(py, path)).transpose()?;
        if let Some(plan) = &checkpoints {
            recovery::check(py, plan, run.resume())?;
        }
        let engine = run.settings().engine();
        let backend = match (&resumed, &engine) {
            (Some(checkpoint), EngineRequest::Auto) => engine::of_checkpoint(py, checkpoint)?,
            _ => engine::open(py, &engine, smoother.size(), &options)?,
        };
        let falls_back = engine == EngineRequest::Auto;
        Ok(Self { options, backend, falls_back, checkpoints, resumed })
    }

    /// Returns the adaptation of the mesh that the run will make less; `None` for a mesh that was untangled, or of which all
    /// vertices stay.
    fn adapted(
        &self,
        smoother: &PreparedMesh<'_>,
        layout: &Layout,
        mesh: &MeshOptions,
    ) -> Result<Option<Adapted>, MeshError> {
        let (topology, points) = (smoother.topology(), &smoother.mesh().points);
        let is_all_kept = smoother.layers().have_all_free(topology);
        if layout.tangled.is_some() || self.options.max_sweeps == 0 || is_all_kept {
            return Ok(None);
        }
        let metric = self.options.scheme.base();
        Adapted::before_run(topology, points, mesh.surface(), mesh.target_kind(), metric)
    }

    fn run(
        &self,
        smoother: &PreparedMesh<'_>,
        observer: &RunObserver<'_>,
    ) -> Result<gpu_smooth::Outcome, Failure> {
        let observe = |progress: &gpu_smooth::Progress| observer.sweep(progress);
        let recovery = Recovery::new(self.checkpoints.as_ref(), self.falls_back, observer);
        let run = smoother.run(&self.options).on(&self.backend).observe(observe);
        let outcome = run.checkpoints(recovery).resume(&self.resumed).block()?;
        if let Some(file) = &self.checkpoints {
            file.clear(outcome.stop);
        }
        Ok(outcome)
    }
}

/// Returns the result of finished work, or the exception that ended the work.
fn finished<T>(
    py: Python<'_>,
    observer: &RunObserver<'_>,
    done: Result<T, Failure>,
) -> PyResult<T> {
    observer.take_raised().map_or(Ok(()), Err)?;
    done.map_err(|failure| failure.raised(py))
}

/// Prepares a mesh, whose points were passed in a form, for runs.
fn prepare(
    py: Python<'_>,
    mesh: Mesh,
    form: PointsForm,
    options: MeshOptions,
    observer: &RunObserver<'_>,
) -> PyResult<Prepared> {
    let prepared = threads::watched(py, observer, || {
        let mut remarks = Remarks::new(observer);
        let input = Input::new(mesh, &options, &form, observer, &mut remarks)?;
        let lasting = remarks.count();
        let (smoother, layout) = input.into_smoother(&options, &mut remarks)?;
        let (options, remarks) = (Arc::new(options), remarks.into_texts());
        Ok(Prepared { smoother, layout, options, form, remarks, lasting })
    })?;
    finished(py, observer, prepared)
}

/// Smooths a prepared mesh.
fn run_prepared(
    py: Python<'_>,
    prepared: &Arc<Prepared>,
    run: &RunOptions,
    observer: &RunObserver<'_>,
) -> PyResult<Outcome> {
    let Prepared { smoother, layout, options, form, .. } = &**prepared;
    let plan = RunPlan::new(py, run, options, form, smoother)?;
    let done = threads::watched(py, observer, || {
        let mut remarks = Remarks::new(observer);
        let adapted = plan.adapted(smoother, layout, options)?;
        adapted.into_iter().for_each(|adapted| remarks.adapted(adapted));
        let outcome = plan.run(smoother, observer)?;
        remarks.outcome(&outcome, smoother.mesh());
        Ok((outcome, remarks.into_texts()))
    })?;
    let (outcome, remarks) = finished(py, observer, done)?;
    Ok(Outcome::new(outcome, Arc::clone(prepared), &plan.options, &plan.backend, remarks))
}

/// Smooths a mesh that is given as arrays, and returns the new points with a report. The time limit and the function of the
/// user include the preparation of the mesh, as in [`smooth`].
#[pyfunction]
#[pyo3(signature = (points, triangles, *, quadrilaterals = None, **options))]
pub(crate) fn run(
    py: Python<'_>,
    points: &Bound<'_, PyAny>,
    triangles: Bound<'_, PyAny>,
    quadrilaterals: Option<Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Outcome> {
    let cells = Cells(triangles, quadrilaterals);
    let Call { mesh, form, options } = Call::read(points, &cells, options)?;
    let CallOptions { mesh: options, run } = options;
    let observer = RunObserver::new(&run);
    let prepared = Arc::new(prepare(py, mesh, form, options, &observer)?);
    run_prepared(py, &prepared, &run, &observer)
}

/// Smooths a mesh that is given as arrays, and returns the new points.
#[pyfunction]
#[pyo3(signature = (points, triangles, *, quadrilaterals = None, **options))]
pub(crate) fn smooth<'py>(
    py: Python<'py>,
    points: &Bound<'py, PyAny>,
    triangles: Bound<'py, PyAny>,
    quadrilaterals: Option<Bound<'py, PyAny>>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let cells = Cells(triangles, quadrilaterals);
    let Call { mesh, form, options } = Call::read(points, &cells, options)?;
    let CallOptions { mesh: options, run } = options;
    let observer = RunObserver::new(&run);
    let remarks = &mut Remarks::new(&observer);
    let input =
        threads::watched(py, &observer, || Input::new(mesh, &options, &form, &observer, remarks))?;
    let input = match input {
        Ok(input) => input,
        failed => finished(py, &observer, failed)?,
    };
    let smoother = threads::watched(py, &observer, || input.smoother(&options, remarks))?;
    let smoother = match smoother {
        Ok(smoother) => smoother,
        failed => finished(py, &observer, failed)?,
    };
    let plan = RunPlan::new(py, &run, &options, &form, &smoother)?;
    let outcome = threads::watched(py, &observer, || {
        let adapted = plan.adapted(&smoother, &input.layout, &options)?;
        adapted.into_iter().for_each(|adapted| remarks.adapted(adapted));
        plan.run(&smoother, &observer)
    })?;
    let outcome = finished(py, &observer, outcome)?;
    drop(smoother);
    form.array(py, given(&input.layout, outcome.points))
}
