//! A prepared mesh, with all that its results need.

use std::sync::Arc;

use gpu_smooth::{Mesh, MeshError, Smoother as PreparedMesh};
use pyo3::prelude::*;

use crate::arrays::{self, Points, PointsForm};
use crate::input::{Failure, Layout, untangled};
use crate::mesh_options::MeshOptions;
use crate::observer::RunObserver;
use crate::remarks::Remarks;

/// Two arrays.
pub(crate) type ArrayPair<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// A mesh that is prepared for runs, with all that results need.
pub(crate) struct Prepared {
    pub(crate) smoother: PreparedMesh<'static>,
    pub(crate) layout: Layout,
    pub(crate) options: Arc<MeshOptions>,
    pub(crate) form: PointsForm,
    /// Remarks on the mesh.
    pub(crate) remarks: Vec<String>,
    /// Number of remarks, the first ones, that do not depend on targets and sliding vertices.
    pub(crate) lasting: usize,
}

impl Prepared {
    /// Returns the mesh with its vertices at other points. Fixed vertices and layers stay those of this mesh; targets and curves
    /// are those of the new points. Untangles the mesh if the options ask for it.
    pub(crate) fn at(&self, points: Points, observer: &RunObserver<'_>) -> Result<Self, Failure> {
        let Points { xy, form } = points;
        let (mut smoother, mut tangled) = (self.smoother.clone(), None);
        let untangles = self.options.settings().untangles;
        let given = untangles.then(|| xy.clone());
        let is_tangled = match smoother.set_points(xy) {
            Ok(()) => untangles && !smoother.beyond_precision().is_empty(),
            Err(MeshError::Infeasible { .. } | MeshError::OverlappingStar { .. }) if untangles => {
                true
            }
            Err(error) => return Err(error.into()),
        };
        if is_tangled && let Some(points) = given {
            let mesh = Mesh { points, ..self.smoother.mesh().clone() };
            if let Some(points) = untangled(&mesh, &form, observer)? {
                smoother.set_points(points)?;
                tangled = Some(mesh.points);
            }
        }
        let mut remarks = Remarks::new(observer);
        let (domain, plane) = (self.layout.domain.clone(), form.plane().cloned());
        let layout = Layout { tangled, domain, plane };
        layout.set_up(&self.options, &mut smoother, &mut remarks)?;
        let (options, lasting) = (Arc::clone(&self.options), self.lasting);
        let remarks = [&self.remarks[..lasting], &remarks.into_texts()].concat();
        Ok(Self { smoother, layout, options, form, remarks, lasting })
    }

    /// Returns points for the caller: vertices that a chart has copied are left out, and longitudes are in the given range.
    pub(crate) fn given(&self, points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        given(&self.layout, points)
    }

    /// Returns the points before the run and before untangling.
    pub(crate) fn points_before(&self) -> &[[f64; 2]] {
        self.layout.tangled.as_ref().unwrap_or(&self.smoother.mesh().points)
    }

    /// Returns the triangles with consistent windings, counter-clockwise, as an array of shape (m, 3). Their vertices are those
    /// of the call.
    pub(crate) fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.triangles_by(py, |vertex| self.owner(vertex))
    }

    /// Returns the quadrilaterals with consistent windings, counter-clockwise, as an array of shape (k, 4). Their vertices are
    /// those of the call.
    pub(crate) fn quadrilaterals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.quadrilaterals_by(py, |vertex| self.owner(vertex))
    }

    /// Returns the triangles and the quadrilaterals whose vertices may be copies that a chart has made; `None` if no vertex was
    /// copied.
    pub(crate) fn chart_cells<'py>(&self, py: Python<'py>) -> PyResult<Option<ArrayPair<'py>>> {
        let chart = self.layout.domain.chart().filter(|chart| !chart.owners().is_empty());
        let cells = || Ok((self.triangles_by(py, |v| v)?, self.quadrilaterals_by(py, |v| v)?));
        chart.map(|_| cells()).transpose()
    }

    fn triangles_by<'py>(
        &self,
        py: Python<'py>,
        number: impl Fn(u32) -> u32,
    ) -> PyResult<Bound<'py, PyAny>> {
        let triangles = self.smoother.topology().triangles();
        let numbers = triangles.as_flattened().iter().map(|&v| i64::from(number(v))).collect();
        arrays::matrix(py, numbers, [triangles.len(), 3])
    }

    fn quadrilaterals_by<'py>(
        &self,
        py: Python<'py>,
        number: impl Fn(u32) -> u32,
    ) -> PyResult<Bound<'py, PyAny>> {
        let quadrilaterals = self.smoother.topology().quadrilaterals();
        let rows = quadrilaterals.len();
        let numbers = quadrilaterals.flatten().map(|v| i64::from(number(v))).collect();
        arrays::matrix(py, numbers, [rows, 4])
    }

    /// Returns the vertex of the call for a vertex of the mesh, which is a copy if a chart has made it.
    pub(crate) fn owner(&self, vertex: u32) -> u32 {
        let copy = (vertex as usize).checked_sub(self.vertices());
        let owner = || self.layout.domain.chart()?.owners().get(copy?).copied();
        owner().unwrap_or(vertex)
    }

    /// Returns the number of vertices that were passed.
    pub(crate) fn vertices(&self) -> usize {
        let chart = self.layout.domain.chart();
        let mesh = self.smoother.mesh();
        chart.map_or(mesh.points.len(), |chart| chart.original().points.len())
    }
}

/// Returns points of a mesh as points of the call.
pub(crate) fn given(layout: &Layout, points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    match layout.domain.chart() {
        Some(chart) => chart.given(&points),
        None => points,
    }
}
