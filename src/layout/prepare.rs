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
    let is_finite = |&v: &u32| mesh.points[v as usize].iter().all(|x| x.is_finite());
    if let Some(&vertex) = topology.triangles().as_flattened().iter().find(|v| !is_finite(v)) {
        return Err(MeshError::NotFinite { vertex });
    }
    match topology.check_smoothable(&mesh.points) {
        Ok(()) | Err(MeshError::Infeasible { .. } | MeshError::OverlappingStar { .. }) => {}
        Err(error) => return Err(error),
    }
    // A tangled mesh is refused for its triangles before the free vertices are counted.
    if !topology.free().contains(&true) {
        return Err(MeshError::NothingFree { vertices: mesh.points.len() });
    }
    let problem = laid_out(mesh, &topology);
    Ok((topology, problem))
}

/// Colors the free vertices of a mesh and lays the mesh out.
pub(crate) fn laid_out(mesh: &Mesh, topology: &Topology<'_>) -> Problem {
    let curve = along_curve(mesh, topology);
    let coloring = Coloring::along(topology, &curve);
    Problem::along(mesh, topology, &coloring, &curve)
}
