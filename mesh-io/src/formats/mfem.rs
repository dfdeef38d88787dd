//! MFEM's `.mesh`, versions 1.0 to 1.3.
//!
//! The format: <https://mfem.org/mesh-format-v1.0/>. MFEM reads a file word by word. Elements precede the vertices,
//! which are counted from zero. Instead of vertices, a mesh may store the points of a finite element space, its `nodes`.
//! The points of a continuous space of order 1 are the vertices in their order. Other spaces belong to curved and periodic
//! meshes, and are refused.

use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::numbered_nodes::{NodeNames, counted_nodes};
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::syntax::Syntax;
use crate::text::token::quoted;
use crate::visit::items::{CellKind, Element, RegionAttribute};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, nodes, volume};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;

pub(crate) struct Mfem;

/// A list of elements. The list precedes the vertices.
struct List<'a> {
    cursor: Cursor<'a>,
    count: u64,
}

impl FormatReader for Mfem {
    const VERTICES: &'static str = "the list of vertices";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source).with_syntax(Syntax::WORDS);
        // The name of the format and its version.
        cursor.next_row();
        cursor.rest();
        let mut lists = Vec::new();
        loop {
            if !cursor.next_word() {
                return Err(source.error("it has no vertices", "Save the mesh again"));
            }
            let keyword = cursor.token().unwrap_or_default();
            match keyword {
                b"dimension" => {
                    cursor.next_word();
                    match cursor.integer("the dimension")? {
                        2 => {}
                        3 => return Err(volume(cursor, "three dimensions")),
                        other => {
                            let problem = format!("the dimension is {other}");
                            return Err(cursor.error(problem, "Meshes of two dimensions are read"));
                        }
                    }
                }
                b"elements" | b"boundary" => {
                    cursor.next_word();
                    let count = cursor.integer("the number of elements")?;
                    lists.push(List { cursor: cursor.clone(), count });
                    each_row(cursor, count, "elements", visitor, element, |_, _, _, _| Ok(()))?;
                }
                b"attribute_sets" | b"bdr_attribute_sets" => {
                    visitor.unsupported(&format!("the section {}", quoted(keyword)));
                    skip_sets(cursor);
                }
                b"vertices" => break,
                other => {
                    let problem = format!("a section `{}` is not read", quoted(other));
                    let remedy = "Write the mesh with its elements, boundary and vertices alone";
                    return Err(cursor.error(problem, remedy));
                }
            }
        }
        vertices(cursor, visitor)?;
        visitor.region_attributes(vec![RegionAttribute::tags("attribute", 1)]);
        for List { mut cursor, count } in lists {
            visitor.expect_elements(cursor.capacity(count, "1 2 0 1 2\n".len()));
            each_row(
                &mut cursor,
                count,
                "elements",
                visitor,
                element,
                |cursor, visitor, done, read| {
                    let (kind, attribute, nodes) = read;
                    let region = [attribute, 0];
                    visitor.element(cursor, &Element { id: done, kind, region, nodes })
                },
            )?;
        }
        Ok(CoordinateStorage::in_place(Format::Mfem, CoordinateEncoding::TEXT))
    }
}

/// Visits the vertices, with two or three coordinates each.
fn vertices(cursor: &mut Cursor<'_>, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
    cursor.next_word();
    let count = cursor.vertex_count()?;
    cursor.next_word();
    let dimensions = match cursor.is_at_letter() {
        true => node_space(cursor)?,
        false => cursor.integer("the number of coordinates")?,
    };
    let names = NodeNames { one: "a vertex", all: "vertices" };
    let z_values = counted_nodes(cursor, count, dimensions, names, visitor)?;
    visitor.end_nodes(cursor)?;
    z_values.send("z", CoordinateEncoding::TEXT.into(), visitor);
    Ok(())
}

/// Reads the finite element space of `nodes`, up to the first point. Returns the number of coordinates of each point.
///
/// # Errors
/// If the points are not the vertices, or if the x of all points precede the y of all points.
fn node_space(cursor: &mut Cursor<'_>) -> Result<u64, ReadError> {
    for keyword in [&b"nodes"[..], b"FiniteElementSpace", b"FiniteElementCollection:"] {
        match word(cursor) {
            found if found == keyword => {}
            found => {
                let problem = format!("`{}` stands in place of coordinates", quoted(found));
                return Err(cursor.error(problem, "Save it as VTK: Mesh::PrintVTK of MFEM"));
            }
        }
    }
    match word(cursor) {
        b"H1_2D_P1" | b"H1Pos_2D_P1" | b"Linear" => {}
        other => {
            let problem = format!(
                "the points are those of the finite element space {}, as of a curved or periodic mesh",
                quoted(other)
            );
            let remedy =
                "Straighten it in MFEM: mesh.SetCurvature(1), or save it as VTK: Mesh::PrintVTK";
            return Err(cursor.error(problem, remedy));
        }
    }
    let mut number = |keyword: &[u8]| {
        let found = word(cursor);
        if found != keyword {
            let problem = format!("`{}` stands in place of {}", quoted(found), quoted(keyword));
            return Err(cursor.error(problem, CORRECT));
        }
        cursor.next_word();
        cursor.integer(quoted(keyword))
    };
    let dimensions = number(b"VDim:")?;
    match number(b"Ordering:")? {
        1 => Ok(dimensions),
        _ => {
            let problem = "the x of all points precede the y of all points (Ordering: 0)";
            let remedy = "Save the nodes with Ordering::byVDIM: mesh.SetCurvature(1) in MFEM";
            Err(cursor.error(problem, remedy))
        }
    }
}

/// Takes the next word; empty at the end of the file.
fn word<'a>(cursor: &mut Cursor<'a>) -> &'a [u8] {
    cursor.next_word();
    cursor.token().unwrap_or_default()
}

/// Reads an element. Returns its kind, attribute and vertices.
#[inline]
fn element(cursor: &mut Cursor<'_>) -> Result<(CellKind, i64, [u64; 4]), ReadError> {
    let attribute = cursor.signed("the attribute of an element")?;
    let kind = match cursor.integer("the geometry of an element")? {
        0 => CellKind::Point,
        1 => CellKind::Line,
        2 => CellKind::Triangle,
        3 => CellKind::Quadrilateral,
        4..=7 => return Err(volume(cursor, "elements of a volume")),
        other => return Err(cursor.error(format!("{other} is no geometry"), CORRECT)),
    };
    Ok((kind, attribute, nodes(cursor, kind)?))
}

/// Skips the rows of `attribute_sets` or `bdr_attribute_sets`, which name sets of attributes.
fn skip_sets(cursor: &mut Cursor<'_>) {
    loop {
        let mut next = cursor.clone();
        let is_section = !next.next_row()
            || next.token().is_some_and(|word| {
                [&b"boundary"[..], b"vertices", b"bdr_attribute_sets"].contains(&word)
            });
        if is_section {
            // The next word is the keyword of a section.
            cursor.rest();
            return;
        }
        *cursor = next;
        cursor.rest();
    }
}
