//! Arrays of NumPy: points, triangles, lists of vertices and numbers per vertex, checked and copied to the types of the
//! library, and results in the form of the arguments.
//!
//! Arrays are converted in one pass, without an array in between, before the library works without Python's lock: other
//! threads may write to the arrays meanwhile. Exact predicates and bounds of indices then hold for the numbers that were
//! read.

use gpu_smooth::plane::Plane;
use gpu_smooth::precision::Precision;
use numpy::ndarray::ArrayView2;
use numpy::{
    Element, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

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

/// Returns numbers as an array of shape `shape`, without a copy.
pub(crate) fn matrix<'py, T: Element>(
    py: Python<'py>,
    numbers: Vec<T>,
    shape: [usize; 2],
) -> PyResult<Bound<'py, PyAny>> {
    Ok(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any())
}

/// Reads points: an array of shape (n, 2) or (n, 3), of float64, float32 or integers, or a nested list of numbers.
pub(crate) fn points(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Points> {
    if let Some(points) = points_of_array(name, value)? {
        return Ok(points);
    }
    let py = value.py();
    let array = converted(name, value, POINTS, &["f", "i", "u"])?;
    let is_single = array.dtype().is_equiv_to(&numpy::dtype::<f32>(py));
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

/// Returns the rows of an array with `N` columns, each mapped by `to`.
fn rows<T: Copy, const N: usize, R>(view: ArrayView2<'_, T>, to: impl Fn([T; N]) -> R) -> Vec<R> {
    match view.as_slice() {
        Some(numbers) => numbers.as_chunks().0.iter().map(|&row| to(row)).collect(),
        None => {
            view.outer_iter().map(|row| to(std::array::from_fn(|column| row[column]))).collect()
        }
    }
}

/// Reads triples of vertices: an array of integers of shape (m, 3). The mesh has `vertices` vertices.
pub(crate) fn triangles(
    name: &str,
    value: &Bound<'_, PyAny>,
    vertices: usize,
) -> PyResult<Vec<[u32; 3]>> {
    index_rows(name, value, vertices, "integers of shape (m, 3)")
}

/// Reads pairs of vertices: an array of integers of shape (k, 2).
pub(crate) fn pairs(
    name: &str,
    value: &Bound<'_, PyAny>,
    vertices: usize,
) -> PyResult<Vec<[u32; 2]>> {
    match is_empty(value, &[2])? {
        true => Ok(Vec::new()),
        false => index_rows(name, value, vertices, "integers of shape (k, 2)"),
    }
}

fn index_rows<const N: usize>(
    name: &str,
    value: &Bound<'_, PyAny>,
    vertices: usize,
    wanted: &str,
) -> PyResult<Vec<[u32; N]>> {
    let rows = Rows { name, vertices, wanted };
    if let Some(array) = typed::<i64>(value)? {
        return rows.of(&array, |v| usize::try_from(v).ok());
    }
    if let Some(array) = typed::<i32>(value)? {
        return rows.of(&array, |v| usize::try_from(v).ok());
    }
    if let Some(array) = typed::<u32>(value)? {
        return rows.of(&array, |v| usize::try_from(v).ok());
    }
    let py = value.py();
    let array = converted(name, value, wanted, &["i", "u"])?;
    let is_unsigned = kind(&array)? == "u";
    let form = if is_unsigned { intern!(py, "uint64") } else { intern!(py, "int64") };
    let array = laid_out(&array, form.as_any())?;
    match (typed::<i64>(&array)?, typed::<u64>(&array)?) {
        (Some(array), _) => rows.of(&array, |v| usize::try_from(v).ok()),
        (_, Some(array)) => rows.of(&array, |v| usize::try_from(v).ok()),
        _ => Err(of_shape(name, &array, wanted)),
    }
}

/// The argument that has rows of vertices.
struct Rows<'a> {
    name: &'a str,
    vertices: usize,
    wanted: &'a str,
}

impl Rows<'_> {
    /// Returns the rows of an array. Fails if an index is negative, or if no vertex has the index.
    fn of<T: Element + Copy + std::fmt::Display, const N: usize>(
        &self,
        array: &Bound<'_, PyArray2<T>>,
        index: impl Fn(T) -> Option<usize>,
    ) -> PyResult<Vec<[u32; N]>> {
        let Self { name, vertices, wanted } = *self;
        let view = array.try_readonly()?;
        let view = view.as_array();
        if view.ncols() != N {
            return Err(of_shape(name, array.as_any(), wanted));
        }
        let known = |v: T| index(v).filter(|&v| v < vertices).and_then(|v| u32::try_from(v).ok());
        // Indices out of range become the largest number, and are looked for only if there are any.
        let read: Vec<[u32; N]> =
            rows(view, |row: [T; N]| row.map(|v| known(v).unwrap_or(u32::MAX)));
        if let Some(at) = read.as_flattened().iter().position(|&v| v == u32::MAX) {
            let (row, column) = (at / N, at % N);
            // Without Python's global lock, another thread may have changed the number since.
            let value = view[[row, column]];
            let at = if N == 1 { row.to_string() } else { format!("{row}, {column}") };
            let text = match vertices.checked_sub(1) {
                Some(last) => format!(
                    "{name}[{at}] is {value}, but points has {vertices} rows: vertices are numbered from 0 to {last}"
                ),
                None => format!("{name}[{at}] is {value}, but points has no rows"),
            };
            return Err(error::mesh(array.py(), &text));
        }
        Ok(read)
    }
}

/// Reads a set of vertices: an array of integers of any shape (k,), or of booleans of shape (n,).
pub(crate) fn vertex_set(
    name: &str,
    value: &Bound<'_, PyAny>,
    vertices: usize,
) -> PyResult<Vec<u32>> {
    let py = value.py();
    let wanted = "vertex numbers of shape (k,), or booleans of shape (n,)";
    if is_empty(value, &[])? {
        return Ok(Vec::new());
    }
    let array = converted(name, value, wanted, &["i", "u", "b"])?;
    if array.ndim() != 1 {
        return Err(of_shape(name, array.as_any(), wanted));
    }
    if kind(&array)? == "b" {
        if array.len() != vertices {
            return Err(of_shape(
                name,
                array.as_any(),
                &format!("booleans of shape ({vertices},), one per vertex"),
            ));
        }
        let array = laid_out(&array, intern!(py, "bool").as_any())?;
        let array = array.cast_into::<PyArray1<bool>>()?;
        let flags = array.try_readonly()?;
        let set = (0..).zip(flags.as_array().iter().copied().collect::<Vec<bool>>());
        return Ok(set.filter(|&(_, is_listed)| is_listed).map(|(v, _)| v).collect());
    }
    let column = array.call_method1(intern!(py, "reshape"), ((-1, 1),))?;
    let column: Vec<[u32; 1]> = index_rows(name, &column, vertices, wanted)?;
    Ok(column.into_flattened())
}

/// Returns the vertices of the option `name` of a mesh with `vertices` vertices, as `smooth` reads them.
#[pyfunction]
#[pyo3(name = "vertex_set")]
pub(crate) fn vertex_set_of<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
    vertices: usize,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let set = vertex_set(name, value, vertices)?;
    Ok(PyArray1::from_vec(value.py(), set.into_iter().map(i64::from).collect()))
}

/// Returns the pairs of vertices of the option `name` of a mesh with `vertices` vertices, as `smooth` reads them.
#[pyfunction]
#[pyo3(name = "pairs")]
pub(crate) fn pairs_of<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
    vertices: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let pairs = pairs(name, value, vertices)?;
    let numbers = pairs.as_flattened().iter().map(|&v| i64::from(v)).collect();
    matrix(value.py(), numbers, [pairs.len(), 2])
}

/// Reads a number per row: an array of shape (count,) of any integer type.
pub(crate) fn labels(name: &str, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<i64>> {
    let wanted = format!("integers of shape ({count},), one per triangle");
    let array = converted(name, value, &wanted, &["i", "u"])?;
    if array.ndim() != 1 || array.len() != count {
        return Err(of_shape(name, array.as_any(), &wanted));
    }
    let array = laid_out(&array, intern!(value.py(), "int64").as_any())?;
    Ok(array.cast_into::<PyArray1<i64>>()?.try_readonly()?.as_array().to_vec())
}

/// Numbers per vertex.
pub(crate) struct PerVertex {
    /// The numbers, vertex by vertex.
    pub(crate) numbers: Vec<f64>,
    /// How many numbers a vertex has.
    pub(crate) each: usize,
    /// Whether the array has one dimension.
    pub(crate) is_flat: bool,
}

/// Reads numbers per vertex: an array of shape (n,) or (n, k).
pub(crate) fn per_vertex(
    name: &str,
    value: &Bound<'_, PyAny>,
    vertices: usize,
) -> PyResult<PerVertex> {
    let py = value.py();
    let wanted = format!("numbers of shape ({vertices},) or ({vertices}, k), one row per vertex");
    let array = converted(name, value, &wanted, &["f", "i", "u"])?;
    let shape = array.shape().to_vec();
    if !(1..=2).contains(&shape.len()) || shape[0] != vertices {
        return Err(of_shape(name, array.as_any(), &wanted));
    }
    let array = laid_out(&array, intern!(py, "float64").as_any())?;
    let flat = array.call_method1(intern!(py, "reshape"), (-1,))?;
    let numbers = flat.cast_into::<PyArray1<f64>>()?.try_readonly()?.as_array().to_vec();
    let each = shape.get(1).copied().unwrap_or(1);
    Ok(PerVertex { numbers, each, is_flat: shape.len() == 1 })
}

/// Returns whether a value is an empty list, or an empty array of numbers whose rows have the shape `row`. NumPy makes an
/// empty list an array of float64 with the shape (0,).
fn is_empty(value: &Bound<'_, PyAny>, row: &[usize]) -> PyResult<bool> {
    let Ok(array) = value.cast::<PyUntypedArray>() else {
        let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
        return Ok(is_list && value.len()? == 0);
    };
    let shape = array.shape();
    let fits = shape == [0] || shape.split_first() == Some((&0, row));
    Ok(fits && ["f", "i", "u"].contains(&&*kind(array)?))
}

/// Fails if a point is not finite.
pub(crate) fn check_finite(py: Python<'_>, name: &str, points: &[[f64; 2]]) -> PyResult<()> {
    let is_finite = |point: &[f64; 2]| point.iter().all(|x| x.is_finite());
    match points.iter().position(|point| !is_finite(point)) {
        Some(vertex) => Err(error::not_finite(py, name, vertex)),
        None => Ok(()),
    }
}

/// Returns an array of two dimensions that has exactly this type and is aligned, without a copy. `None` for everything
/// else.
fn typed<'py, T: Element>(value: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyArray2<T>>>> {
    let py = value.py();
    // Subclasses, such as masked arrays, may mean something else by their numbers.
    if !value.is_exact_instance_of::<PyUntypedArray>() {
        return Ok(None);
    }
    let Ok(array) = value.cast::<PyArray2<T>>() else { return Ok(None) };
    let flags = array.getattr(intern!(py, "flags"))?;
    let is_aligned: bool = flags.getattr(intern!(py, "aligned"))?.extract()?;
    Ok(is_aligned.then(|| array.clone()))
}

/// Converts a value to an array whose kind of numbers is in `kinds`: f, i, u or b, as NumPy names them.
fn converted<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
    wanted: &str,
    kinds: &[&str],
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = value.py();
    let refused = |text: String| error::mesh(py, &text);
    let array = match value.cast::<PyUntypedArray>() {
        Ok(array) => array.clone(),
        Err(_) => {
            let numpy = py.import(intern!(py, "numpy"))?;
            let made = numpy.call_method1(intern!(py, "asarray"), (value,)).map_err(|error| {
                match error.is_instance_of::<pyo3::exceptions::PyException>(py) {
                    true => refused(format!(
                        "{name}: {wanted} are needed, and no array can be made: {error}"
                    )),
                    false => error,
                }
            })?;
            made.cast_into::<PyUntypedArray>()?
        }
    };
    let masked = py.import(intern!(py, "numpy.ma"))?.getattr(intern!(py, "MaskedArray"))?;
    if array.is_instance(&masked)? {
        return Err(refused(format!(
            "{name}: masked arrays are not accepted. Pass an array without a mask"
        )));
    }
    // NumPy makes an empty list an array of float64.
    let is_empty_list = array.len() == 0 && value.cast::<PyUntypedArray>().is_err();
    if kinds.contains(&kind(&array)?.as_str()) || is_empty_list {
        return Ok(array);
    }
    // NumPy makes an object that is no sequence an array without dimensions.
    if array.ndim() == 0 && kind(&array)? == "O" {
        let found = value.get_type().name()?;
        return Err(refused(format!(
            "{name}: {wanted} are needed, not an object of type {found}. Pass an array or a list"
        )));
    }
    let found = array.dtype().str()?;
    let remedy = match kinds.contains(&"f") {
        true => "Convert the array by .astype(float)",
        false => "Convert the array by .astype(int)",
    };
    Err(refused(format!("{name}: {wanted} are needed, not numbers of type {found}. {remedy}")))
}

/// Returns NumPy's letter for the kind of an array's numbers.
fn kind(array: &Bound<'_, PyUntypedArray>) -> PyResult<String> {
    Ok(char::from(array.dtype().kind()).to_string())
}

/// Returns a contiguous and aligned array of the given type, copied if necessary.
fn laid_out<'py>(
    array: &Bound<'py, PyUntypedArray>,
    dtype: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = array.py();
    let numpy = py.import(intern!(py, "numpy"))?;
    let array = numpy.call_method1(intern!(py, "asarray"), (array,))?;
    numpy.call_method1(intern!(py, "require"), (array, dtype, ["C", "A"]))
}

/// Returns the error of an array with a wrong shape.
fn of_shape(name: &str, array: &Bound<'_, PyAny>, wanted: &str) -> PyErr {
    let py = array.py();
    let shape = array.getattr(intern!(py, "shape")).and_then(|shape| shape.str());
    let shape = shape.map_or_else(|_| "unknown".to_owned(), |shape| shape.to_string());
    error::mesh(py, &format!("{name}: {wanted} are needed, but the shape is {shape}"))
}
