//! A prepared mesh, with all that its results need.

use gpu_smooth::Smoother as PreparedMesh;
use pyo3::prelude::*;

use crate::arrays::{self, PointsForm};
use crate::input::Layout;
use crate::mesh_options::MeshOptions;

/// A mesh that is prepared for runs, with all that results need.
pub(crate) struct Prepared {
    pub(crate) smoother: PreparedMesh<'static>,
    pub(crate) layout: Layout,
    pub(crate) options: MeshOptions,
    pub(crate) form: PointsForm,
    /// Remarks on the mesh.
    pub(crate) remarks: Vec<String>,
}

impl Prepared {
    /// Returns points for the caller: vertices that a chart has copied are left out, and longitudes are in the given range.
    pub(crate) fn given(&self, points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        given(&self.layout, points)
    }

    /// Returns the points before the run and before untangling.
    pub(crate) fn points_before(&self) -> &[[f64; 2]] {
        self.layout.tangled.as_ref().unwrap_or(&self.smoother.mesh().points)
    }

    /// Returns the triangles with consistent windings, counter-clockwise, as an array of shape (m, 3).
    pub(crate) fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let triangles = self.smoother.topology().triangles();
        let numbers = triangles.as_flattened().iter().map(|&v| i64::from(v)).collect();
        arrays::matrix(py, numbers, [triangles.len(), 3])
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
