//! STL, as text and in binary, for a mesh in a plane.
//!
//! The format: <https://www.fabbers.com/tech/STL_Format>. An STL lists the corners of each triangle, and has no
//! vertices. A mesh is read only if the user asks to join corners with equal coordinates. Normals are not read, as they
//! stay right where vertices move in the plane of the mesh.

use crate::binary::byte_order::ByteOrder;
use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::precision::Precision;
use crate::text::cursor::{CORRECT, CUT_OFF, Cursor};
use crate::text::token::quoted;
use crate::visit::items::{CellKind, Element, GroupScope};
use crate::visit::reader::FormatReader;
use crate::visit::rows::all_rows;
use crate::visit::storage::{CoordinateStorage, RepeatedVertices};
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;
use std::collections::HashMap;

pub(crate) struct Stl;

/// The size of a binary file's header in bytes. The triangle count, 4 bytes, and the triangles follow the header.
const HEADER: usize = 80;
/// The offset of the first triangle in a binary file.
const START: usize = HEADER + 4;
/// The size of a binary triangle in bytes: a normal and three corners of three floats each, and an attribute of two
/// bytes.
const TRIANGLE: usize = 50;

/// The triangles of a file, which share no vertices.
#[derive(Default)]
struct TriangleSoup<'a> {
    /// The offset of each triangle in the file, and the index of its solid in `solids`.
    triangles: Vec<(usize, u32)>,
    /// The offset of each corner's x, ascending, three for each triangle.
    x_at: Vec<usize>,
    corners: Vec<[f64; 3]>,
    /// The offset of each corner's z, in the order of `x_at`.
    z_at: Vec<usize>,
    /// The names of the solids.
    solids: Vec<&'a [u8]>,
}

/// A row of a text file.
enum Row<'a> {
    Solid(&'a [u8]),
    Facet(usize),
    /// The offsets of x and z, and the coordinates.
    Vertex(usize, usize, [f64; 3]),
    EndFacet,
    EndSolid,
    Other,
}

impl FormatReader for Stl {
    const VERTICES: &'static str = "the list of corners";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        if !source.options.welds {
            return Err(ReadError::Unwelded { path: source.path.clone() });
        }
        let is_binary = is_binary(&source.bytes);
        let (soup, format, numbers) = match is_binary {
            true => {
                let numbers = CoordinateEncoding::adjacent(ByteOrder::Little, Precision::Single);
                (binary(source, visitor)?, Format::StlBinary, numbers)
            }
            false => (text(source, visitor)?, Format::Stl, CoordinateEncoding::TEXT),
        };
        let copies = send_mesh(source, soup, numbers, visitor)?;
        Ok(CoordinateStorage {
            repeated_vertices: Some(copies),
            ..CoordinateStorage::in_place(format, numbers)
        })
    }
}

/// Returns whether a file is binary. Some binary files start with `solid` as text does, but text has no zero bytes.
fn is_binary(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let begin = text.trim_ascii_start().get(..5);
    let first = &bytes[..bytes.len().min(512)];
    !begin.is_some_and(|w| w.eq_ignore_ascii_case(b"solid")) || memchr::memchr(0, first).is_some()
}

/// Returns the triangle count of a binary file; `None` if the file ends before the count.
fn announced(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER..START)?;
    usize::try_from(ByteOrder::Little.whole(count)).ok()
}

fn binary<'a>(
    source: &'a Source,
    visitor: &mut dyn MeshVisitor,
) -> Result<TriangleSoup<'a>, ReadError> {
    let order = ByteOrder::Little;
    let bytes = source.bytes.as_slice();
    let at = |at: usize| Cursor::at_byte_offset(source, at);
    let Some(count) = announced(bytes) else {
        return Err(at(0).error("the file ends before its count", CUT_OFF));
    };
    let length = count.checked_mul(TRIANGLE);
    let Some(listed) = length.and_then(|length| bytes[START..].get(..length)) else {
        let problem = format!("the file ends before its {count} triangles");
        return Err(at(HEADER).error(problem, CUT_OFF));
    };
    let mut soup = TriangleSoup::default();
    soup.triangles.reserve_exact(count);
    soup.x_at.reserve_exact(3 * count);
    soup.corners.reserve_exact(3 * count);
    let mut has_attributes = false;
    for (index, triangle) in listed.chunks_exact(TRIANGLE).enumerate() {
        let start = START + index * TRIANGLE;
        soup.triangles.push((start, 0));
        for corner in [12, 24, 36] {
            let [x, y, z] = [0, 4, 8]
                .map(|axis| order.real(Precision::Single, &triangle[corner + axis..][..4]));
            let place = at(start + corner);
            if ![x, y, z].iter().all(|x| x.is_finite()) {
                let problem = format!("a corner of triangle {} is not finite", index + 1);
                return Err(place.error(problem, "Write the mesh again"));
            }
            soup.corner(start + corner, start + corner + 8, [x, y, z]);
        }
        has_attributes |= triangle[48..] != [0, 0];
    }
    if has_attributes && visitor.asks_for_data() {
        visitor.unsupported("attributes of an STL's triangles");
    }
    Ok(soup)
}

fn text<'a>(
    source: &'a Source,
    visitor: &mut dyn MeshVisitor,
) -> Result<TriangleSoup<'a>, ReadError> {
    let cursor = &mut Cursor::new(source);
    let mut soup = TriangleSoup::default();
    let mut is_open = false;
    all_rows(cursor, visitor, row, |cursor, _, row| {
        let missing = 3 * soup.triangles.len() - soup.x_at.len();
        match row {
            Row::Other => {}
            Row::Vertex(..) if missing == 0 => {
                return Err(cursor.error("a vertex beyond the three of a facet", CORRECT));
            }
            Row::Vertex(x_at, z_at, corner) => soup.corner(x_at, z_at, corner),
            _ if missing > 0 => {
                let problem = format!("the facet has {} vertices, not three", 3 - missing);
                return Err(cursor.error(problem, CORRECT));
            }
            Row::Solid(_) | Row::Facet(_) if is_open != matches!(row, Row::Facet(_)) => {
                let problem = "`solid` and `endsolid` do not alternate";
                return Err(cursor.error(problem, CORRECT));
            }
            Row::Solid(name) => {
                is_open = true;
                soup.solids.push(name);
            }
            Row::Facet(at) => soup.triangles.push((at, soup.solids.len() as u32 - 1)),
            Row::EndFacet => {}
            Row::EndSolid => is_open = false,
        }
        Ok(())
    })?;
    match is_open || soup.solids.is_empty() {
        true => Err(cursor.error("the file ends before `endsolid`", CUT_OFF)),
        false => Ok(soup),
    }
}

#[inline]
fn row<'a>(cursor: &mut Cursor<'a>) -> Result<Row<'a>, ReadError> {
    let start = cursor.at();
    let word = cursor.token().unwrap_or_default();
    let is = |name: &str| word.eq_ignore_ascii_case(name.as_bytes());
    if is("vertex") {
        let (x_at, [x, y]) = cursor.point("a vertex")?;
        let z_at = cursor.at();
        return Ok(Row::Vertex(x_at, z_at, [x, y, cursor.coordinate('z', "a vertex")?]));
    }
    match () {
        () if is("facet") => Ok(Row::Facet(start)),
        () if is("endloop") || is("endfacet") => Ok(Row::EndFacet),
        () if is("outer") => Ok(Row::Other),
        () if is("solid") => Ok(Row::Solid(cursor.rest())),
        () if is("endsolid") => Ok(Row::EndSolid),
        () => {
            let problem = format!("a row starts with `{}`", quoted(word));
            Err(cursor.error(problem, CORRECT))
        }
    }
}

impl TriangleSoup<'_> {
    /// Adds the next corner, with the offsets of its first and third coordinate.
    #[inline]
    fn corner(&mut self, x_at: usize, z_at: usize, corner: [f64; 3]) {
        self.x_at.push(x_at);
        self.z_at.push(z_at);
        self.corners.push(corner);
    }
}

/// Returns for each corner the index of the first corner with equal coordinates.
fn first_equal_corners(corners: &[[f64; 3]]) -> Vec<u32> {
    let mut first = HashMap::new();
    // Adding zero makes a negative zero positive, so both zeros are one place.
    let places = corners.iter().map(|corner| corner.map(|x| (x + 0.0).to_bits()));
    (0..).zip(places).map(|(corner, place)| *first.entry(place).or_insert(corner)).collect()
}

/// Merges corners with equal coordinates into vertices, in the order of their first corners, and visits vertices and
/// triangles. Returns all corners of each vertex.
fn send_mesh(
    source: &Source,
    soup: TriangleSoup<'_>,
    encoding: CoordinateEncoding,
    visitor: &mut dyn MeshVisitor,
) -> Result<RepeatedVertices, ReadError> {
    let TriangleSoup { triangles, x_at, corners, z_at, solids } = soup;
    let mut place = match encoding {
        CoordinateEncoding::Binary { .. } => Cursor::at_byte_offset(source, 0),
        _ => Cursor::new(source),
    };
    place.check_vertex_count(corners.len() as u64)?;
    let first = first_equal_corners(&corners);
    let count = (0..).zip(&first).filter(|&(corner, first)| corner == *first).count();
    visitor.expect_nodes(count);
    let mut vertices: Vec<u32> = Vec::with_capacity(corners.len());
    let mut next = 0;
    for (corner, &first) in first.iter().enumerate() {
        if first as usize == corner {
            place.seek(x_at[corner]);
            vertices.push(next);
            next += 1;
            let [x, y, _] = corners[corner];
            visitor.node(&place, u64::from(next), 2, x_at[corner], [x, y]);
        } else {
            vertices.push(vertices[first as usize]);
        }
    }
    visitor
        .remark(Remark::Text(format!("{} corners are joined to {count} vertices", corners.len())));
    visitor.end_nodes(&place)?;
    let mut z_values = ZValues::new(visitor);
    z_at.into_iter().zip(&corners).for_each(|(at, corner)| z_values.push((at, corner[2])));
    let nodes = || vertices.iter().map(|&vertex| u64::from(vertex) + 1).collect();
    z_values.of_nodes(nodes).send("z", encoding.into(), visitor);
    visitor.expect_elements(triangles.len());
    place.seek(0);
    let mut last = None;
    for (index, (&(at, solid), corners)) in triangles.iter().zip(vertices.chunks(3)).enumerate() {
        if visitor.asks_for_groups() && last.replace(solid) != Some(solid) {
            let name = solids.get(solid as usize).filter(|name| !name.is_empty());
            let group = |name: &&[u8]| GroupScope {
                kind: "solid",
                label: GroupLabel::name(name),
                dimension: None,
            };
            visitor.group_scopes(name.map(group).as_slice());
        }
        place.seek(at);
        let mut nodes = [0; 4];
        nodes.iter_mut().zip(corners).for_each(|(node, &v)| *node = u64::from(v) + 1);
        let (id, kind) = (index as u64 + 1, CellKind::Triangle);
        visitor.element(&place, &Element { id, kind, region: [i64::from(solid), 0], nodes })?;
    }
    Ok(RepeatedVertices { x_at, vertices })
}
