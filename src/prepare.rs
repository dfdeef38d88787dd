//! From a mesh to what the engines are given.

use crate::coloring::Coloring;
use crate::error::MeshError;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::topology::Topology;

/// Checks a mesh, colors and lays it out.
pub(crate) fn prepare(mesh: &Mesh) -> Result<(Topology, Problem), MeshError> {
    let topology = Topology::new(mesh)?;
    topology.check_smoothable(&mesh.points)?;
    let coloring = Coloring::new(&topology);
    let problem = Problem::new(mesh, &topology, &coloring);
    Ok((topology, problem))
}
