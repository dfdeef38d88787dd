//! The reasons for which vertices of a mesh are fixed.

use crate::error::CliError;
use crate::load::LoadedMesh;
use gpu_smooth::{MeshError, Topology};

/// The reason why a vertex is fixed. If several reasons apply, a vertex has the first one in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FixedBy {
    /// No triangle has the vertex.
    NoTriangle,
    Boundary,
    /// The file lists a point or an element other than triangles and lines at the vertex.
    Element,
    /// The file lists a line at the vertex, or the vertex lies on a curve of the model.
    Line,
    /// Triangles of several regions meet at the vertex.
    Interface,
    /// The vertex is in a boundary layer that `--keep-layers` keeps.
    Layer,
    /// An option fixes the vertex, such as `--fix` or `--only`.
    Option,
    /// The triangles around the vertex form no single fan.
    Connectivity,
}

impl FixedBy {
    const ALL: [Self; 8] = [
        Self::NoTriangle,
        Self::Boundary,
        Self::Element,
        Self::Line,
        Self::Interface,
        Self::Layer,
        Self::Option,
        Self::Connectivity,
    ];

    /// Returns the reason as the end of a sentence, without the option that frees the vertices.
    fn place(self) -> &'static str {
        match self {
            Self::NoTriangle => "in no triangle",
            Self::Boundary => "on the boundary",
            Self::Element => "on points or elements of the file other than lines",
            Self::Line => "on lines of the file",
            Self::Interface => "between regions",
            Self::Layer => "in boundary layers",
            Self::Option => "by options such as --fix and --only",
            Self::Connectivity => "where the triangles around a vertex form no single fan",
        }
    }

    /// Returns the reason as the end of a sentence, with the option that frees the vertices. `slides` is true for a run with
    /// `--slide`.
    pub(crate) fn words(self, slides: bool) -> String {
        let option = match self {
            Self::Boundary if !slides => " (--slide lets vertices slide along it)",
            Self::Line => " (--free-lines lets them move)",
            Self::Interface if !slides => " (--free-interfaces lets them move)",
            Self::Layer => " (--keep-layers none lets them move)",
            _ => "",
        };
        format!("{}{option}", self.place())
    }

    /// Returns the number of fixed vertices for each reason that applies. Copies of vertices, made by the chart, are not
    /// counted. `layers` lists the vertices that boundary layers alone fix.
    pub(crate) fn counts(
        file: &LoadedMesh,
        topology: &Topology<'_>,
        layers: &[u32],
    ) -> Vec<(Self, usize)> {
        let count = file.source.points().len();
        let mut reasons: Vec<Option<Self>> = vec![None; count];
        let mut give = |reason, vertices: &mut dyn Iterator<Item = u32>| {
            let own = vertices.filter(|&v| (v as usize) < count);
            own.for_each(|v| _ = reasons[v as usize].get_or_insert(reason));
        };
        let all = 0..count as u32;
        let (constraints, domain) = (file.constraints(), &file.domain);
        give(Self::NoTriangle, &mut all.clone().filter(|&v| topology.star(v).is_empty()));
        give(Self::Boundary, &mut topology.boundary_edges().into_iter().flatten());
        give(Self::Element, &mut constraints.anchored.iter().copied());
        let held = constraints.vertices.iter().filter(|_| domain.holds_lines());
        give(Self::Line, &mut held.copied());
        let between = file.interface_vertices();
        give(Self::Interface, &mut between.into_iter().filter(|_| domain.holds_interfaces()));
        give(Self::Layer, &mut layers.iter().copied());
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

/// Returns the error for a mesh without free vertices, with the number of vertices for each reason and the option that frees
/// them. `slides` is true for a run with `--slide` in which no vertex can slide, `by_options` if `--fix…` or `--only…` exclude
/// the last free vertices.
pub(crate) fn nothing_free(file: &LoadedMesh, slides: bool, by_options: bool) -> CliError {
    // On the sphere, the mesh may have copies of vertices, which are not counted.
    let error = MeshError::NothingFree { vertices: file.source.points().len() };
    let topology = Topology::new(file.mesh());
    let counts = topology.map(|topology| FixedBy::counts(file, &topology, &[])).unwrap_or_default();
    let reasons: Vec<String> =
        counts.iter().map(|(reason, count)| format!("{count} {}", reason.place())).collect();
    let sliding = if slides { ", and no vertex can slide, as all are corners or held" } else { "" };
    let keeps_quadrilaterals =
        !file.domain.moves_quadrilaterals() && file.source.proper_quadrilaterals().next().is_some();
    let has = |reason| counts.iter().any(|(other, _)| *other == reason);
    let remedy = match (has(FixedBy::Line), has(FixedBy::Interface)) {
        _ if by_options => "--fix, --only and the like leave nothing to smooth: let more move",
        _ if keeps_quadrilaterals => {
            "Let vertices of quadrilaterals move: leave out --quadrilaterals keep"
        }
        (true, true) => {
            "Let vertices on lines move: --free-lines, or vertices between regions: --free-interfaces"
        }
        (true, false) => "Let vertices on lines move: --free-lines",
        (false, true) => "Let vertices between regions move: --free-interfaces",
        _ if slides => "Refine the mesh to get vertices between",
        _ => "There is nothing to smooth, unless --slide lets some of them move along the boundary",
    };
    let path = file.source.path().display();
    CliError::input(format!("{path}: {error}{sliding}: {}", reasons.join(", "))).with_remedy(remedy)
}
