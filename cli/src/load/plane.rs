//! The plane in which the vertices of a file lie, and its words for the user.

use crate::error::CliError;
use crate::terminal::numbers::sig6;
use gpu_smooth::plane::{NotPlanar, Plane};
use gpu_smooth::precision::Precision;
use mesh_io::{MeshFile, PointField};

/// Returns the plane of a file whose numbers have the precision `stored`; `None` if the mesh has no third coordinates, or
/// equal ones.
///
/// # Errors
/// Returns an error if the vertices do not lie in one plane, or if some vertices lack z.
pub(crate) fn of_file(file: &MeshFile, stored: Precision) -> Result<Option<Plane>, CliError> {
    let Some(Space { points: space, is_replaceable }) = in_space(file)? else { return Ok(None) };
    let path = file.path().display();
    let plane = Plane::of(space, stored).map_err(|NotPlanar { vertex, distance }| {
        let place = file.vertex_location(vertex as u32);
        CliError::input(format!(
            "{place}: the mesh is not planar: vertex {} is at a distance of {} from the plane nearest to all vertices",
            place.id,
            sig6(distance)
        ))
        .with_remedy(
            "If z is data of a mesh in x and y, such as the depth of water, add --z data. Curved surfaces are not smoothed",
        )
    })?;
    if !plane.is_of_xy() && !is_replaceable {
        return Err(CliError::input(format!("{path}: some vertices have no z"))
            .with_remedy("Give each vertex three coordinates, or add --z data if z is data"));
    }
    Ok(Some(plane))
}

/// Returns the vertices of `file`, another mesh, in the coordinates of `plane`.
pub(crate) fn likewise(plane: &Plane, file: &MeshFile) -> Result<Plane, CliError> {
    let flat_z = || file.points().iter().map(|&[x, y]| [x, y, 0.0]).collect();
    Ok(plane.likewise(in_space(file)?.map_or_else(flat_z, |space| space.points)))
}

/// Returns the third coordinates of vertices at `points` of the plane, as a field for a rewrite of the file. `None` in
/// the plane of x and y, where z stays as it is.
pub(crate) fn z_field(
    plane: &Plane,
    file: &MeshFile,
    points: &[[f64; 2]],
) -> Result<Option<PointField>, CliError> {
    if plane.is_of_xy() {
        return Ok(None);
    }
    let mut fields = file.point_fields(Some(&["z".to_owned()]))?;
    if fields.is_empty() {
        return Ok(None);
    }
    let mut z = fields.swap_remove(0);
    z.set(plane.in_space(points).iter().map(|point| point[2]).collect())?;
    Ok(Some(z))
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

/// The vertices of a file in space.
struct Space {
    points: Vec<[f64; 3]>,
    /// Whether a rewrite can replace each z.
    is_replaceable: bool,
}

/// Returns the vertices of a file in space; `None` if the mesh has no third coordinates, or equal ones.
fn in_space(file: &MeshFile) -> Result<Option<Space>, CliError> {
    if !file.has_third_coordinates() {
        return Ok(None);
    }
    let fields = file.point_fields(Some(&["z".to_owned()]))?;
    Ok(fields.first().map(|z| {
        let pairs = file.points().iter().zip(z.values());
        let points = pairs.map(|(&[x, y], &z)| [x, y, z]).collect();
        Space { points, is_replaceable: z.is_replaceable() }
    }))
}
