//! Places of triangles, edges and vertices in a mesh file.

use std::fmt;

use mesh_io::{Location, SourceLocation};
use serde_json::{Map, Value, json};

/// A triangle, an edge or a vertex of a mesh file, with its location.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Triangle(SourceLocation),
    /// The locations of both ends, ascending by their ids.
    Edge([SourceLocation; 2]),
    Vertex(SourceLocation),
}

/// Displays the ids and the location, as in `triangle 7 (la.1.ele:18)`.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Triangle(place) => write!(f, "triangle {} ({place})", place.id),
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
    /// Returns an object with the ids, the file and the location: `triangle` or `vertex` with `line` or `byte`, or
    /// `vertices` with `lines` or `bytes`.
    pub(crate) fn json(&self) -> Map<String, Value> {
        match self {
            Self::Triangle(place) => placed("triangle", place),
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
