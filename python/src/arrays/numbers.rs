//! Vertex numbers, numbers of triangles, and numbers per vertex.

use gpu_smooth::Mesh;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::arrays::conversion::{
    converted, is_empty, kind, laid_out, matrix, of_shape, rows, typed,
};
use crate::error;

/// Reads triples of vertices: an array of integers of shape (m, 3). The mesh has `vertices` vertices.
pub(crate) fn triangles(
    name: &str,
    value: &Bound<'_, PyAny>,
    vertices: usize,
) -> PyResult<Vec<[u32; 3]>> {
    match is_empty(value, &[3])? {
        true => Ok(Vec::new()),
        false => index_rows(name, value, vertices, "integers of shape (m, 3)"),
    }
}

/// Reads quadrilaterals by their vertices: an array of integers of shape (k, 4), or None.
fn quadrilaterals(value: Option<&Bound<'_, PyAny>>, vertices: usize) -> PyResult<Vec<[u32; 4]>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    let name = "quadrilaterals";
    if value.is_instance_of::<PyString>() {
        let text = format!(
            "{name}: the value is {}, and must be integers of shape (k, 4). Words are for a mesh in place of the arrays",
            value.repr()?
        );
        return Err(error::option(value.py(), &text));
    }
    match is_empty(value, &[4])? {
        true => Ok(Vec::new()),
        false => index_rows(name, value, vertices, "integers of shape (k, 4)"),
    }
}

/// The arguments `triangles` and `quadrilaterals` of a call, as a tuple.
#[derive(FromPyObject)]
pub(crate) struct Cells<'py>(pub(crate) Bound<'py, PyAny>, pub(crate) Option<Bound<'py, PyAny>>);

impl Cells<'_> {
    /// Reads the elements of a mesh with `vertices` vertices, and returns the mesh without points.
    pub(crate) fn read(&self, vertices: usize) -> PyResult<Mesh> {
        let triangles = triangles("triangles", &self.0, vertices)?;
        let quadrilaterals = quadrilaterals(self.1.as_ref(), vertices)?;
        Ok(Mesh { triangles, quadrilaterals, ..Mesh::default() })
    }
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

/// Reads a number per element: an array of shape (count,) of any integer type, first for `triangles` triangles.
pub(crate) fn labels(
    name: &str,
    value: &Bound<'_, PyAny>,
    [triangles, count]: [usize; 2],
) -> PyResult<Vec<i64>> {
    let each = match triangles == count {
        true => "one per triangle".to_owned(),
        false => format!("{triangles} of triangles and {} of quadrilaterals", count - triangles),
    };
    let wanted = format!("integers of shape ({count},), {each}");
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
