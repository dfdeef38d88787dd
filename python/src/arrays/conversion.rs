//! Conversion of arguments to arrays of one type, with errors that name the argument, and of numbers to arrays.

use numpy::ndarray::ArrayView2;
use numpy::{
    Element, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::error;

/// Returns numbers as an array of shape `shape`, without a copy.
pub(crate) fn matrix<'py, T: Element>(
    py: Python<'py>,
    numbers: Vec<T>,
    shape: [usize; 2],
) -> PyResult<Bound<'py, PyAny>> {
    Ok(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any())
}

/// Returns the rows of an array with `N` columns, each mapped by `to`.
pub(super) fn rows<T: Copy, const N: usize, R>(
    view: ArrayView2<'_, T>,
    to: impl Fn([T; N]) -> R,
) -> Vec<R> {
    match view.as_slice() {
        Some(numbers) => numbers.as_chunks().0.iter().map(|&row| to(row)).collect(),
        None => {
            view.outer_iter().map(|row| to(std::array::from_fn(|column| row[column]))).collect()
        }
    }
}

/// Returns whether a value is an empty list, or an empty array of numbers whose rows have the shape `row`. NumPy makes an
/// empty list an array of float64 with the shape (0,).
pub(super) fn is_empty(value: &Bound<'_, PyAny>, row: &[usize]) -> PyResult<bool> {
    let Ok(array) = value.cast::<PyUntypedArray>() else {
        let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
        return Ok(is_list && value.len()? == 0);
    };
    let shape = array.shape();
    let fits = shape == [0] || shape.split_first() == Some((&0, row));
    Ok(fits && ["f", "i", "u"].contains(&&*kind(array)?))
}

/// Returns an array of two dimensions that has exactly this type and is aligned, without a copy. `None` for everything
/// else.
pub(super) fn typed<'py, T: Element>(
    value: &Bound<'py, PyAny>,
) -> PyResult<Option<Bound<'py, PyArray2<T>>>> {
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
pub(super) fn converted<'py>(
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
        // The functions that take a mesh convert it before, unless triangles were passed too.
        let or = if name == "points" { ", or a mesh alone in place of both arrays" } else { "" };
        return Err(refused(format!(
            "{name}: {wanted} are needed, not an object of type {found}. Pass an array or a list{or}"
        )));
    }
    if !kinds.contains(&"f") && ["U", "S"].contains(&kind(&array)?.as_str()) {
        return Err(refused(format!(
            "{name}: {wanted} are needed, not text. Pass numbers; names of groups need a mesh with groups in \
             place of the arrays"
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
pub(super) fn kind(array: &Bound<'_, PyUntypedArray>) -> PyResult<String> {
    Ok(char::from(array.dtype().kind()).to_string())
}

/// Returns a contiguous and aligned array of the given type, copied if necessary.
pub(super) fn laid_out<'py>(
    array: &Bound<'py, PyUntypedArray>,
    dtype: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = array.py();
    let numpy = py.import(intern!(py, "numpy"))?;
    let array = numpy.call_method1(intern!(py, "asarray"), (array,))?;
    numpy.call_method1(intern!(py, "require"), (array, dtype, ["C", "A"]))
}

/// Returns the error of an array with a wrong shape.
pub(super) fn of_shape(name: &str, array: &Bound<'_, PyAny>, wanted: &str) -> PyErr {
    let py = array.py();
    let shape = array.getattr(intern!(py, "shape")).and_then(|shape| shape.str());
    let shape = shape.map_or_else(|_| "unknown".to_owned(), |shape| shape.to_string());
    error::mesh(py, &format!("{name}: {wanted} are needed, but the shape is {shape}"))
}
