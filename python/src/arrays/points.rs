//! Points of a mesh, and results in the form of the points.

use gpu_smooth::front_ends::Plane;
use gpu_smooth::options::Precision;
use numpy::{Element, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;

use crate::arrays::conversion::{converted, kind, laid_out, matrix, of_shape, rows, typed};
use crate::error;

/// Points of a mesh, and the form of their array.
#[derive(Default)]
pub(crate) struct Points {
    pub(crate) xy: Vec<[f64; 2]>,
    pub(crate) form: PointsForm,
}

/// The form of an array of points, in which results are returned.
#[derive(Default)]
pub(crate) struct PointsForm {
    third: ThirdColumn,
    is_single: bool,
}

/// The third column of an array of points.
#[derive(Default)]
enum ThirdColumn {
    /// The array has two columns.
    #[default]
    Missing,
    /// Third coordinates, which the result keeps.
    Kept(Vec<f64>),
    /// The plane of three coordinates in which the points are moved.
    InPlane(Plane),
}

impl PointsForm {
    /// Returns the precision of the numbers of the array.
    pub(crate) fn stored(&self) -> Precision {
        if self.is_single { Precision::Single } else { Precision::Double }
    }

    /// Returns the precision to which a run rounds points.
    pub(crate) fn precision(&self) -> Precision {
        self.plane().map_or(self.stored(), Plane::run_precision)
    }

    /// Returns the third coordinates that the result keeps; `None` for an array of two columns, and for points in a plane.
    pub(crate) fn kept_z(&self) -> Option<&[f64]> {
        match &self.third {
            ThirdColumn::Kept(z) => Some(z),
            ThirdColumn::Missing | ThirdColumn::InPlane(_) => None,
        }
    }

    /// Returns the plane in which points of three coordinates are moved; `None` for the plane of x and y.
    pub(crate) fn plane(&self) -> Option<&Plane> {
        match &self.third {
            ThirdColumn::InPlane(plane) => Some(plane),
            ThirdColumn::Missing | ThirdColumn::Kept(_) => None,
        }
    }

    /// Returns points as an array of this form.
    pub(crate) fn array<'py>(
        &self,
        py: Python<'py>,
        points: Vec<[f64; 2]>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let rows = points.len();
        let (numbers, columns) = match &self.third {
            ThirdColumn::Missing => (points.into_flattened(), 2),
            ThirdColumn::Kept(z) => {
                let rows_of = points.iter().zip(z).map(|(&[x, y], &z)| [x, y, z]);
                (rows_of.collect::<Vec<_>>().into_flattened(), 3)
            }
            ThirdColumn::InPlane(plane) => (plane.in_space(&points).into_flattened(), 3),
        };
        match self.is_single {
            false => matrix(py, numbers, [rows, columns]),
            true => matrix(py, numbers.iter().map(|&x| x as f32).collect(), [rows, columns]),
        }
    }
}

impl Points {
    /// Returns x, y and z of the points; `None` for an array of two columns.
    pub(crate) fn space(&self) -> Option<Vec<[f64; 3]>> {
        let z = self.form.kept_z()?;
        Some(self.xy.iter().zip(z).map(|(&[x, y], &z)| [x, y, z]).collect())
    }

    /// Returns the points in the coordinates of their plane.
    pub(crate) fn in_plane(self, plane: Plane) -> Self {
        let xy = plane.points().to_vec();
        let is_single = self.form.is_single;
        Self { xy, form: PointsForm { third: ThirdColumn::InPlane(plane), is_single } }
    }
}

/// Reads points: an array of shape (n, 2) or (n, 3), of float64, float32 or integers, or a nested list of numbers.
pub(crate) fn points(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Points> {
    if let Some(points) = points_of_array(name, value)? {
        return Ok(points);
    }
    let py = value.py();
    let array = converted(name, value, POINTS, &["f", "i", "u"])?;
    // In any byte order.
    let is_single = kind(&array)? == "f" && array.dtype().itemsize() == size_of::<f32>();
    let form = if is_single { intern!(py, "float32") } else { intern!(py, "float64") };
    let array = laid_out(&array, form.as_any())?;
    points_of_array(name, &array)?.ok_or_else(|| of_shape(name, &array, POINTS))
}

const POINTS: &str = "floating-point numbers of shape (n, 2) or (n, 3)";

/// Reads points of an array of floating-point numbers with two dimensions; `None` for everything else.
fn points_of_array(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<Points>> {
    if let Some(array) = typed::<f64>(value)? {
        return columns(name, &array, |x| x, false).map(Some);
    }
    let Some(array) = typed::<f32>(value)? else { return Ok(None) };
    columns(name, &array, f64::from, true).map(Some)
}

/// Returns x and y, and z if the array has three columns.
fn columns<T: Element + Copy>(
    name: &str,
    array: &Bound<'_, PyArray2<T>>,
    number: impl Fn(T) -> f64,
    is_single: bool,
) -> PyResult<Points> {
    let view = array.try_readonly()?;
    let view = view.as_array();
    let (xy, third) = match view.ncols() {
        2 => (rows(view, |row: [T; 2]| row.map(&number)), ThirdColumn::Missing),
        3 => {
            let xy = rows(view, |[x, y, _]: [T; 3]| [number(x), number(y)]);
            (xy, ThirdColumn::Kept(view.column(2).iter().map(|&z| number(z)).collect()))
        }
        _ => return Err(of_shape(name, array.as_any(), POINTS)),
    };
    Ok(Points { xy, form: PointsForm { third, is_single } })
}

/// Fails if a point is not finite.
pub(crate) fn check_finite(py: Python<'_>, name: &str, points: &[[f64; 2]]) -> PyResult<()> {
    let is_finite = |point: &[f64; 2]| point.iter().all(|x| x.is_finite());
    match points.iter().position(|point| !is_finite(point)) {
        Some(vertex) => Err(error::not_finite(py, name, vertex)),
        None => Ok(()),
    }
}
