//! Medit's `.mesh`, as text.
//!
//! The format: Frey, MEDIT: An interactive mesh visualization software, INRIA RT-0253 (2001), and the documentation of
//! mmg and libMeshb. Corners, required vertices, and the vertices of edges and of required triangles and quadrilaterals
//! stay fixed. Vertices of required edges and ridges do not slide either.

use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::medit::beside::report_solution;
use crate::formats::medit::required::NumberList;
use crate::text::cursor::{CUT_OFF, Cursor};
use crate::text::syntax::Syntax;
use crate::text::token::{float, quoted};
use crate::visit::items::{CellKind, Element, GroupScope, RegionAttribute};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{each_row, nodes, volume};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

pub(crate) struct Medit;

/// Prefixes of keywords for volume elements, of first or higher order.
const VOLUMES: [&[u8]; 4] = [b"Tetrahedra", b"Hexahedra", b"Prisms", b"Pyramids"];

/// A list of elements. The list may precede the vertices.
#[derive(Clone)]
struct List<'a> {
    /// The cursor before the first element.
    cursor: Cursor<'a>,
    count: u64,
    kind: CellKind,
    keyword: &'a [u8],
}

impl<'a> List<'a> {
    /// Visits the elements. Returns the cursor after the last element.
    fn send(self, visitor: &mut dyn MeshVisitor) -> Result<Cursor<'a>, ReadError> {
        let List { mut cursor, count, kind, keyword } = self;
        // Points have no reference, but the list that contains them is their group.
        let list = GroupScope { kind: "list", label: GroupLabel::name(keyword), dimension: None };
        visitor.group_scopes(if kind == CellKind::Point {
            std::slice::from_ref(&list)
        } else {
            &[]
        });
        if kind == CellKind::Triangle {
            visitor.expect_elements(cursor.capacity(count, "1 2 3 0\n".len()));
        }
        each_row(
            &mut cursor,
            count,
            "elements",
            visitor,
            |cursor| element(cursor, kind),
            |cursor, visitor, done, (nodes, reference)| {
                let element = Element { id: done + 1, kind, region: [reference, 0], nodes };
                visitor.element(cursor, &element)
            },
        )?;
        Ok(cursor)
    }
}

impl FormatReader for Medit {
    const VERTICES: &'static str = "Vertices";
    const NAMES_OTHER_LINES: bool = false;

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        report_solution(source, visitor);
        let cursor = &mut Cursor::new(source).with_syntax(Syntax::WORDS);
        let mut lists: Vec<List<'_>> = Vec::new();
        let mut required = NumberList::all();
        let mut dimension = 2;
        let mut vertices_seen = false;
        while cursor.next_word() {
            let keyword = cursor.token().unwrap_or_default();
            match keyword {
                b"End" => break,
                b"MeshVersionFormatted" => {
                    value(cursor, "the version")?;
                }
                b"Dimension" => {
                    dimension = value(cursor, "the dimension")?;
                    if dimension != 2 && dimension != 3 {
                        let problem = format!("the dimension is {dimension}");
                        return Err(cursor.error(problem, "It is 2, or 3 with a third coordinate"));
                    }
                }
                b"Vertices" => {
                    if std::mem::replace(&mut vertices_seen, true) {
                        let problem = "this is the second list of Vertices";
                        return Err(cursor.error(problem, "Save each mesh to a separate file"));
                    }
                    vertices(cursor, dimension, visitor)?;
                    visitor.end_nodes(cursor)?;
                    visitor.region_attributes(vec![RegionAttribute::tags("reference", 1)]);
                    for list in &lists {
                        list.clone().send(visitor)?;
                    }
                }
                volume_of if VOLUMES.iter().any(|name| volume_of.starts_with(name)) => {
                    if value(cursor, "a count")? > 0 {
                        return Err(volume(cursor, &quoted(keyword)));
                    }
                }
                keyword if required.iter().any(|list| list.name.as_bytes() == keyword) => {
                    let is_own = |list: &&mut NumberList| list.name.as_bytes() == keyword;
                    for list in required.iter_mut().filter(is_own) {
                        numbers(cursor, list)?;
                    }
                }
                keyword if !is_keyword(keyword) => {
                    let problem = format!("`{}` stands where a keyword should", quoted(keyword));
                    let remedy = "Correct the count of the preceding list, or write the mesh again";
                    return Err(cursor.error(problem, remedy));
                }
                keyword if is_of_higher_order(keyword) => {
                    if value(cursor, "a count")? > 0 {
                        let problem =
                            format!("{} are of higher order, which is not read", quoted(keyword));
                        return Err(cursor.error(problem, "Save linear elements (Triangles)"));
                    }
                }
                keyword => {
                    let kind = kind_of(keyword);
                    if let Some(kind) = kind {
                        let count = value(cursor, "the number of elements")?;
                        lists.push(List { cursor: cursor.clone(), count, kind, keyword });
                    } else if visitor.asks_for_data() {
                        visitor.unsupported(&format!("the list {}", quoted(keyword)));
                    }
                    match lists.last() {
                        Some(list) if vertices_seen && kind.is_some() => {
                            *cursor = list.clone().send(visitor)?;
                        }
                        // Lists hold numbers alone, so the next word that starts with a letter is a keyword.
                        _ => skip_numbers(cursor),
                    }
                }
            }
        }
        if !vertices_seen {
            let problem = "it has no list of Vertices";
            return Err(source.error(problem, "Save the mesh again"));
        }
        for list in required {
            let own: Vec<List<'_>> =
                lists.iter().filter(|own| own.kind == list.kind).cloned().collect();
            send_listed(list, own, visitor)?;
        }
        Ok(CoordinateStorage::in_place(Format::Medit, CoordinateEncoding::TEXT))
    }
}

/// Reads a list of numbers: the list's length, followed by one number of a triangle or edge per row.
fn numbers(cursor: &mut Cursor<'_>, list: &mut NumberList) -> Result<(), ReadError> {
    let items = format!("{}s", list.word);
    let count = value(cursor, &format!("the number of {items}"))?;
    for done in 0..count {
        cursor.row(done, count, &items)?;
        list.numbers.push(cursor.integer(format_args!("the number of a {}", list.kind.name()))?);
    }
    Ok(())
}

/// Visits the elements of a list of numbers. `lists` are the lists of elements of their kind.
fn send_listed(
    list: NumberList,
    mut lists: Vec<List<'_>>,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    let counts: Vec<u64> = lists.iter().map(|list| list.count).collect();
    let kind = list.kind;
    // The next element to be read: the index of its list, and its index in the list.
    let mut next = (0, 0);
    list.send(&counts, visitor, |list, index| {
        if next.0 != list {
            next = (list, 0);
        }
        let List { cursor, count, .. } = &mut lists[list];
        loop {
            cursor.row(next.1, *count, "elements")?;
            let (nodes, reference) = cursor.item(|cursor| element(cursor, kind), &mut None)?;
            next.1 += 1;
            if next.1 > index {
                return Ok((cursor.clone(), nodes, reference));
            }
        }
    })
}

/// Returns whether a keyword names a list of elements with mid-side nodes, such as `TrianglesP2`.
fn is_of_higher_order(keyword: &[u8]) -> bool {
    let [elements @ .., b'P' | b'Q', b'2'..=b'9'] = keyword else { return false };
    kind_of(elements).is_some()
}

fn kind_of(keyword: &[u8]) -> Option<CellKind> {
    match keyword {
        b"Corners" | b"RequiredVertices" => Some(CellKind::Point),
        b"Edges" => Some(CellKind::Line),
        b"Triangles" => Some(CellKind::Triangle),
        b"Quadrilaterals" => Some(CellKind::Quadrilateral),
        _ => None,
    }
}

/// Reads the whole number after a keyword, on the keyword's row or a later row.
fn value(cursor: &mut Cursor<'_>, what: &str) -> Result<u64, ReadError> {
    if !cursor.next_word() {
        return Err(cursor.error(format!("the file ends before {what}"), CUT_OFF));
    }
    cursor.integer(what)
}

fn vertices(
    cursor: &mut Cursor<'_>,
    dimension: u64,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    if !cursor.next_word() {
        return Err(cursor.error("the file ends before the number of vertices", CUT_OFF));
    }
    let count = cursor.vertex_count()?;
    visitor.expect_nodes(cursor.capacity(count, "0 0 0\n".len()));
    let before = &mut cursor.clone();
    let mut z_values = ZValues::new(visitor);
    each_row(
        cursor,
        count,
        "vertices",
        visitor,
        |cursor| {
            let point = cursor.point("a vertex")?;
            let z = match dimension {
                3 => Some(cursor.z("a vertex")?),
                _ => None,
            };
            cursor.signed("the reference of a vertex")?;
            Ok((point, z))
        },
        |cursor, visitor, done, ((x_at, at), z)| {
            visitor.node(cursor, done + 1, 2, x_at, at);
            z.into_iter().for_each(|z| z_values.push(z));
            Ok(())
        },
    )?;
    z_values.send("z", CoordinateEncoding::TEXT.into(), visitor);
    if visitor.asks_for_groups() {
        for vertex in 0..count {
            before.row(vertex, count, "vertices")?;
            let reference = |cursor: &mut Cursor<'_>| {
                (0..dimension).for_each(|_| _ = cursor.token());
                cursor.signed("the reference of a vertex")
            };
            let reference = before.item(reference, &mut None)?;
            // A vertex without a reference has the reference 0.
            if reference != 0 {
                visitor.node_group(vertex as u32, "reference", &GroupLabel::Tag(reference));
            }
        }
    }
    Ok(())
}

/// Reads the nodes and the reference of an element. Points have no reference, and get 0.
#[inline]
fn element(cursor: &mut Cursor<'_>, kind: CellKind) -> Result<([u64; 4], i64), ReadError> {
    let nodes = nodes(cursor, kind)?;
    let reference = match kind {
        CellKind::Point => 0,
        _ => cursor.signed("the reference of an element")?,
    };
    Ok((nodes, reference))
}

/// Moves past the last number before the next keyword.
fn skip_numbers(cursor: &mut Cursor<'_>) {
    loop {
        while !cursor.is_at_end() {
            let before = cursor.clone();
            if cursor.token().is_none_or(is_keyword) {
                *cursor = before;
                return;
            }
        }
        let mut next = cursor.clone();
        if !next.next_row() {
            return;
        }
        // Most rows are plain numbers, without letters.
        let row = next.clone().rest();
        if row.iter().fold(0, |most, &byte| byte.max(most)) < b'A' {
            next.rest();
        }
        *cursor = next;
    }
}

/// Returns whether a word is a keyword. Keywords start with a letter, but so do numbers such as NaN.
fn is_keyword(word: &[u8]) -> bool {
    word.first().is_some_and(u8::is_ascii_alphabetic) && float(word).is_none()
}
