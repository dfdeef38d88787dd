//! The walls of a mesh: its groups of lines, or its whole boundary.

use std::collections::HashMap;

use gpu_smooth::Topology;
use mesh_io::Group;

use crate::error::CliError;
use crate::load::LoadedMesh;

/// A group of lines, or the whole boundary of a mesh without such groups.
pub(crate) struct Wall {
    pub(crate) name: String,
    pub(crate) edges: Vec<[u32; 2]>,
}

/// Returns the edges of the boundary, of lines and between regions.
pub(crate) fn wall_edges(file: &LoadedMesh, topology: &Topology<'_>) -> Vec<[u32; 2]> {
    let all = topology.boundary_edges().into_iter().chain(file.domain.lines());
    let mut edges: Vec<_> = all.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Returns the groups of lines as walls; the whole boundary if the file has no such groups. `edges` are those of
/// [`wall_edges`]. An edge belongs to the groups that have both of its vertices. Of groups with equal vertices, such as an
/// entity of gmsh and its physical group, only the first is a wall.
pub(crate) fn walls(file: &LoadedMesh, edges: &[[u32; 2]]) -> Result<Vec<Wall>, CliError> {
    let mut lines: Vec<&Group> = Vec::new();
    for group in file.groups_of_lines()? {
        let is_known = |other: &&Group| other.vertices() == group.vertices();
        if !lines.iter().any(is_known) {
            lines.push(group);
        }
    }
    if lines.is_empty() {
        return Ok(vec![Wall { name: "the boundary".into(), edges: edges.to_vec() }]);
    }
    let mut of_vertex: HashMap<u32, Vec<usize>> = HashMap::new();
    for (index, group) in lines.iter().enumerate() {
        for &v in group.vertices() {
            of_vertex.entry(v).or_default().push(index);
        }
    }
    let mut walls: Vec<Wall> =
        lines.iter().map(|group| Wall { name: name(group), edges: Vec::new() }).collect();
    for &edge in edges {
        if let [Some(first), Some(second)] = edge.map(|v| of_vertex.get(&v)) {
            for &group in first.iter().filter(|group| second.contains(group)) {
                walls[group].edges.push(edge);
            }
        }
    }
    Ok(walls)
}

/// Returns the name of a group, else its tag.
pub(super) fn name(group: &Group) -> String {
    match (&group.name, group.tag) {
        (Some(name), _) => name.clone(),
        (None, Some(tag)) => tag.to_string(),
        (None, None) => group.to_string(),
    }
}
