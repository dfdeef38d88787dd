//! The reasons for which vertices of a mesh are fixed.

use crate::load::LoadedMesh;
use gpu_smooth::Topology;

/// The reason why a vertex is fixed. If several reasons apply, a vertex has the first one in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FixedBy {
    /// No triangle has the vertex.
    NoTriangle,
    Boundary,
    /// The file lists lines, points or elements of other kinds at the vertex.
    Constraint,
    /// Triangles of several regions meet at the vertex.
    Interface,
    /// An option fixes the vertex, such as `--fix` or `--only`, or the layers that `--keep-layers` keeps.
    Option,
    /// The triangles around the vertex form no single fan.
    Connectivity,
}

impl FixedBy {
    const ALL: [Self; 6] = [
        Self::NoTriangle,
        Self::Boundary,
        Self::Constraint,
        Self::Interface,
        Self::Option,
        Self::Connectivity,
    ];

    /// Returns the reason as the end of a sentence. `slides` is true for a run with `--slide`.
    pub(crate) fn words(self, slides: bool) -> &'static str {
        match self {
            Self::NoTriangle => "in no triangle",
            Self::Boundary if slides => "on the boundary",
            Self::Boundary => "on the boundary (--slide lets vertices slide along it)",
            Self::Constraint => "on lines, points or other elements of the file",
            Self::Interface if slides => "between regions",
            Self::Interface => "between regions (--free-interfaces lets them move)",
            Self::Option => "in boundary layers, or by options such as --fix and --only",
            Self::Connectivity => "where the triangles around a vertex form no single fan",
        }
    }

    /// Returns the number of fixed vertices for each reason that applies. Copies of vertices, made by the chart, are not
    /// counted.
    pub(crate) fn counts(file: &LoadedMesh, topology: &Topology<'_>) -> Vec<(Self, usize)> {
        let count = file.source.points().len();
        let mut reasons: Vec<Option<Self>> = vec![None; count];
        let mut give = |reason, vertices: &mut dyn Iterator<Item = u32>| {
            let own = vertices.filter(|&v| (v as usize) < count);
            own.for_each(|v| _ = reasons[v as usize].get_or_insert(reason));
        };
        let all = 0..count as u32;
        give(Self::NoTriangle, &mut all.clone().filter(|&v| topology.star(v).is_empty()));
        give(Self::Boundary, &mut topology.boundary_edges().into_iter().flatten());
        give(Self::Constraint, &mut file.source.constraints().vertices.iter().copied());
        let between = file.source.interface_vertices();
        let is_held = file.domain.holds_interfaces();
        give(Self::Interface, &mut between.into_iter().filter(|_| is_held));
        give(Self::Option, &mut file.mesh().fixed.iter().copied());
        give(Self::Connectivity, &mut all.clone());
        let fixed = |reason| {
            let of_reason =
                |v: &u32| !topology.free()[*v as usize] && reasons[*v as usize] == Some(reason);
            (reason, all.clone().filter(of_reason).count())
        };
        Self::ALL.map(fixed).into_iter().filter(|(_, count)| *count > 0).collect()
    }
}
