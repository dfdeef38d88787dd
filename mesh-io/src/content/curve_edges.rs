//! Edges of a mesh along which groups of lines and of vertices run.

use crate::content::faces::Faces;
use crate::content::group::{Group, Groups};

/// The faces and lines of a mesh.
pub(crate) struct MeshEdges<'m> {
    pub(crate) vertices: usize,
    pub(crate) triangles: &'m [[u32; 3]],
    pub(crate) other_faces: &'m Faces,
    /// Edges of lines, in any order and direction.
    pub(crate) lines: &'m [[u32; 2]],
    /// Edges between regions, in any order and direction.
    pub(crate) interfaces: Vec<[u32; 2]>,
}

/// The edges along which groups may end.
pub(crate) struct CurveEdges {
    /// Edges of the groups that are edges of a face of the mesh. Ascending, the smaller vertex of each edge first.
    pub(crate) of_groups: Vec<[u32; 2]>,
    /// Edges of the boundary, of lines and between regions, in both directions, ascending. Empty if no group consists
    /// of vertices alone.
    pub(crate) all: Vec<[u32; 2]>,
}

impl CurveEdges {
    pub(crate) fn new(groups: &Groups, mesh: &MeshEdges<'_>) -> Self {
        let mut of_groups: Vec<[u32; 2]> =
            groups.iter().flat_map(|group| group.edges.iter().copied()).collect();
        of_groups.sort_unstable();
        of_groups.dedup();
        let all = match groups.iter().any(Group::is_of_vertices) {
            true => mesh.curves(),
            false => Vec::new(),
        };
        Self { of_groups: mesh.edges_among(&of_groups), all }
    }
}

impl MeshEdges<'_> {
    /// Calls `see` with each edge of each face.
    fn each_edge(&self, mut see: impl FnMut(u32, u32)) {
        let triangles = self.triangles.iter().map(<[u32; 3]>::as_slice);
        for corners in triangles.chain(self.other_faces.iter()) {
            let next = corners.iter().skip(1).chain(corners.first());
            corners.iter().zip(next).for_each(|(&a, &b)| see(a, b));
        }
    }

    /// Returns those of the given ascending edges that are edges of a face, ascending.
    fn edges_among(&self, edges: &[[u32; 2]]) -> Vec<[u32; 2]> {
        // Most edges of faces have a vertex on no edge of a group, and need no search.
        let mut is_listed = vec![false; self.vertices];
        edges.as_flattened().iter().for_each(|&v| is_listed[v as usize] = true);
        let mut is_of_face = vec![false; edges.len()];
        self.each_edge(|a, b| {
            if is_listed[a as usize]
                && is_listed[b as usize]
                && let Ok(at) = edges.binary_search(&[a.min(b), a.max(b)])
            {
                is_of_face[at] = true;
            }
        });
        let found = edges.iter().zip(is_of_face).filter(|(_, is_of_face)| *is_of_face);
        found.map(|(edge, _)| *edge).collect()
    }

    /// Returns the edges of the boundary, of lines and between regions, in both directions, ascending.
    fn curves(&self) -> Vec<[u32; 2]> {
        // The exclusive or of hashed neighbors is 0 at a vertex inside, each neighbor of which occurs in two faces.
        let hash = |v: u32| (u64::from(v) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut neighbors = vec![0; self.vertices];
        self.each_edge(|a, b| {
            neighbors[a as usize] ^= hash(b);
            neighbors[b as usize] ^= hash(a);
        });
        let mut sides = Vec::new();
        self.each_edge(|a, b| {
            if neighbors[a as usize] != 0 && neighbors[b as usize] != 0 {
                sides.push([a.min(b), a.max(b)]);
            }
        });
        sides.sort_unstable();
        let once = sides.chunk_by(|a, b| a == b).filter(|equal| equal.len() == 1);
        let boundary = once.map(|equal| equal[0]);
        let others = self.lines.iter().chain(&self.interfaces).copied();
        let both = boundary.chain(others).flat_map(|[a, b]| [[a, b], [b, a]]);
        let mut all: Vec<[u32; 2]> = both.collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}
