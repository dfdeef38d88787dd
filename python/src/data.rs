//! Functions on arrays beside smoothing: untangling, interpolation of data, and comparison of two states of a mesh.

use gpu_smooth::interpolate::Interpolation;
use gpu_smooth::measure::{Change, Distribution};
use gpu_smooth::targets::Surface;
use gpu_smooth::{Mesh, MeshError, Quality as MeshQuality, Topology, Untangle};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{self, Cells, Points, PointsForm};
use crate::error;
use crate::input::{self, Failure};
use crate::measures::{self, Named, Quality};
use crate::observer::RunObserver;
use crate::plane;
use crate::run_options::RunOptions;
use crate::threads;
use crate::values::Given;

/// Moves free vertices until no triangle is inverted or flat, and all quadrilaterals are convex.
#[pyfunction]
#[pyo3(signature = (points, cells, fixed, z, keep_going, time_limit, on_sweep))]
pub(crate) fn untangle<'py>(
    points: &Bound<'py, PyAny>,
    cells: Cells<'py>,
    fixed: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
    keep_going: &Bound<'py, PyAny>,
    time_limit: &Bound<'py, PyAny>,
    on_sweep: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = points.py();
    let z = plane::third_coordinate(z)?;
    let keep_going = Given { name: "keep_going", value: keep_going }.flag()?;
    let given = Named { name: "points", points };
    let (mut mesh, form) = measures::mesh(given, &cells, z, Surface::Plane)?;
    if !fixed.is_none() {
        mesh.fixed = arrays::vertex_set("fixed", fixed, mesh.points.len())?;
    }
    let options = PyDict::new(py);
    options.set_item("time_limit", time_limit)?;
    options.set_item("on_sweep", on_sweep)?;
    let mut run = RunOptions::default();
    for (name, value) in &options {
        run.set_named(&name, &value, "untangle")?;
    }
    let observer = RunObserver::new(&run);
    let done = threads::watched(py, &observer, || {
        if keep_going {
            let untangle = Untangle::new(&mesh).stored(form.precision());
            let done = untangle.in_plane(form.plane()).observe(input::observe(&observer)).run()?;
            return Ok(Some(done.points));
        }
        input::untangled(&mesh, &form, &observer)
    })?;
    if let Some(raised) = observer.take_raised() {
        return Err(raised);
    }
    let points = done.map_err(|failure: Failure| failure.raised(py))?;
    form.array(py, points.unwrap_or(mesh.points))
}

/// Evaluates data of vertices at new positions of the vertices.
#[pyfunction]
pub(crate) fn interpolate<'py>(
    py: Python<'py>,
    points: &Bound<'py, PyAny>,
    cells: Cells<'py>,
    moved: &Bound<'py, PyAny>,
    values: &Bound<'py, PyAny>,
    on: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let (surface, z) = (measures::surface(on)?, plane::third_coordinate(z)?);
    let given = Named { name: "points", points };
    let (mesh, form) = measures::mesh(given, &cells, z, surface)?;
    let moved = likewise("moved", moved, &mesh, &form)?.xy;
    let count = mesh.points.len();
    let values = arrays::per_vertex("values", values, count)?;
    let taken = threads::detached(py, || {
        let Some(chart) = measures::chart(&mesh, surface, form.precision())? else {
            return interpolated(&mesh, &moved, &values.numbers, values.each);
        };
        let numbers = chart.extended(&values.numbers, values.each);
        let taken = interpolated(chart.mesh(), &chart.continued(&moved), &numbers, values.each);
        // The copies of vertices come last.
        taken.map(|taken| taken[..count * values.each].to_vec())
    })?;
    let taken = taken.map_err(|error| error::of_mesh(py, &error))?;
    match values.is_flat {
        true => Ok(PyArray1::from_vec(py, taken).into_any()),
        false => arrays::matrix(py, taken, [count, values.each]),
    }
}

/// Returns data of the vertices of a mesh, `each` numbers per vertex, at the points `moved` of the vertices.
fn interpolated(
    mesh: &Mesh,
    moved: &[[f64; 2]],
    values: &[f64],
    each: usize,
) -> Result<Vec<f64>, MeshError> {
    let topology = Topology::new(mesh)?;
    Interpolation::new(&topology, &mesh.points, moved)?.apply(values, each)
}

/// Compares two states of a mesh. Returns a dict of keyword arguments for the class `Comparison` of the package.
#[pyfunction]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    before: &Bound<'py, PyAny>,
    after: &Bound<'py, PyAny>,
    cells: Cells<'py>,
    on: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let (surface, z) = (measures::surface(on)?, plane::third_coordinate(z)?);
    let given = Named { name: "before", points: before };
    let (mesh, form) = measures::mesh(given, &cells, z, surface)?;
    let Points { xy: after, form: other } = likewise("after", after, &mesh, &form)?;
    let compared = threads::detached(py, || {
        let chart = measures::chart(&mesh, surface, form.precision())?;
        let continued = chart.as_ref().map(|chart| (chart.mesh(), chart.continued(&after)));
        let (mesh, after) =
            continued.as_ref().map_or((&mesh, &after), |(mesh, after)| (mesh, after));
        let topology = Topology::new(mesh)?;
        let change = Change::between(&topology, &mesh.points, after)?;
        let of = |points: &[[f64; 2]]| MeshQuality::on(surface, points, &topology);
        Ok((change, [of(&mesh.points)?, of(after)?]))
    })?;
    let (change, [was, is]) = compared.map_err(|error| error::of_mesh(py, &error))?;
    let spread = |of: Distribution| (of.median, of.p95, of.most);
    let moved = mesh.points.iter().zip(&after).filter(|(was, is)| was != is).count();
    let all = PyDict::new(py);
    all.set_item("vertices_moved", moved)?;
    let z_changed = match (form.plane(), other.plane()) {
        (Some(plane), Some(other)) => !plane.strays(other).is_empty(),
        _ => form.kept_z() != other.kept_z(),
    };
    all.set_item("z_changed", z_changed)?;
    all.set_item("moved", spread(change.moved))?;
    all.set_item("size_change", spread(change.size))?;
    all.set_item("least_altitude", (change.least_altitude[0], change.least_altitude[1]))?;
    all.set_item("quality_before", Quality::of(was))?;
    all.set_item("quality_after", Quality::of(is))?;
    Ok(all)
}

/// Reads points, one row per vertex of a mesh, in the plane of points of the form `of`.
fn likewise(
    name: &str,
    value: &Bound<'_, PyAny>,
    mesh: &Mesh,
    of: &PointsForm,
) -> PyResult<Points> {
    let points = arrays::points(name, value)?;
    let (given, expected) = (points.xy.len(), mesh.points.len());
    match given == expected {
        true => {
            arrays::check_finite(value.py(), name, &points.xy)?;
            plane::lay_out_likewise(value.py(), name, points, of)
        }
        false => {
            let text = format!(
                "{name}: {given} points are given for the {expected} vertices of the mesh. Pass one row per vertex"
            );
            Err(error::mesh(value.py(), &text))
        }
    }
}
