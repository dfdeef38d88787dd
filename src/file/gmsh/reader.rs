//! What becomes of the nodes and elements: a mesh, or the place of one of them.

use super::kind::Kind;
use super::tags::TagMap;
use super::{Sink, Version, walk};
use crate::error::{Location, ReadError};
use crate::file::row_form::{Labels, Rows};
use crate::file::source::{Parsed, Source, fixed_note};
use crate::file::text::{CORRECT, Cursor};
use crate::mesh::Mesh;
use std::ops::Range;

/// Reads a mesh.
pub(in crate::file) fn parse(source: &Source) -> Result<(Version, Parsed), ReadError> {
    let mut reader = Reader::default();
    let layout = walk(source, &mut reader)?;
    let Reader {
        mesh, x_at, map, first_triangle, rows, quadrilaterals, parametric, on_lower, ..
    } = reader;
    let vertex = map.and_then(|map| map.first_of_run());
    let labels = vertex.map(|vertex| Labels { triangle: first_triangle, vertex });
    let mut notes = Vec::new();
    if quadrilaterals > 0 {
        notes.push(fixed_note(quadrilaterals, "quadrilateral", ""));
    }
    if parametric {
        let note = "nodes have parameters on surfaces of the model, which stay as they are where nodes move";
        notes.push(note.into());
    }
    if on_lower == mesh.points.len() {
        let note = "every vertex lies on a point or curve of the model: all of them stay fixed";
        notes.push(note.into());
    }
    Ok((layout.version, Parsed { mesh, x_at, order: layout.order, labels, rows, notes }))
}

/// Location and tag of a vertex, in a file that was read before.
pub(in crate::file) fn vertex_place(source: &Source, index: usize) -> (Location, u64) {
    find(source, Locator { nodes_before: index, triangles_before: usize::MAX, place: None })
}

/// Location and tag of a triangle, in a file that was read before.
pub(in crate::file) fn triangle_place(source: &Source, index: usize) -> (Location, u64) {
    find(source, Locator { nodes_before: usize::MAX, triangles_before: index, place: None })
}

#[derive(Default)]
struct Reader {
    mesh: Mesh,
    x_at: Vec<usize>,
    /// The tag of each node, until the map is made.
    tags: Vec<u64>,
    map: Option<TagMap>,
    /// The tag of the first triangle.
    first_triangle: u64,
    rows: Vec<Rows>,
    quadrilaterals: u64,
    parametric: bool,
    /// How many nodes lie on points and curves of the model.
    on_lower: usize,
}

impl Sink for Reader {
    const TAKES_AHEAD: bool = true;

    fn expect_nodes(&mut self, count: usize) {
        self.mesh.points.reserve_exact(count);
        self.x_at.reserve_exact(count);
        self.tags.reserve_exact(count);
    }

    #[inline]
    fn node(&mut self, _: &Cursor<'_>, tag: u64, dimension: u64, x_at: usize, at: [f64; 2]) {
        if dimension < 2 {
            // On a point or curve of the model, which may lie inside the domain without being
            // saved as line elements: the interface of two surfaces, say.
            self.on_lower += 1;
            self.mesh.fixed.push(self.tags.len() as u32);
        }
        self.tags.push(tag);
        self.x_at.push(x_at);
        self.mesh.points.push(at);
    }

    fn parametric(&mut self) {
        self.parametric = true;
    }

    fn end_nodes(&mut self, cursor: &Cursor<'_>) -> Result<(), ReadError> {
        let tags = std::mem::take(&mut self.tags);
        match TagMap::new(&tags) {
            Ok(map) => {
                self.map = Some(map);
                Ok(())
            }
            Err(second) => {
                let problem = format!("these are the second coordinates of node {}", tags[second]);
                let remedy = "Give each node a tag of its own";
                let location = cursor.location_of(self.x_at[second]);
                Err(cursor.source.error_at(location, problem, remedy))
            }
        }
    }

    fn expect_elements(&mut self, count: usize) {
        self.mesh.triangles.reserve(count);
    }

    #[inline]
    fn element(
        &mut self,
        cursor: &Cursor<'_>,
        tag: u64,
        kind: Kind,
        nodes: &[u64],
    ) -> Result<(), ReadError> {
        let mut vertices = [0; 4];
        for (vertex, &node) in vertices.iter_mut().zip(nodes) {
            let index = self.map.as_ref().and_then(|map| map.index(node));
            *vertex = index.ok_or_else(|| {
                let kind = kind.name();
                let problem = format!("{kind} {tag} has node {node}, which $Nodes does not list");
                cursor.error(problem, CORRECT)
            })?;
        }
        let [a, b, c, _] = vertices;
        match kind {
            Kind::Triangle if a == b || b == c || c == a => {
                let twice = if b == c { nodes[1] } else { nodes[0] };
                let problem = format!("triangle {tag} lists node {twice} twice");
                Err(cursor.error(problem, "Remove the triangle, or correct its nodes"))
            }
            Kind::Triangle => {
                if self.mesh.triangles.is_empty() {
                    self.first_triangle = tag;
                }
                self.mesh.triangles.push([a, b, c]);
                Ok(())
            }
            Kind::Point | Kind::Line | Kind::Quadrilateral => {
                self.mesh.fixed.extend_from_slice(&vertices[..nodes.len()]);
                self.quadrilaterals += u64::from(kind == Kind::Quadrilateral);
                Ok(())
            }
        }
    }

    fn rows(&mut self, kind: Kind, bytes: Range<usize>, size: usize, tag_at: usize, width: usize) {
        if kind != Kind::Triangle {
            return;
        }
        match self.rows.last_mut() {
            Some(last)
                if (last.bytes.end, last.size, last.number_at) == (bytes.start, size, tag_at) =>
            {
                last.bytes.end = bytes.end;
            }
            _ => {
                let first = self.mesh.triangles.len() - bytes.len() / size;
                self.rows.push(Rows { bytes, first, size, number_at: tag_at, width });
            }
        }
    }
}

/// Finds one node or triangle again. Places are for errors only, so none is kept for each.
struct Locator {
    nodes_before: usize,
    triangles_before: usize,
    place: Option<(Location, u64)>,
}

fn find(source: &Source, mut locator: Locator) -> (Location, u64) {
    // It was read before without error.
    let _ = walk(source, &mut locator);
    locator.place.unwrap_or((Location::Line(1), 0))
}

impl Locator {
    fn count_down(
        before: &mut usize,
        place: &mut Option<(Location, u64)>,
        cursor: &Cursor<'_>,
        tag: u64,
    ) {
        if *before == 0 && place.is_none() {
            *place = Some((cursor.location(), tag));
        }
        *before = before.saturating_sub(1);
    }
}

impl Sink for Locator {
    fn node(&mut self, cursor: &Cursor<'_>, tag: u64, _: u64, _: usize, _: [f64; 2]) {
        Self::count_down(&mut self.nodes_before, &mut self.place, cursor, tag);
    }

    fn element(
        &mut self,
        cursor: &Cursor<'_>,
        tag: u64,
        kind: Kind,
        _: &[u64],
    ) -> Result<(), ReadError> {
        if kind == Kind::Triangle {
            Self::count_down(&mut self.triangles_before, &mut self.place, cursor, tag);
        }
        Ok(())
    }
}
