//! Medit's `.meshb`, versions 1 to 4, in either byte order.
//!
//! The format: libMeshb's handbook, "The Gamma Mesh Format". Lists are chained: the offset of the next list follows
//! each keyword. Version 1 has coordinates in single precision. From version 3 on, offsets have 8 bytes; in version 4,
//! counts, vertex numbers and references have 8 bytes too.

use crate::binary::byte_order::ByteOrder;
use crate::binary::number_field::NumberField;
use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::edit::numbers::{CoordinateEncoding, NumberEncoding};
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::medit::beside::report_solution;
use crate::formats::medit::required::NumberList;
use crate::precision::Precision;
use crate::text::cursor::{CUT_OFF, Cursor};
use crate::visit::items::{CellKind, GroupScope, RegionAttribute};
use crate::visit::reader::FormatReader;
use crate::visit::records::{NodeIds, NodeRecords, Region};
use crate::visit::rows::volume;
use crate::visit::send::{ElementRecords, REWRITE};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

pub(crate) struct MeditBinary;

/// The byte order, and the widths in bytes of numbers in a version of the format.
#[derive(Clone, Copy)]
struct Widths {
    order: ByteOrder,
    precision: Precision,
    place: usize,
    integer: usize,
}

/// A list of elements, kept until the vertices are read, as the list may precede the vertices.
struct List<'a> {
    cursor: Cursor<'a>,
    bytes: &'a [u8],
    kind: CellKind,
    /// Whether a reference follows the vertices of each element.
    referred: bool,
    /// The keyword of the list in text files; also the group name for lists of points.
    name: &'static str,
}

const DIMENSION: i32 = 3;
const VERTICES: i32 = 4;
const END: i32 = 54;

impl FormatReader for MeditBinary {
    const VERTICES: &'static str = "Vertices";
    const NAMES_OTHER_LINES: bool = false;

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        report_solution(source, visitor);
        let cursor = &mut Cursor::new(source);
        let order =
            if source.bytes.first() == Some(&1) { ByteOrder::Little } else { ByteOrder::Big };
        let small = Widths { order, precision: Precision::Single, place: 4, integer: 4 };
        integer(cursor, small, 4, "the code")?;
        let widths = match integer(cursor, small, 4, "the version")? {
            1 => small,
            2 => Widths { precision: Precision::Double, ..small },
            3 => Widths { precision: Precision::Double, place: 8, ..small },
            4 => Widths { precision: Precision::Double, place: 8, integer: 8, order },
            other => {
                let problem = format!("the version is {other}");
                return Err(cursor.error(problem, "Versions 1 to 4 are read"));
            }
        };
        let mut dimension = 0;
        let mut lists: Vec<List<'_>> = Vec::new();
        let mut required = NumberList::all();
        let mut vertices_seen = false;
        loop {
            let keyword = integer(cursor, widths, 4, "a keyword")?;
            if keyword == i64::from(END) {
                break;
            }
            let next = integer(cursor, widths, widths.place, "the place of the next list")?;
            let list = Cursor::clone(cursor);
            match i32::try_from(keyword).unwrap_or(-1) {
                DIMENSION => {
                    dimension = integer(cursor, widths, 4, "the dimension")?;
                    if dimension != 2 && dimension != 3 {
                        let problem = format!("the dimension is {dimension}");
                        return Err(cursor.error(problem, "It is 2, or 3 with a third coordinate"));
                    }
                }
                VERTICES if vertices_seen => {
                    let problem = "this is the second list of Vertices";
                    return Err(cursor.error(problem, "Save each mesh to a separate file"));
                }
                VERTICES => {
                    vertices_seen = true;
                    vertices(cursor, widths, dimension, visitor)?;
                }
                keyword if required.iter().any(|list| list.keyword == keyword) => {
                    let count = integer(cursor, widths, widths.integer, "a count")?;
                    for list in required.iter_mut().filter(|list| list.keyword == keyword) {
                        let what = format!("{}s", list.word);
                        let bytes = items(cursor, count, widths.integer, &what)?;
                        let numbers = bytes.chunks_exact(widths.integer);
                        list.numbers.extend(numbers.map(|number| widths.order.whole(number)));
                    }
                }
                8..=10 | 30 | 33 | 49 | 86..=87 | 96..=103 => {
                    if integer(cursor, widths, widths.integer, "a count")? > 0 {
                        return Err(volume(cursor, "elements of a volume"));
                    }
                }
                // Edges, triangles and quadrilaterals with mid-side nodes.
                24..=25 | 27 | 88..=93 => {
                    if integer(cursor, widths, widths.integer, "a count")? > 0 {
                        let problem = format!(
                            "elements of higher order (keyword {keyword}), which are not read"
                        );
                        return Err(cursor.error(problem, "Save linear elements (Triangles)"));
                    }
                }
                keyword => {
                    let of = match keyword {
                        5 => Some((CellKind::Line, true, "Edges")),
                        6 => Some((CellKind::Triangle, true, "Triangles")),
                        7 => Some((CellKind::Quadrilateral, true, "Quadrilaterals")),
                        13 => Some((CellKind::Point, false, "Corners")),
                        15 => Some((CellKind::Point, false, "RequiredVertices")),
                        _ => None,
                    };
                    if of.is_none() && visitor.asks_for_data() {
                        visitor.unsupported(&format!("the list of keyword {keyword}"));
                    }
                    if let Some((kind, referred, name)) = of {
                        let count = integer(cursor, widths, widths.integer, "a count")?;
                        let size = (kind.nodes() + usize::from(referred)) * widths.integer;
                        let bytes = items(cursor, count, size, "elements")?;
                        lists.push(List { cursor: cursor.clone(), bytes, kind, referred, name });
                    }
                }
            }
            if next == 0 {
                break;
            }
            // The next list must start after the present list: lists that share bytes could not be rewritten
            // independently.
            let end = cursor.at_byte().max(list.at_byte() + 1);
            let place = usize::try_from(next).ok().filter(|&place| place >= end);
            match place {
                Some(place) if place <= source.bytes.len() => {
                    *cursor = list;
                    cursor.skip_bytes(place - cursor.at_byte());
                }
                _ => {
                    let problem = format!(
                        "the next list is announced at byte {next}, which does not follow this list in the file"
                    );
                    return Err(list.error(problem, CUT_OFF));
                }
            }
        }
        if !vertices_seen {
            return Err(source.error("it has no list of Vertices", "Save the mesh again"));
        }
        visitor.end_nodes(cursor)?;
        visitor.region_attributes(vec![RegionAttribute::tags("reference", 1)]);
        for list in &lists {
            elements(list, widths, visitor)?;
        }
        for list in required {
            send_listed(list, &lists, widths, visitor)?;
        }
        let numbers = CoordinateEncoding::adjacent(order, widths.precision);
        Ok(CoordinateStorage::in_place(Format::MeditBinary, numbers))
    }
}

/// Visits the elements of a list of numbers. `lists` are all lists of elements.
fn send_listed(
    list: NumberList,
    lists: &[List<'_>],
    widths: Widths,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    let kind = list.kind;
    let own: Vec<&List<'_>> = lists.iter().filter(|own| own.kind == kind).collect();
    let size = (kind.nodes() + 1) * widths.integer;
    let counts: Vec<u64> = own.iter().map(|list| (list.bytes.len() / size) as u64).collect();
    list.send(&counts, visitor, |list, index| {
        let List { cursor, bytes, .. } = own[list];
        let at = index as usize * size;
        let mut numbers = bytes[at..at + size].chunks_exact(widths.integer);
        let numbers = [(); 4].map(|()| numbers.next().map_or(0, |own| widths.order.signed(own)));
        let place = Cursor::at_byte_offset(cursor.source, cursor.last_taken() + at);
        let nodes = numbers.map(|number| u64::try_from(number).unwrap_or(0));
        Ok((place, nodes, numbers[kind.nodes()]))
    })
}

/// Takes a signed whole number of `size` bytes, 4 or 8. Messages call the number `what`.
fn integer(
    cursor: &mut Cursor<'_>,
    widths: Widths,
    size: usize,
    what: &str,
) -> Result<i64, ReadError> {
    let start = cursor.clone();
    let bytes = cursor.take(size);
    let bytes = bytes.ok_or_else(|| start.error(format!("the file ends before {what}"), CUT_OFF));
    bytes.map(|bytes| widths.order.signed(bytes))
}

/// Takes `count` items of `size` bytes each. Messages call the items `what`.
fn items<'a>(
    cursor: &mut Cursor<'a>,
    count: i64,
    size: usize,
    what: &str,
) -> Result<&'a [u8], ReadError> {
    let start = cursor.clone();
    let bytes = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
    let bytes = bytes.and_then(|bytes| cursor.take(bytes));
    bytes.ok_or_else(|| start.error(format!("the file ends before its {count} {what}"), CUT_OFF))
}

fn vertices(
    cursor: &mut Cursor<'_>,
    widths: Widths,
    dimension: i64,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    let count = integer(cursor, widths, widths.integer, "the number of vertices")?;
    cursor.check_vertex_count(u64::try_from(count).unwrap_or(0))?;
    if dimension == 0 {
        return Err(cursor.error("Vertices stand before the Dimension", "Save the mesh again"));
    }
    let size = widths.precision.bytes();
    let item = dimension as usize * size + widths.integer;
    let bytes = items(cursor, count, item, "vertices")?;
    let start = cursor.last_taken();
    let field = |at: usize| NumberField::new(bytes.get(at..), item, size, widths.order);
    let count = bytes.len() / item;
    let (x, y, ids) = (field(0), field(size), NodeIds::Consecutive(1));
    NodeRecords { count, x, y, x_offset: start, ids }.send(
        visitor,
        |index| Cursor::at_byte_offset(cursor.source, start + index * item),
        |index| {
            let problem = format!("a coordinate of vertex {} is not a finite number", index + 1);
            cursor.error(problem, REWRITE)
        },
    )?;
    if dimension == 3 {
        let mut z_values = ZValues::new(visitor);
        z_values.push_records(field(2 * size), count, start + 2 * size);
        z_values.send("z", NumberEncoding::Binary(widths.order, widths.precision), visitor);
    }
    if visitor.asks_for_groups() {
        for (index, vertex) in (0..).zip(bytes.chunks_exact(item)) {
            let reference = widths.order.signed(&vertex[item - widths.integer..]);
            // A vertex without a reference has the reference 0.
            if reference != 0 {
                visitor.node_group(index, "reference", &GroupLabel::Tag(reference));
            }
        }
    }
    Ok(())
}

fn elements(
    list: &List<'_>,
    widths: Widths,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    let List { cursor, bytes, kind, referred, name } = list;
    // Points have no reference, but the list that contains them is their group.
    let within =
        GroupScope { kind: "list", label: GroupLabel::name(name.as_bytes()), dimension: None };
    visitor.group_scopes(if *referred { &[] } else { std::slice::from_ref(&within) });
    let (kind, size) = (*kind, widths.integer);
    let item = (kind.nodes() + usize::from(*referred)) * size;
    let field = |at: usize| NumberField::new(bytes.get(at..), item, size, widths.order);
    let reference =
        if *referred { Region::Field(field(kind.nodes() * size)) } else { Region::Same(0) };
    let records = ElementRecords {
        kind,
        count: bytes.len() / item,
        first_tag: 1,
        nodes: field(0),
        is_signed: true,
        regions: [reference, Region::Same(0)],
    };
    records.send(visitor, |index, _| {
        Cursor::at_byte_offset(cursor.source, cursor.last_taken() + index * item)
    })
}
