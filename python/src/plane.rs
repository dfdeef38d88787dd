//! Points with third coordinates: in the plane of space in which they lie, or with z as data.

use gpu_smooth::front_ends::Plane;
use gpu_smooth::targets::Surface;
use pyo3::prelude::*;

use crate::arrays::{Points, PointsForm};
use crate::error;
use crate::threads;
use crate::values::{Given, ThirdCoordinate};

/// Returns the meaning of third coordinates that a word names.
pub(crate) fn third_coordinate(value: &Bound<'_, PyAny>) -> PyResult<ThirdCoordinate> {
    Given { name: "z", value }.third_coordinate()
}

/// Lays points out in the plane of space in which they lie, unless third coordinates are missing, equal or data. On the
/// sphere, third coordinates are data.
pub(crate) fn lay_out(
    py: Python<'_>,
    name: &str,
    points: Points,
    z: ThirdCoordinate,
    surface: Surface,
) -> PyResult<Points> {
    if z == ThirdCoordinate::Data || surface == Surface::Sphere {
        return Ok(points);
    }
    let Some(z) = points.form.kept_z() else { return Ok(points) };
    if z.iter().all(|other| *other == z[0]) {
        return Ok(points);
    }
    if let Some(vertex) = z.iter().position(|z| !z.is_finite()) {
        return Err(error::third_coordinate(py, name, vertex, z[vertex]));
    }
    let (Some(space), stored) = (points.space(), points.form.stored()) else { return Ok(points) };
    match threads::detached(py, || Plane::of(space, stored))? {
        Ok(plane) if plane.is_of_xy() => Ok(points),
        Ok(plane) => Ok(points.in_plane(plane)),
        Err(refused) => Err(error::not_planar(py, name, &refused)),
    }
}

/// Lays new points of a mesh out in the plane in which the mesh with the form `of` lies.
pub(crate) fn lay_out_again(
    py: Python<'_>,
    points: Points,
    of: &PointsForm,
    z: ThirdCoordinate,
) -> PyResult<Points> {
    let vertex = match of.plane() {
        Some(plane) => {
            let points = lay_out_likewise(py, "points", points, of)?;
            match points.form.plane().and_then(|new| plane.strays(new).first().copied()) {
                None => return Ok(points),
                Some(vertex) => vertex,
            }
        }
        None => {
            let points = lay_out(py, "points", points, z, Surface::Plane)?;
            match points.form.plane() {
                None => return Ok(points),
                Some(_) => 0,
            }
        }
    };
    Err(error::other_plane(py, vertex as usize))
}

/// Lays points of another mesh, or of another state of a mesh, out in the plane of the points with the form `of`.
pub(crate) fn lay_out_likewise(
    py: Python<'_>,
    name: &str,
    points: Points,
    of: &PointsForm,
) -> PyResult<Points> {
    let Some(plane) = of.plane() else { return Ok(points) };
    match points.space() {
        Some(space) => Ok(points.in_plane(plane.likewise(space))),
        None => Err(error::mesh(
            py,
            &format!(
                "{name}: floating-point numbers of shape (n, 3) are needed, as the mesh is not in the plane of x and y"
            ),
        )),
    }
}
