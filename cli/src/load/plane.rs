//! The plane in which the vertices of a file lie, and its words for the user.

use crate::error::CliError;
use crate::terminal::numbers::sig6;
use gpu_smooth::front_ends::Plane;
use gpu_smooth_job::{PlaneError, plane_of_file, points_in_space};
use mesh_io::{MeshFile, PointField};

/// Returns the plane of a file; `None` if the mesh has no third coordinates, or equal ones.
///
/// # Errors
/// Returns an error if the vertices do not lie in one plane, or if some vertices lack z.
pub(crate) fn of_file(file: &MeshFile) -> Result<Option<Plane>, CliError> {
    plane_of_file(file).map_err(|error| match error {
        PlaneError::NotPlanar { place, distance } => CliError::input(format!(
            "{place}: the mesh is not planar: vertex {} is at a distance of {} from the plane nearest to all vertices",
            place.id,
            sig6(distance)
        ))
        .with_remedy(
            "If z is data of a mesh in x and y, such as the depth of water, add --z data. Curved surfaces are not smoothed",
        ),
        PlaneError::NoZ(path) => {
            CliError::input(format!("{}: some vertices have no z", path.display()))
                .with_remedy("Give each vertex three coordinates, or add --z data if z is data")
        }
        error => unlikely(error),
    })
}

/// Returns the error of a command for errors of third coordinates that have no words of their own.
fn unlikely(error: PlaneError) -> CliError {
    match error {
        PlaneError::Read(error) => error.into(),
        PlaneError::Field(error) => error.into(),
        error => CliError::input(error.to_string()),
    }
}

/// Returns the vertices of `file`, another mesh, in the coordinates of `plane`.
pub(crate) fn likewise(plane: &Plane, file: &MeshFile) -> Result<Plane, CliError> {
    let flat_z = || file.points().iter().map(|&[x, y]| [x, y, 0.0]).collect();
    Ok(plane.likewise(points_in_space(file)?.unwrap_or_else(flat_z)))
}

/// Returns the third coordinates of vertices at `points` of the plane, as a field for a rewrite of the file. `None` in
/// the plane of x and y, where z stays as it is.
pub(crate) fn z_field(
    plane: &Plane,
    file: &MeshFile,
    points: &[[f64; 2]],
) -> Result<Option<PointField>, CliError> {
    gpu_smooth_job::z_field(plane, file, points).map_err(unlikely)
}

/// Names the axes of a view of the mesh; `None` for the plane of x and y.
pub(crate) fn axes_legend(plane: &Plane) -> Option<String> {
    let [across, up] = plane.axes();
    let tilted = if plane.is_tilted() { " in a tilted plane" } else { "" };
    (!plane.is_of_xy()).then(|| format!("{across} to the right, {up} upward{tilted}"))
}

/// Describes a plane for the user; `None` for the plane of x and y.
pub(crate) fn remark(plane: &Plane) -> Option<String> {
    if plane.is_of_xy() {
        return None;
    }
    if plane.is_tilted() {
        let [x, y, z] = plane.normal().map(sig6);
        return Some(format!(
            "the mesh lies in a tilted plane with the normal ({x}, {y}, {z}), and is smoothed in it: positions in options, pictures and reports are lengths u and v in this plane, from the mean of all vertices"
        ));
    }
    let [a, b] = plane.axes();
    Some(format!(
        "the mesh lies in the plane of {a} and {b}, and is smoothed in it: positions in options, pictures and reports are {a} and {b}"
    ))
}
