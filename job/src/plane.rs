//! The plane in which the vertices of a file lie.

use gpu_smooth::front_ends::{NotPlanar, Plane};
use mesh_io::{MeshFile, PointField, ReadError};

use crate::error::PlaneError;
use crate::precision::smoother_precision;

/// Returns the plane of a file; `None` if the mesh has no third coordinates, or equal ones.
///
/// # Errors
/// [`PlaneError::NotPlanar`] if the vertices do not lie in one plane, [`PlaneError::NoZ`] if some vertices of a mesh
/// outside of the plane of x and y lack z, or [`PlaneError::Read`] if the third coordinates cannot be read.
pub fn plane_of_file(file: &MeshFile) -> Result<Option<Plane>, PlaneError> {
    let Some(z) = z_of(file)? else { return Ok(None) };
    let stored = smoother_precision(file.precision());
    let plane =
        Plane::of(in_space(file, &z), stored).map_err(|NotPlanar { vertex, distance }| {
            PlaneError::NotPlanar { place: file.vertex_location(vertex as u32), distance }
        })?;
    if !plane.is_of_xy() && !z.is_replaceable() {
        return Err(PlaneError::NoZ(file.path().to_path_buf()));
    }
    Ok(Some(plane))
}

/// Returns x, y and z of the vertices of a file; `None` if the mesh has no third coordinates, or equal ones.
///
/// # Errors
/// [`ReadError`] if the third coordinates cannot be read.
pub fn points_in_space(file: &MeshFile) -> Result<Option<Vec<[f64; 3]>>, ReadError> {
    Ok(z_of(file)?.map(|z| in_space(file, &z)))
}

/// Returns the third coordinates of vertices at `points` of the plane, as a field for a rewrite of the file. `None` in
/// the plane of x and y, where z stays as it is.
///
/// # Errors
/// [`PlaneError::Read`] if the third coordinates cannot be read, or [`PlaneError::Field`] if `points` does not have one
/// entry per vertex.
pub fn z_field(
    plane: &Plane,
    file: &MeshFile,
    points: &[[f64; 2]],
) -> Result<Option<PointField>, PlaneError> {
    if plane.is_of_xy() {
        return Ok(None);
    }
    let Some(mut z) = z_of(file)? else { return Ok(None) };
    z.set(plane.in_space(points).iter().map(|point| point[2]).collect())?;
    Ok(Some(z))
}

fn z_of(file: &MeshFile) -> Result<Option<PointField>, ReadError> {
    if !file.has_third_coordinates() {
        return Ok(None);
    }
    let named_z = file.point_fields(Some(&["z".to_owned()]))?;
    Ok(named_z.into_iter().find(PointField::is_third_of_points))
}

fn in_space(file: &MeshFile, z: &PointField) -> Vec<[f64; 3]> {
    file.points().iter().zip(z.values()).map(|(&[x, y], &z)| [x, y, z]).collect()
}
