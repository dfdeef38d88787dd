//! JIGSAW's `.msh`.
//!
//! The format: the help of `loadmsh` and `savemsh` in JIGSAW's interfaces for MATLAB and Python. Lists start with a row
//! `KEY=COUNT` and may stand in any order. Semicolons separate numbers, and points are counted from zero. The row of
//! each point and element ends in a tag.

use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::numbered_nodes::{NodeNames, counted_nodes};
use crate::precision::Precision;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::syntax::Syntax;
use crate::text::token::{integer, key_value, quoted};
use crate::visit::items::{CellKind, Element, RegionAttribute};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, end_of_list, nodes, volume};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::TextNumbers;

pub(crate) struct Jigsaw;

/// A list of the file: a cursor before the first row, and the list's length in rows.
struct List<'a> {
    cursor: Cursor<'a>,
    count: u64,
}

/// The lists of a file besides its points.
#[derive(Default)]
struct Lists<'a> {
    elements: Vec<(CellKind, List<'a>)>,
    /// The last list `VALUE` of the file, with the number of values per row.
    values: Option<(List<'a>, u64)>,
}

impl FormatReader for Jigsaw {
    const VERTICES: &'static str = "POINT";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let cursor = &mut Cursor::new(source).with_syntax(Syntax::SEMICOLONS);
        let mut lists = Lists::default();
        let (mut dimensions, mut points) = (2, None);
        while cursor.next_row() {
            // Other rows belong to lists that are read later, or not at all.
            if !cursor.is_at_letter() {
                continue;
            }
            let (key, values) = key_value(cursor.rest());
            let key = key.to_ascii_uppercase();
            let mut values = values.split(|&byte| byte == b';');
            let first = values.next().unwrap_or_default().trim_ascii();
            let second = values.next().unwrap_or_default().trim_ascii();
            match key.as_slice() {
                b"MSHID" => check_kind(cursor, second)?,
                b"NDIMS" => dimensions = number(cursor, &key, first)?,
                b"POINT" => {
                    if points.is_some() {
                        let problem = "this is the second list of POINT";
                        return Err(cursor.error(problem, CORRECT));
                    }
                    let count = number(cursor, &key, first)?;
                    cursor.check_vertex_count(count)?;
                    let start = cursor.clone();
                    let names = NodeNames { one: "a point", all: "points" };
                    let z_values = counted_nodes(cursor, count, dimensions, names, visitor)?;
                    end_of_list(cursor, count, "points", |cursor| cursor.point("a point"))?;
                    points = Some((List { cursor: start, count }, z_values));
                }
                b"EDGE2" | b"TRIA3" | b"QUAD4" => {
                    let kind = match key[0] {
                        b'E' => CellKind::Line,
                        b'T' => CellKind::Triangle,
                        _ => CellKind::Quadrilateral,
                    };
                    let count = number(cursor, &key, first)?;
                    lists.elements.push((kind, List { cursor: cursor.clone(), count }));
                }
                b"TRIA4" | b"HEXA8" | b"PYRA5" | b"WEDG6" if number(cursor, &key, first)? > 0 => {
                    return Err(volume(cursor, &quoted(&key)));
                }
                b"VALUE" => {
                    let count = number(cursor, &key, first)?;
                    let components = number(cursor, &key, second)?;
                    lists.values = Some((List { cursor: cursor.clone(), count }, components));
                }
                _ if visitor.asks_for_data() => {
                    visitor.unsupported(&format!("what {}= is", quoted(&key)));
                }
                _ => {}
            }
        }
        let Some((points, z_values)) = points else {
            return Err(source.error("it has no POINT", "Save the mesh again"));
        };
        if visitor.asks_for_groups() {
            tags(&points, dimensions, visitor)?;
        }
        visitor.end_nodes(cursor)?;
        z_values.send("z", CoordinateEncoding::TEXT.into(), visitor);
        if let Some((list, components)) = lists.values {
            values(list, components, points.count, visitor)?;
        }
        visitor.region_attributes(vec![RegionAttribute::tags_from_one("tag")]);
        for (kind, List { mut cursor, count }) in lists.elements {
            visitor.expect_elements(cursor.capacity(count, "0;1;2;0\n".len()));
            let row = |cursor: &mut Cursor<'_>| Ok((nodes(cursor, kind)?, tag(cursor)?));
            each_row(
                &mut cursor,
                count,
                "elements",
                visitor,
                row,
                |cursor, visitor, done, (nodes, tag)| {
                    let element = Element { id: done, kind, region: [tag, 0], nodes };
                    visitor.element(cursor, &element)
                },
            )?;
            end_of_list(&cursor, count, "elements", row)?;
        }
        Ok(CoordinateStorage::in_place(Format::Jigsaw, CoordinateEncoding::TEXT))
    }
}

/// Checks that `MSHID` is absent or `EUCLIDEAN-MESH`.
///
/// # Errors
/// For other kinds: grids, and meshes on an ellipsoid.
fn check_kind(cursor: &Cursor<'_>, kind: &[u8]) -> Result<(), ReadError> {
    if kind.is_empty() || kind.eq_ignore_ascii_case(b"EUCLIDEAN-MESH") {
        return Ok(());
    }
    let problem = format!("meshes of kind {} are not supported", quoted(kind));
    Err(cursor.error(problem, "Save a planar mesh (EUCLIDEAN-MESH)"))
}

/// Returns the whole number `value` from the row of the keyword `key`.
fn number(cursor: &Cursor<'_>, key: &[u8], value: &[u8]) -> Result<u64, ReadError> {
    integer(value).ok_or_else(|| {
        let (key, value) = (quoted(key), quoted(value));
        cursor.error(format!("{key}= is followed by `{value}`, not a whole number"), CORRECT)
    })
}

/// Visits the tags of points as groups. Tag 0 means no group.
fn tags(
    points: &List<'_>,
    dimensions: u64,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    let cursor = &mut points.cursor.clone();
    for point in 0..points.count {
        cursor.row(point, points.count, "points")?;
        cursor.tokens(dimensions);
        match tag(cursor)? {
            0 => {}
            tag => visitor.node_group(point as u32, "tag", &GroupLabel::Tag(tag)),
        }
    }
    Ok(())
}

/// Visits the values of points as an array `value`. Values that do not belong to points, one row each, are reported as
/// unsupported.
fn values(
    List { mut cursor, count }: List<'_>,
    components: u64,
    points: u64,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    if count != points || components == 0 {
        visitor.unsupported("values that are not those of points");
        return Ok(());
    }
    if !visitor.point_array(b"value", components, true) {
        return Ok(());
    }
    let mut numbers = TextNumbers::default();
    for done in 0..count {
        cursor.row(done, count, "values")?;
        for _ in 0..components {
            numbers.read(&mut cursor)?;
        }
    }
    visitor.point_numbers(numbers.finish(Precision::Double, None));
    Ok(())
}

/// Reads the tag at the end of a row; 0 if the row ends before.
#[inline]
fn tag(cursor: &mut Cursor<'_>) -> Result<i64, ReadError> {
    if cursor.is_at_end() { Ok(0) } else { cursor.signed("a tag") }
}
