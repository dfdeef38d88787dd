//! The quantities of triangles, edges and vertices that thresholds limit.

use std::fmt;
use std::str::FromStr;

use gpu_smooth::measure::{Better, Measure};

/// A number that each triangle, each edge between two triangles, or each vertex of a mesh has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// A measure of triangles, or of edges if [`Measure::is_of_edges`] is true.
    Measure(Measure),
    /// Number of corners of a triangle on the boundary, from 0 to 3.
    BoundaryCorners,
    /// Number of edges around a hole of the mesh, such as an island.
    HoleEdges,
    /// Number of elements at a vertex; inside the mesh, also the number of its neighbors along edges.
    Neighbors,
    /// Least altitude of a triangle, or of the corner triangles of a quadrilateral, over the speed of long waves, in seconds.
    /// Only wet elements have the quantity.
    TimeStep,
}

/// The kind of items to which a quantity belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Triangle,
    Edge,
    /// A hole of the mesh. Messages locate a hole by the first vertex of its boundary.
    Hole,
    Vertex,
}

impl Part {
    /// Returns the name of one part, or of several parts.
    pub(crate) fn noun(self, is_one: bool) -> &'static str {
        match (self, is_one) {
            (Self::Triangle, true) => "triangle",
            (Self::Triangle, false) => "triangles",
            (Self::Edge, true) => "edge",
            (Self::Edge, false) => "edges",
            (Self::Hole, true) => "hole",
            (Self::Hole, false) => "holes",
            (Self::Vertex, true) => "vertex",
            (Self::Vertex, false) => "vertices",
        }
    }
}

impl Quantity {
    /// The quantities that are no measures.
    const OWN: [Self; 4] =
        [Self::BoundaryCorners, Self::HoleEdges, Self::Neighbors, Self::TimeStep];

    /// Returns the name on the command line and in profiles.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Measure(measure) => measure.name(),
            Self::BoundaryCorners => "boundary-corners",
            Self::HoleEdges => "hole-edges",
            Self::Neighbors => "neighbors",
            Self::TimeStep => "time-step",
        }
    }

    /// Returns whether quadrilaterals have the quantity themselves, not only their edges and vertices.
    pub(crate) fn is_of_quadrilaterals(self) -> bool {
        match self {
            Self::Measure(measure) => measure.of_quadrilateral() && !measure.is_of_edges(),
            _ => self == Self::TimeStep,
        }
    }

    /// Returns the measure; `None` for other quantities.
    pub(crate) fn measure(self) -> Option<Measure> {
        match self {
            Self::Measure(measure) => Some(measure),
            _ => None,
        }
    }

    /// Returns the parts of a mesh that have the quantity.
    pub(crate) fn part(self) -> Part {
        match self {
            Self::Measure(measure) if measure.is_of_edges() => Part::Edge,
            Self::Measure(_) | Self::BoundaryCorners | Self::TimeStep => Part::Triangle,
            Self::HoleEdges => Part::Hole,
            Self::Neighbors => Part::Vertex,
        }
    }

    /// Returns whether large or small values are better; `None` if values can be bad in both directions.
    pub(crate) fn better(self) -> Option<Better> {
        match self {
            Self::Measure(measure) => Some(measure.definition().better),
            Self::BoundaryCorners => Some(Better::Lower),
            Self::HoleEdges | Self::TimeStep => Some(Better::Higher),
            Self::Neighbors => None,
        }
    }

    /// Returns the unit that follows a value, with a blank if necessary. Ratios and counts have an empty unit.
    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::Measure(measure) => measure.definition().unit,
            Self::TimeStep => " s",
            Self::BoundaryCorners | Self::HoleEdges | Self::Neighbors => "",
        }
    }

    /// Returns whether values are whole numbers.
    pub(crate) fn is_count(self) -> bool {
        !matches!(self, Self::Measure(_) | Self::TimeStep)
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Quantity {
    type Err = String;

    /// Parses a name. Underscores may replace hyphens.
    fn from_str(text: &str) -> Result<Self, String> {
        let name = text.trim().to_ascii_lowercase().replace('_', "-");
        match Self::OWN.into_iter().find(|own| own.name() == name) {
            Some(own) => Ok(own),
            None => text
                .parse()
                .map(Self::Measure)
                .map_err(|error| format!("{error}, {}", Self::OWN.map(Self::name).join(", "))),
        }
    }
}
