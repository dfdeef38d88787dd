//! Quality of the triangles and quadrilaterals of a mesh.

use gpu_smooth::front_ends::Chart;
use gpu_smooth::measure::{Measure, Measured, UnknownMeasure};
use gpu_smooth::options::Precision;
use gpu_smooth::targets::Surface;
use gpu_smooth::{Element, Mesh, MeshError, Metric, Quality as MeshQuality, Topology};
use gpu_smooth_cli::colors::{BAD, ColorScale, VIRIDIS};
use numpy::PyArray1;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{self, Cells, Points, PointsForm};
use crate::error;
use crate::plane;
use crate::threads;
use crate::values::{Given, ThirdCoordinate};

/// Returns the surface of a word.
pub(crate) fn surface(value: &Bound<'_, PyAny>) -> PyResult<Surface> {
    let given = Given { name: "surface", value };
    given.word(&[("plane", Surface::Plane), ("sphere", Surface::Sphere)])
}

/// Returns the measure of a name.
fn measure_of(name: &Bound<'_, PyAny>) -> PyResult<Measure> {
    let measure = Given { name: "measure", value: name }.text()?;
    measure
        .parse()
        .map_err(|unknown: UnknownMeasure| error::option(name.py(), &format!("measure: {unknown}")))
}

/// Returns the colors that pictures show by a measure, as a dict: the values `low` and `high` between which colors change,
/// `colors` at equal steps from `low` to `high`, the color of `inverted` and flat triangles, the `unit` of the measure, and a
/// `legend`. The default values are those of the command line.
#[pyfunction]
pub(crate) fn color_scale<'py>(
    measure: &Bound<'py, PyAny>,
    picture_range: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = measure.py();
    let measure = measure_of(measure)?;
    let scale = match picture_range.is_none() {
        true => ColorScale::usual(measure),
        false => {
            let given = Given { name: "picture_range", value: picture_range };
            let range = picture_range.extract().map_err(|_| given.refused("two numbers"))?;
            ColorScale::new(measure, range)
                .map_err(|problem| error::option(py, &format!("picture_range: {problem}")))?
        }
    };
    let hex = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    let mut colors = VIRIDIS.map(hex);
    let [bad, good] = scale.ends();
    if bad > good {
        colors.reverse();
    }
    let row = PyDict::new(py);
    row.set_item("low", bad.min(good))?;
    row.set_item("high", bad.max(good))?;
    row.set_item("colors", colors.to_vec())?;
    row.set_item("inverted", hex(BAD))?;
    row.set_item("unit", measure.definition().unit)?;
    row.set_item("legend", scale.legend())?;
    Ok(row)
}

/// The name of an argument, and points that the argument has.
pub(crate) struct Named<'a, 'py> {
    pub(crate) name: &'a str,
    pub(crate) points: &'a Bound<'py, PyAny>,
}

/// Returns the mesh of arrays, in the plane in which the points lie, and the form of the points.
pub(crate) fn mesh(
    given: Named<'_, '_>,
    cells: &Cells<'_>,
    z: ThirdCoordinate,
    surface: Surface,
) -> PyResult<(Mesh, PointsForm)> {
    let Named { name, points } = given;
    let read = arrays::points(name, points)?;
    let mesh = cells.read(read.xy.len())?;
    arrays::check_finite(points.py(), name, &read.xy)?;
    let Points { xy, form } = plane::lay_out(points.py(), name, read, z, surface)?;
    Ok((Mesh { points: xy, ..mesh }, form))
}

/// Returns the chart of a mesh with the stored precision of its coordinates; `None` in the plane, and if no triangle is across
/// the line where longitudes jump or at a pole.
pub(crate) fn chart(
    mesh: &Mesh,
    surface: Surface,
    stored: Precision,
) -> Result<Option<Chart>, MeshError> {
    match surface {
        Surface::Plane => Ok(None),
        Surface::Sphere => Chart::new(mesh, stored),
    }
}

/// Returns the value of a measure for each triangle, then for each quadrilateral. The value of a quadrilateral is NaN if
/// quadrilaterals lack the measure.
#[pyfunction]
pub(crate) fn quality<'py>(
    py: Python<'py>,
    points: &Bound<'py, PyAny>,
    cells: Cells<'py>,
    measure: &Bound<'py, PyAny>,
    on: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let surface = surface(on)?;
    let z = plane::third_coordinate(z)?;
    let (mut mesh, form) = mesh(Named { name: "points", points }, &cells, z, surface)?;
    let measure = measure_of(measure)?;
    let values = threads::detached(py, || {
        if let Some(chart) = chart(&mesh, surface, form.precision())? {
            mesh = chart.mesh().clone();
        }
        let topology = Topology::new(&mesh)?;
        let mut values = Measured::on(surface, &mesh.points, &topology)?.values(measure);
        values.resize(topology.element_count(), f64::NAN);
        Ok(values)
    })?;
    let values = values.map_err(|error| error::of_mesh(py, &error))?;
    Ok(PyArray1::from_vec(py, values))
}

/// Statistics of the triangles and quadrilaterals of a mesh.
#[pyclass(frozen, module = "gpu_smooth")]
pub(crate) struct Quality(Statistics);

/// The numbers of a [`Quality`], in the form that is pickled.
#[derive(Clone, IntoPyObject, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Statistics {
    /// f by each metric, with the name of the metric, as another version may have other metrics.
    f: Vec<(String, f64)>,
    min_angle: f64,
    max_angle: f64,
    worst_imr: f64,
    worst_element: (String, usize),
    inverted: usize,
}

impl Quality {
    pub(crate) fn of(quality: MeshQuality) -> Self {
        let f = Metric::ALL.iter().map(|&own| (own.name().to_owned(), quality.f(own))).collect();
        let MeshQuality { min_angle, max_angle, worst_imr, worst, inverted, .. } = quality;
        let kind = match worst {
            Element::Triangle(_) => "triangle",
            Element::Quadrilateral(_) => "quadrilateral",
        };
        let worst_element = (kind.to_owned(), worst.index());
        Self(Statistics { f, min_angle, max_angle, worst_imr, worst_element, inverted })
    }

    /// Returns f by a metric. NaN if the quality was pickled by a version without the metric.
    fn by(&self, metric: Metric) -> f64 {
        let of_metric = self.0.f.iter().find(|(name, _)| name == metric.name());
        of_metric.map_or(f64::NAN, |&(_, f)| f)
    }
}

/// Returns the quality that was pickled as `statistics`.
#[pyfunction]
pub(crate) fn restored_quality(statistics: Statistics) -> Quality {
    Quality(statistics)
}

#[pymethods]
impl Quality {
    /// The objective f, the mean of q² over all triangles and quadrilaterals, by a metric. Infinite if one is inverted or flat and
    /// the metric has a barrier.
    #[pyo3(signature = (metric = None), text_signature = "($self, metric='imr')")]
    fn f(&self, py: Python<'_>, metric: Option<&Bound<'_, PyAny>>) -> PyResult<f64> {
        let Some(value) = metric else { return Ok(self.by(Metric::Imr)) };
        let metric = Given { name: "metric", value }.text()?;
        let metric: Metric = metric.replace('_', "-").parse().map_err(
            |unknown: gpu_smooth::metric::UnknownMetric| {
                error::option(py, &format!("metric: {unknown}"))
            },
        )?;
        Ok(self.by(metric))
    }

    /// Smallest angle of any triangle or quadrilateral, in degrees.
    #[getter]
    fn min_angle(&self) -> f64 {
        self.0.min_angle
    }

    /// Largest angle of any triangle or quadrilateral, in degrees.
    #[getter]
    fn max_angle(&self) -> f64 {
        self.0.max_angle
    }

    /// Largest inverse mean ratio of a triangle or of a corner of a quadrilateral: 1 at best, infinite if one is inverted or flat.
    #[getter]
    fn worst_imr(&self) -> f64 {
        self.0.worst_imr
    }

    /// Kind and index of the triangle or quadrilateral with the largest inverse mean ratio.
    #[getter]
    fn worst_element(&self) -> (String, usize) {
        self.0.worst_element.clone()
    }

    /// Number of inverted or flat triangles, and of quadrilaterals that are not convex.
    #[getter]
    fn inverted(&self) -> usize {
        self.0.inverted
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Statistics,))> {
        let restored = py.import(intern!(py, "gpu_smooth._native"))?;
        Ok((restored.getattr(intern!(py, "restored_quality"))?, (self.0.clone(),)))
    }

    fn __repr__(&self) -> String {
        let Statistics { min_angle, max_angle, worst_imr, inverted, .. } = &self.0;
        format!(
            "Quality(f imr {:.6}, min angle {min_angle:.2}°, max angle {max_angle:.2}°, worst imr {worst_imr:.6}, inverted \
             {inverted})",
            self.by(Metric::Imr)
        )
    }
}
