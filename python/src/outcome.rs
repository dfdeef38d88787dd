//! The result of a run.

use std::sync::Arc;

use gpu_smooth::front_ends::Plane;
use gpu_smooth::targets::Surface;
use gpu_smooth::{
    Backend, MeshError, Metric, Options, Outcome as RunOutcome, Quality as MeshQuality,
};
use gpu_smooth_job::{TargetKind, WorstRise};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::error;
use crate::measures::Quality;
use crate::prepared::{ArrayPair, Prepared};
use crate::remarks;
use crate::threads;

/// The result of a run. The class `Result` of the package shows it.
#[pyclass(frozen, module = "gpu_smooth._native")]
pub(crate) struct Outcome {
    outcome: RunOutcome,
    prepared: Arc<Prepared>,
    options: Options,
    engine: String,
    /// Remarks on the run.
    remarks: Vec<String>,
}

impl Outcome {
    pub(crate) fn new(
        outcome: RunOutcome,
        prepared: Arc<Prepared>,
        options: &Options,
        backend: &Backend,
        remarks: Vec<String>,
    ) -> Self {
        let engine = match backend {
            Backend::Cpu => "cpu".to_owned(),
            Backend::Gpu(_) if prepared.smoother.stays_on_cpu() => "cpu".to_owned(),
            Backend::Gpu(gpu) => gpu.adapter().name.clone(),
        };
        Self { outcome, prepared, options: options.clone(), engine, remarks }
    }

    fn quality(&self, py: Python<'_>, points: &[[f64; 2]]) -> PyResult<Quality> {
        let topology = self.prepared.smoother.topology();
        let surface = self.prepared.options.surface();
        let quality = threads::detached(py, || MeshQuality::on(surface, points, topology))?;
        quality.map(Quality::of).map_err(|error| error::of_mesh(py, &error))
    }
}

/// Returns points of the plane as an array of shape (n, 2).
fn flat(py: Python<'_>, points: Vec<[f64; 2]>) -> PyResult<Bound<'_, PyAny>> {
    let rows = points.len();
    arrays::matrix(py, points.into_flattened(), [rows, 2])
}

#[pymethods]
impl Outcome {
    /// Returns the triangles with consistent windings, counter-clockwise.
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.prepared.triangles(py)
    }

    /// Returns the quadrilaterals with consistent windings, counter-clockwise.
    fn quadrilaterals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.prepared.quadrilaterals(py)
    }

    /// Returns the points after the run, in the form of the points that were passed.
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let points = self.prepared.given(self.outcome.points.clone());
        self.prepared.form.array(py, points)
    }

    /// Returns the points before the run, as they were passed.
    fn points_before<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let points = self.prepared.points_before().to_vec();
        self.prepared.form.array(py, self.prepared.given(points))
    }

    /// Returns the points after the run by their two coordinates in the plane in which they were moved, for pictures. On the
    /// sphere, longitudes are continued across the line where they jump, and copies of vertices follow.
    fn flat_points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        flat(py, self.outcome.points.clone())
    }

    /// Returns the points before the run as `flat_points` returns those after it.
    fn flat_points_before<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        flat(py, self.prepared.points_before().to_vec())
    }

    /// Returns the triangles and the quadrilaterals by the rows of `flat_points`; None if the points have no copies of vertices.
    fn chart_cells<'py>(&self, py: Python<'py>) -> PyResult<Option<ArrayPair<'py>>> {
        self.prepared.chart_cells(py)
    }

    /// The surface of the coordinates, `"plane"` or `"sphere"`.
    #[getter]
    fn surface(&self) -> &'static str {
        match self.prepared.options.surface() {
            Surface::Plane => "plane",
            Surface::Sphere => "sphere",
        }
    }

    /// The names of the two coordinates in the plane in which the points were moved.
    #[getter]
    fn axes(&self) -> (&'static str, &'static str) {
        self.prepared.form.plane().map_or(["x", "y"], Plane::axes).into()
    }

    /// Returns f before the first sweep and after each sweep, by each metric that was evaluated.
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let by_metric = PyDict::new(py);
        for &metric in Metric::ALL {
            let values: Option<Vec<f64>> =
                self.outcome.history.iter().map(|objectives| objectives.of(metric)).collect();
            if let Some(values) = values.filter(|values| !values.is_empty()) {
                by_metric.set_item(metric.name(), PyArray1::from_vec(py, values))?;
            }
        }
        Ok(by_metric)
    }

    /// Returns the quality of the mesh before the run.
    fn quality_before(&self, py: Python<'_>) -> PyResult<Quality> {
        self.quality(py, self.prepared.points_before())
    }

    /// Returns the quality of the mesh after the run.
    fn quality_after(&self, py: Python<'_>) -> PyResult<Quality> {
        self.quality(py, &self.outcome.points)
    }

    /// Name of the metric that judges the run.
    #[getter]
    fn metric(&self) -> &'static str {
        self.options.scheme.base().name()
    }

    /// Whether f of the history is measured relative to targets.
    #[getter]
    fn has_target(&self) -> bool {
        self.prepared.options.target_kind() != TargetKind::Equilateral
    }

    /// `"cpu"`, or the name of the adapter.
    #[getter]
    fn engine(&self) -> &str {
        &self.engine
    }

    /// The reason why the run ended, in one word. `"nothing-to-do"` if all vertices stay, as `only_bad` finds no bad element or
    /// every free vertex is in a boundary layer that stays.
    #[getter]
    fn stop(&self) -> &'static str {
        let smoother = &self.prepared.smoother;
        let has_swept = self.outcome.sweeps > 0;
        match !has_swept && smoother.layers().have_all_free(smoother.topology()) {
            true => "nothing-to-do",
            false => self.outcome.stop.name(),
        }
    }

    /// The failure of the device after which the run continued on the CPU; None if the device did not fail.
    #[getter]
    fn fault(&self) -> Option<String> {
        self.outcome.device_fault.as_ref().map(|fault| fault.error.to_string())
    }

    /// Remarks on the mesh and the run. Those that cost a pass over the mesh are made here, when the caller wants to read them.
    #[getter]
    fn remarks(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let prepared = &*self.prepared;
        let worst = |points: &[[f64; 2]]| {
            let (surface, topology) = (prepared.options.surface(), prepared.smoother.topology());
            MeshQuality::on(surface, points, topology).map(|quality| quality.worst_movable_imr)
        };
        let of_mesh = threads::detached(py, || -> Result<_, MeshError> {
            let worst = [worst(prepared.points_before())?, worst(&self.outcome.points)?];
            let points = &prepared.smoother.mesh().points;
            Ok((prepared.smoother.topology().hanging_nodes(points)?, worst))
        })?;
        let (hanging, worst) = of_mesh.map_err(|error| error::of_mesh(py, &error))?;
        let Options { scheme, guard, .. } = &self.options;
        let rise = WorstRise::of(worst, scheme, *guard, self.has_target());
        let mut all = prepared.remarks.clone();
        all.extend(remarks::hanging(&hanging, |v| prepared.owner(v)));
        all.extend_from_slice(&self.remarks);
        all.extend(
            rise.map(|rise| remarks::worst_rise(rise, scheme.base(), prepared.smoother.mesh())),
        );
        Ok(all)
    }

    /// Number of sweeps done.
    #[getter]
    fn sweeps(&self) -> u32 {
        self.outcome.sweeps
    }

    /// Number of corrections from coarser levels.
    #[getter]
    fn corrections(&self) -> u32 {
        self.outcome.corrections
    }

    /// Number of Newton steps of all vertices.
    #[getter]
    fn newton_steps(&self) -> u32 {
        self.outcome.newton_steps
    }

    /// Number of iterations of conjugate gradients in all Newton steps of all vertices.
    #[getter]
    fn newton_iterations(&self) -> u32 {
        self.outcome.newton_iterations
    }

    /// The sweep whose points were taken; 0 for the points before the run.
    #[getter]
    fn best_sweep(&self) -> u32 {
        self.outcome.best_sweep
    }

    /// f over the elements that can move, before and after the run.
    #[getter]
    fn movable_f(&self) -> (f64, f64) {
        self.outcome.movable_f.into()
    }

    /// Estimated gain of further sweeps, as a share of f; None if unknown.
    #[getter]
    fn remaining(&self) -> Option<f64> {
        self.outcome.remaining
    }

    /// Number of vertices that a guard held back.
    #[getter]
    fn held_back(&self) -> usize {
        self.outcome.held_back
    }

    /// Whether vertices of the boundary and of lines may slide.
    #[getter]
    fn slides(&self) -> bool {
        self.prepared.options.settings().slides
    }

    /// Whether vertices on lines inside of the mesh may move freely.
    #[getter]
    fn frees_lines(&self) -> bool {
        self.prepared.options.settings().frees_lines
    }

    /// Number of vertices that slid along lines.
    #[getter]
    fn slid(&self) -> usize {
        self.outcome.slid.map_or(0, |slid| slid.moved)
    }

    /// Number of vertices that moved on or went back because the sweeps had made the worst triangles worse.
    #[getter]
    fn floored(&self) -> usize {
        self.outcome.floored.map_or(0, |floored| floored.moved + floored.returned)
    }

    /// Duration of the preparation of the mesh in seconds.
    #[getter]
    fn prepare_seconds(&self) -> f64 {
        self.prepared.smoother.prepare_time().as_secs_f64()
    }

    /// Duration of the run in seconds.
    #[getter]
    fn seconds(&self) -> f64 {
        self.outcome.smooth.as_secs_f64()
    }
}
