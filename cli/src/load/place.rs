//! Places of elements, edges and vertices in a mesh file.

use std::fmt;

use gpu_smooth::Element;
use mesh_io::{Location, MeshFile, SourceLocation};
use serde_json::{Map, Value, json};

/// An element, an edge or a vertex of a mesh file, with its location.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Triangle(SourceLocation),
    Quadrilateral(SourceLocation),
    /// The locations of both ends, ascending by their ids.
    Edge([SourceLocation; 2]),
    Vertex(SourceLocation),
}

/// Displays the ids and the location, as in `triangle 7 (la.1.ele:18)`.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Triangle(place) => write!(f, "triangle {} ({place})", place.id),
            Self::Quadrilateral(place) => write!(f, "quadrilateral {} ({place})", place.id),
            Self::Vertex(place) => write!(f, "vertex {} ({place})", place.id),
            Self::Edge([a, b]) => {
                write!(f, "the edge between vertices {} and {} (", a.id, b.id)?;
                match (location(a), location(b)) {
                    (Some((kind, start)), Some((_, end))) => {
                        write!(f, "{kind}s {start} and {end} of {})", a.path.display())
                    }
                    _ => write!(f, "{})", a.path.display()),
                }
            }
        }
    }
}

impl Place {
    /// Returns the places of elements, in the order of `elements`, found in one search of the file.
    ///
    /// # Panics
    /// Panics if the file has no such element.
    pub(crate) fn of_elements(file: &MeshFile, elements: &[Element]) -> Vec<Self> {
        let of_kind = |wants: fn(&Element) -> bool| {
            elements.iter().filter(move |element| wants(element)).map(|element| element.index())
        };
        let is_triangle = |element: &Element| matches!(element, Element::Triangle(_));
        let triangles = file.triangle_locations(of_kind(is_triangle));
        let others = of_kind(|element| matches!(element, Element::Quadrilateral(_)));
        let quadrilaterals = file.quadrilateral_locations(others);
        let place = |element: &Element| match *element {
            Element::Triangle(index) => Self::Triangle(triangles[&index].clone()),
            Element::Quadrilateral(index) => Self::Quadrilateral(quadrilaterals[&index].clone()),
        };
        elements.iter().map(place).collect()
    }

    /// Returns the place of an element.
    ///
    /// # Panics
    /// Panics if the file has no such element.
    pub(crate) fn of_element(file: &MeshFile, element: Element) -> Self {
        Self::of_elements(file, &[element]).remove(0)
    }

    /// Returns the location of an element or a vertex; of the first end of an edge.
    pub(crate) fn location(&self) -> &SourceLocation {
        match self {
            Self::Triangle(place) | Self::Quadrilateral(place) | Self::Vertex(place) => place,
            Self::Edge([place, _]) => place,
        }
    }

    /// Returns an object with the ids, the file and the location: `triangle`, `quadrilateral` or `vertex` with `line` or `byte`, or
    /// `vertices` with `lines` or `bytes`.
    pub(crate) fn json(&self) -> Map<String, Value> {
        match self {
            Self::Triangle(place) => placed("triangle", place),
            Self::Quadrilateral(place) => placed("quadrilateral", place),
            Self::Vertex(place) => placed("vertex", place),
            Self::Edge([a, b]) => {
                let mut object = Map::new();
                object.insert("vertices".into(), json!([a.id, b.id]));
                object.insert("file".into(), a.path.display().to_string().into());
                if let (Some((kind, start)), Some((_, end))) = (location(a), location(b)) {
                    object.insert(format!("{kind}s"), json!([start, end]));
                }
                object
            }
        }
    }
}

/// Returns an object with a number or tag under `key`, and its location in the file.
pub(crate) fn placed(key: &str, place: &SourceLocation) -> Map<String, Value> {
    let mut object = Map::new();
    object.insert(key.to_owned(), place.id.into());
    object.insert("file".into(), place.path.display().to_string().into());
    if let Some((kind, at)) = location(place) {
        object.insert(kind.into(), at.into());
    }
    object
}

/// Returns the line or byte of a location together with its key in JSON; `None` if the location is unknown.
fn location(place: &SourceLocation) -> Option<(&'static str, usize)> {
    match place.location {
        Location::Line(line) => Some(("line", line)),
        Location::Byte(byte) => Some(("byte", byte)),
        Location::Unknown => None,
    }
}
