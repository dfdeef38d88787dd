//! Prepares a mesh for the engines: topology, coloring and layout.

use crate::error::MeshError;
use crate::layout::Coloring;
use crate::layout::Problem;
use crate::layout::curve::along_curve;
use crate::mesh::Mesh;
use crate::topology::Topology;

/// Checks a mesh, colors its free vertices and lays it out, as [`Smoother::new`](crate::Smoother::new) does. For
/// callers that drive the sweeps of a run themselves.
///
/// # Errors
/// [`MeshError`] if the mesh cannot be smoothed.
pub fn prepare(mesh: &Mesh) -> Result<(Topology<'_>, Problem), MeshError> {
    let topology = Topology::new(mesh)?;
    topology.check_smoothable(&mesh.points)?;
    let problem = laid_out(mesh, &topology);
    Ok((topology, problem))
}

/// Checks a mesh and lays it out as [`prepare`] does, but accepts a mesh without free vertices, whose boundary vertices
/// may slide.
///
/// # Errors
/// [`MeshError`] if the mesh cannot be smoothed; never [`MeshError::NothingFree`].
pub(crate) fn prepare_to_slide(mesh: &Mesh, topology: &Topology<'_>) -> Result<Problem, MeshError> {
    match topology.check_smoothable(&mesh.points) {
        Ok(()) | Err(MeshError::NothingFree { .. }) => Ok(laid_out(mesh, topology)),
        Err(error) => Err(error),
    }
}

/// Prepares a mesh as [`prepare`] does. If the vertices of `like`, a problem of the same triangles and points, move in a
/// projection, the vertices of the returned problem move in this projection too.
///
/// # Errors
/// [`MeshError`] if the mesh cannot be smoothed.
#[cfg(feature = "gpu")]
pub(crate) fn prepare_like(mesh: &Mesh, like: &Problem) -> Result<Problem, MeshError> {
    let (topology, problem) = prepare(mesh)?;
    let Some(projection) = like.projection else { return Ok(problem) };
    let images = Mesh { points: like.images(&mesh.points).into_owned(), ..mesh.clone() };
    Ok(laid_out(&images, &topology).with_projection(projection))
}

/// Prepares a mesh as [`prepare`] does, but accepts inverted and flat triangles, and triangles that overlap around a
/// vertex.
///
/// # Errors
/// [`MeshError`] if the mesh cannot be smoothed once it is untangled.
#[cfg(feature = "gpu")]
pub(crate) fn prepare_to_untangle(mesh: &Mesh) -> Result<(Topology<'_>, Problem), MeshError> {
    let topology = Topology::new(mesh)?;
    topology.check_finite(&mesh.points)?;
    let tangles = match topology.check_smoothable(&mesh.points) {
        Ok(()) => None,
        Err(error @ (MeshError::Infeasible { .. } | MeshError::OverlappingStar { .. })) => {
            Some(error)
        }
        Err(error) => return Err(error),
    };
    if tangles.is_some()
        && let Some(element) = topology.closed_part()
    {
        return Err(MeshError::Closed { element });
    }
    // A tangled mesh is refused for its triangles before the free vertices are counted.
    if !topology.free().contains(&true) {
        return Err(MeshError::NothingFree { vertices: mesh.points.len() });
    }
    let problem = laid_out(mesh, &topology);
    let (_, scale) = problem.normalization();
    match tangles {
        // A boundary that encloses no area has no length by which untangling could measure triangles.
        Some(tangles) if !(scale.is_finite() && scale > 0.0) => Err(tangles),
        _ => Ok((topology, problem)),
    }
}

/// Colors the free vertices of a mesh and lays the mesh out.
pub(crate) fn laid_out(mesh: &Mesh, topology: &Topology<'_>) -> Problem {
    let curve = along_curve(mesh, topology);
    let coloring = Coloring::along(topology, &curve);
    Problem::along(mesh, topology, &coloring, &curve)
}
