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
    Ok(laid_out(mesh, topology))
}

/// Prepares a mesh as [`prepare`] does, but accepts a mesh without free vertices, whose boundary vertices may slide.
///
/// # Errors
/// [`MeshError`] if the mesh cannot be smoothed; never [`MeshError::NothingFree`].
pub(crate) fn prepare_to_slide(mesh: &Mesh) -> Result<(Topology<'_>, Problem), MeshError> {
    let topology = Topology::new(mesh)?;
    match topology.check_smoothable(&mesh.points) {
        Ok(()) | Err(MeshError::NothingFree { .. }) => Ok(laid_out(mesh, topology)),
        Err(error) => Err(error),
    }
}

fn laid_out<'m>(mesh: &'m Mesh, topology: Topology<'m>) -> (Topology<'m>, Problem) {
    let curve = along_curve(mesh, &topology);
    let coloring = Coloring::along(&topology, &curve);
    let problem = Problem::along(mesh, &topology, &coloring, &curve);
    (topology, problem)
}
