//! Wavefront's `.obj`, for a mesh in the plane.
//!
//! The format: <http://paulbourke.net/dataformats/obj/>. Vertices are numbered from 1 in file order. Faces and lines
//! may also name vertices by negative numbers, counted back from the last vertex before the row. Texture coordinates
//! and normals are not read.

use crate::content::group_label::GroupLabel;
use crate::content::regions::Interner;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::syntax::Syntax;
use crate::text::token::{integer, quoted};
use crate::visit::items::{CellKind, Element, GroupScope};
use crate::visit::reader::FormatReader;
use crate::visit::rows::all_rows;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::{MeshVisitor, POLYLINES};
use crate::visit::z_values::ZValues;

pub(crate) struct Obj;

/// A row of the file, reduced to the content that the reader uses.
enum Row<'a> {
    /// A vertex: the offset of x, x and y, (the offset of z, z).
    Vertex(usize, [f64; 2], (usize, f64)),
    /// The vertices of a face.
    Face(Corners),
    /// The vertices of a line.
    Line(Corners),
    /// The vertices of a `p` row, each a point.
    Points(Corners),
    /// The row that starts a group, object or material.
    Name(&'a [u8]),
    /// Texture coordinates.
    Texture,
    Other,
}

/// The vertices of an element. Up to four are stored inline, since an allocation for each of millions of elements would
/// be slow.
enum Corners {
    Few([i64; 4], usize),
    Many(Vec<i64>),
}

impl Corners {
    fn push(&mut self, corner: i64) {
        match self {
            Corners::Few(few, count) if *count < few.len() => {
                few[*count] = corner;
                *count += 1;
            }
            Corners::Few(few, _) => {
                let mut many = few.to_vec();
                many.push(corner);
                *self = Corners::Many(many);
            }
            Corners::Many(many) => many.push(corner),
        }
    }

    fn all(&self) -> &[i64] {
        match self {
            Corners::Few(few, count) => &few[..*count],
            Corners::Many(many) => many,
        }
    }
}

impl FormatReader for Obj {
    const VERTICES: &'static str = "the list of v rows";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let start = rows(source);
        let cursor = &mut start.clone();
        let mut count = 0;
        let mut has_texture = false;
        let mut z_values = ZValues::new(visitor);
        all_rows(cursor, visitor, vertex, |cursor, visitor, row| {
            match row {
                Row::Vertex(x_at, at, z) => {
                    count += 1;
                    visitor.node(cursor, count, 2, x_at, at);
                    z_values.push(z);
                }
                Row::Texture => has_texture = true,
                _ => {}
            }
            Ok(())
        })?;
        cursor.check_vertex_count(count)?;
        visitor.end_nodes(cursor)?;
        if has_texture {
            let text = "texture coordinates (vt) stay as they are where vertices move";
            visitor.remark(Remark::Text(text.to_owned()));
        }
        if visitor.asks_for_data() {
            left_out(start.clone(), visitor);
        }
        z_values.send("z", CoordinateEncoding::TEXT.into(), visitor);
        let cursor = &mut start.clone();
        let (mut before, mut faces) = (0, 0);
        let mut names = Interner::default();
        let mut region = [0; 2];
        let mut named = CurrentGroups::default();
        all_rows(cursor, visitor, element, |cursor, visitor, row| {
            match row {
                Row::Vertex(..) => before += 1,
                Row::Name(name) => {
                    let number = i64::from(names.intern(name.to_vec())) + 1;
                    region[usize::from(!name.starts_with(b"usemtl"))] = number;
                    if visitor.asks_for_groups() {
                        named.enter(name);
                        visitor.group_scopes(&named.groups());
                    }
                }
                Row::Face(corners) => {
                    let tag = faces + 1;
                    match corners {
                        Corners::Few([a, b, c, _], 3) if a > 0 && b > 0 && c > 0 => {
                            let nodes = [a, b, c, 0].map(i64::unsigned_abs);
                            let kind = CellKind::Triangle;
                            visitor.element(cursor, &Element { id: tag, kind, region, nodes })?;
                        }
                        corners => {
                            let nodes = counted(cursor, corners.all(), before)?;
                            face(cursor, visitor, tag, region, &nodes)?;
                        }
                    }
                    faces = tag;
                }
                Row::Points(points) => {
                    let nodes = counted(cursor, points.all(), before)?;
                    for &node in &nodes {
                        let (kind, nodes) = (CellKind::Point, [node, 0, 0, 0]);
                        visitor.element(cursor, &Element { id: 0, kind, region, nodes })?;
                    }
                }
                Row::Line(points) => {
                    let nodes = counted(cursor, points.all(), before)?;
                    if nodes.len() > 2 {
                        visitor.unsupported(POLYLINES);
                    }
                    visitor.polyline(cursor, 0, region, &nodes)?;
                }
                Row::Texture | Row::Other => {}
            }
            Ok(())
        })?;
        Ok(CoordinateStorage::in_place(Format::Obj, CoordinateEncoding::TEXT))
    }
}

/// Returns a cursor before the first row. If a line of the file ends in a backslash, the cursor joins lines at
/// backslashes.
fn rows(source: &Source) -> Cursor<'_> {
    let ends_line = |at: usize| matches!(source.bytes[at + 1..], [b'\n', ..] | [b'\r', b'\n', ..]);
    match memchr::memchr_iter(b'\\', &source.bytes).any(ends_line) {
        true => Cursor::new(source).with_syntax(Syntax::JOINED),
        false => Cursor::new(source),
    }
}

/// The material, object and groups to which the next elements belong.
#[derive(Default)]
struct CurrentGroups<'a> {
    material: Option<&'a [u8]>,
    object: Option<&'a [u8]>,
    /// The groups; a row may name several.
    groups: Vec<&'a [u8]>,
}

impl<'a> CurrentGroups<'a> {
    /// Updates the material (`usemtl`), the object (`o`) or the groups (`g`) of later elements from a row of names.
    fn enter(&mut self, row: &'a [u8]) {
        let split = row.iter().position(|&byte| byte <= b' ').unwrap_or(row.len());
        let name = row[split..].trim_ascii();
        let one = (!name.is_empty()).then_some(name);
        match &row[..split] {
            b"usemtl" => self.material = one,
            b"o" => self.object = one,
            _ => {
                let words = name.split(|&byte| byte <= b' ');
                self.groups = words.filter(|word| !word.is_empty() && *word != b"\\").collect();
            }
        }
    }

    /// Returns the groups of later elements. Groups have dimension 2, although elements of any kind may belong to a
    /// group.
    fn groups(&self) -> Vec<GroupScope<'static>> {
        let of = |what, names: &[&[u8]]| -> Vec<_> {
            let one = |name: &&[u8]| GroupScope {
                kind: what,
                label: GroupLabel::name(name),
                dimension: Some(2),
            };
            names.iter().map(one).collect()
        };
        let (material, object) = (self.material.as_slice(), self.object.as_slice());
        [of("material", material), of("object", object), of("group", &self.groups)].concat()
    }
}

/// Returns vertex numbers counted from 1. Negative numbers count back from the `before` vertices that precede the row:
/// -1 is the last.
fn counted(cursor: &Cursor<'_>, vertices: &[i64], before: u64) -> Result<Vec<u64>, ReadError> {
    let number = |&vertex: &i64| {
        let number = match vertex {
            0.. => Some(vertex.unsigned_abs()),
            _ => (before + 1).checked_sub(vertex.unsigned_abs()),
        };
        let problem =
            || format!("vertex {vertex}, counted back from this row, is before the first one");
        number.ok_or_else(|| cursor.error(problem(), CORRECT))
    };
    vertices.iter().map(number).collect()
}

/// Visits a face as a triangle, quadrilateral or polygon. The vertices of a polygon stay fixed.
fn face(
    cursor: &Cursor<'_>,
    visitor: &mut dyn MeshVisitor,
    tag: u64,
    region: [i64; 2],
    corners: &[u64],
) -> Result<(), ReadError> {
    match CellKind::of_polygon(corners.len() as u64) {
        Some(kind @ (CellKind::Triangle | CellKind::Quadrilateral)) => {
            let mut nodes = [0; 4];
            nodes[..corners.len()].copy_from_slice(corners);
            visitor.element(cursor, &Element { id: tag, kind, region, nodes })
        }
        _ => visitor.polygon(cursor, tag, region, corners),
    }
}

/// Reports rows that the reader ignores as unsupported.
#[cold]
fn left_out(mut cursor: Cursor<'_>, visitor: &mut dyn MeshVisitor) {
    while cursor.next_row() {
        match cursor.token() {
            Some(b"v") => {
                // Behind x, y and z, a row may have a weight, or the red, green and blue of a color.
                match std::iter::from_fn(|| cursor.token()).count() {
                    0..=3 => {}
                    4 => visitor.unsupported("weights of vertices"),
                    _ => visitor.unsupported("colors of vertices"),
                }
            }
            Some(b"vt") => visitor.unsupported("texture coordinates"),
            Some(b"vn") => visitor.unsupported("normals"),
            Some(b"mtllib") => visitor.unsupported("the name of a library of materials"),
            Some(b"s") => visitor.unsupported("smoothing groups"),
            _ => {}
        }
    }
}

/// Reads a row in the first pass over the file: a vertex, or else [`Row::Other`].
#[inline]
fn vertex<'a>(cursor: &mut Cursor<'a>) -> Result<Row<'a>, ReadError> {
    match cursor.token() {
        Some(b"v") => {}
        Some(b"vt") => return Ok(Row::Texture),
        _ => return Ok(Row::Other),
    }
    let (x_at, at) = cursor.point("a vertex")?;
    Ok(Row::Vertex(x_at, at, cursor.z_if_any("a vertex")?))
}

/// Reads a row in the second pass over the file: an element or a name. Vertices are only counted in this pass, so their
/// coordinates are not read.
#[inline]
fn element<'a>(cursor: &mut Cursor<'a>) -> Result<Row<'a>, ReadError> {
    let named = b"gou".iter().any(|&first| cursor.is_at(first)).then(|| cursor.clone());
    match cursor.token() {
        Some(b"v") => Ok(Row::Vertex(0, [0.0; 2], (0, 0.0))),
        Some(kind @ (b"f" | b"fo" | b"l" | b"p")) => {
            let mut corners = Corners::Few([0; 4], 0);
            loop {
                // Nearly all corners are plain numbers.
                if let Some(corner) = cursor.signed_up_to(b'/') {
                    corners.push(corner);
                    continue;
                }
                let Some(token) = cursor.token() else { break };
                let end = token.iter().position(|&byte| byte == b'/').unwrap_or(token.len());
                corners.push(signed(&token[..end]).ok_or_else(|| {
                    let problem = format!("a vertex is `{}`, not a whole number", quoted(token));
                    cursor.error(problem, CORRECT)
                })?);
            }
            if corners.all().is_empty() {
                return Err(cursor.error("an element without vertices", CORRECT));
            }
            Ok(match kind {
                b"l" => Row::Line(corners),
                b"p" => Row::Points(corners),
                // `fo` is an old keyword for a face.
                _ => Row::Face(corners),
            })
        }
        Some(b"g" | b"o" | b"usemtl") => {
            Ok(named.map_or(Row::Other, |mut row| Row::Name(row.rest())))
        }
        Some(b"curv" | b"curv2" | b"surf") => {
            let problem = "curves and surfaces of free form are not read";
            Err(cursor.error(problem, "Save the mesh as triangles"))
        }
        _ => Ok(Row::Other),
    }
}

fn signed(token: &[u8]) -> Option<i64> {
    let (digits, sign) = match token.strip_prefix(b"-") {
        Some(digits) => (digits, -1),
        None => (token, 1),
    };
    Some(sign * i64::try_from(integer(digits)?).ok()?)
}
