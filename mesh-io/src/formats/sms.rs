//! SMS's `.2dm`.
//!
//! The format: <https://www.xmswiki.com/wiki/SMS:2D_Mesh_Files_*.2dm>. Rows start with a keyword and may stand in any
//! order. The nodes of node strings (NS) stay fixed.

use crate::content::group_label::GroupLabel;
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::format::Format;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::unquoted;
use crate::visit::items::{CellKind, Element, GroupScope, RegionAttribute};
use crate::visit::reader::FormatReader;
use crate::visit::rows::{all_rows, nodes};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;

pub(crate) struct Sms;

/// Marks lines without a material, which belong to no group of the kind `material`.
const NO_MATERIAL: i64 = i64::MIN;

/// A row of the file, reduced to the content that the reader uses.
enum Row {
    /// A node: the id, the offset of x, x and y, (the offset of z, z).
    Node(u64, usize, [f64; 2], (usize, f64)),
    /// An element, and whether further numbers follow its material.
    Element(Element, bool),
    /// The nodes of a node string in one row, without signs.
    String(Vec<u64>, NodestringEnd),
    /// The number and name of a material.
    Material(i64, Vec<u8>),
    Other,
}

/// Whether a node string continues after a row.
enum NodestringEnd {
    /// The string continues in the next row.
    Open,
    /// The string ends in this row. The rest of the row is the string's name, possibly empty.
    Last(Vec<u8>),
}

impl FormatReader for Sms {
    const VERTICES: &'static str = "the list of ND rows";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let nodes_first = &mut Cursor::new(source);
        let mut z_values = ZValues::new(visitor);
        all_rows(nodes_first, visitor, node, |cursor, visitor, row| {
            if let Row::Node(tag, x_at, at, z) = row {
                visitor.node(cursor, tag, 2, x_at, at);
                z_values.push(z);
            }
            Ok(())
        })?;
        visitor.end_nodes(nodes_first)?;
        z_values.send("z", CoordinateEncoding::TEXT.into(), visitor);
        let cursor = &mut Cursor::new(source);
        let mut strings: Vec<u64> = Vec::new();
        let mut string = 1;
        // The last node of a row whose string goes on.
        let mut before: Option<u64> = None;
        let materials = || {
            let label = |material| (material != NO_MATERIAL).then_some(GroupLabel::Tag(material));
            vec![RegionAttribute { kind: "material".into(), from_dimension: 1, label }]
        };
        visitor.region_attributes(materials());
        all_rows(cursor, visitor, element, |cursor, visitor, row| {
            match row {
                Row::Element(element, has_more) => {
                    if has_more {
                        visitor.unsupported("further materials or values of elements");
                    }
                    visitor.element(cursor, &element)?;
                }
                Row::String(nodes, end) => {
                    // A row that continues a string belongs to the group of the string's first row.
                    let label = GroupLabel::Tag(string);
                    visitor.group_scopes(&[GroupScope {
                        kind: "nodestring",
                        label,
                        dimension: Some(1),
                    }]);
                    // Node strings belong to no material.
                    visitor.region_attributes(Vec::new());
                    let joined: Vec<u64> = before.into_iter().chain(nodes).collect();
                    visitor.polyline(cursor, 0, [0; 2], &joined)?;
                    visitor.region_attributes(materials());
                    visitor.group_scopes(&[]);
                    let is_open = matches!(end, NodestringEnd::Open);
                    before = joined.last().copied().filter(|_| is_open);
                    strings.extend(joined);
                    if let NodestringEnd::Last(name) = end {
                        if !name.is_empty() {
                            visitor.group_name("nodestring", Some(1), string, &name);
                        }
                        string += 1;
                    }
                }
                Row::Material(tag, name) => visitor.group_name("material", Some(2), tag, &name),
                _ => {}
            }
            Ok(())
        })?;
        if !strings.is_empty() {
            strings.sort_unstable();
            strings.dedup();
            visitor.remark(Remark::elements(strings.len() as u64, "node", " of node strings"));
        }
        Ok(CoordinateStorage::in_place(Format::Sms2dm, CoordinateEncoding::TEXT))
    }
}

/// Returns the first word of a row in capital letters, and its length. The length is 0 if the word is longer than any
/// known keyword. Programs also write keywords in small letters.
#[inline]
fn keyword(cursor: &mut Cursor<'_>) -> ([u8; 3], usize) {
    let mut word = [0; 3];
    let token = cursor.token().filter(|token| token.len() <= word.len()).unwrap_or_default();
    for (to, letter) in word.iter_mut().zip(token) {
        *to = letter.to_ascii_uppercase();
    }
    (word, token.len())
}

/// Reads a row in the first pass over the file: a node, or else [`Row::Other`].
#[inline]
fn node(cursor: &mut Cursor<'_>) -> Result<Row, ReadError> {
    let (word, length) = keyword(cursor);
    if &word[..length] != b"ND" {
        return Ok(Row::Other);
    }
    let tag = cursor.integer("the number of a node")?;
    let (x_at, at) = cursor.point(format_args!("node {tag}"))?;
    Ok(Row::Node(tag, x_at, at, cursor.z_if_any(format_args!("node {tag}"))?))
}

/// Reads a row in the second pass over the file: an element, a node string or a material, or else [`Row::Other`].
#[inline]
fn element(cursor: &mut Cursor<'_>) -> Result<Row, ReadError> {
    let (word, length) = keyword(cursor);
    let kind = match &word[..length] {
        b"E3T" => CellKind::Triangle,
        b"E4Q" => CellKind::Quadrilateral,
        b"E2L" => CellKind::Line,
        b"NS" => return string(cursor),
        b"MAT" => return Ok(material(cursor)),
        b"E6T" | b"E8Q" | b"E9Q" | b"E3L" => {
            let problem = "elements with nodes on their sides, which are not read";
            return Err(cursor.error(problem, "Save linear elements (E3T, E4Q)"));
        }
        b"E4T" | b"E6W" | b"E8H" | b"E5P" => {
            let problem = "elements of a volume";
            return Err(cursor.error(problem, "Only meshes of the plane are read"));
        }
        _ => return Ok(Row::Other),
    };
    let tag = cursor.integer("the number of an element")?;
    let nodes = nodes(cursor, kind)?;
    // The last number is the material, which some programs leave out.
    let material = if cursor.is_at_end() { 0 } else { cursor.signed("a material").unwrap_or(0) };
    let of_none = kind == CellKind::Line && material == 0;
    let region = [if of_none { NO_MATERIAL } else { material }, 0];
    Ok(Row::Element(Element { id: tag, kind, region, nodes }, !cursor.is_at_end()))
}

/// Reads a row of a node string. The last node of a string is negative, and the string's name may follow.
#[cold]
fn string(cursor: &mut Cursor<'_>) -> Result<Row, ReadError> {
    let mut nodes = Vec::new();
    while !cursor.is_at_end() {
        let node = cursor.signed("a node of a node string")?;
        nodes.push(node.unsigned_abs());
        match node {
            0 => return Err(cursor.error("a node string has node 0", CORRECT)),
            ..0 => {
                return Ok(Row::String(
                    nodes,
                    NodestringEnd::Last(unquoted(cursor.rest()).to_vec()),
                ));
            }
            _ => {}
        }
    }
    Ok(Row::String(nodes, NodestringEnd::Open))
}

/// Reads a material's number and name. Rows without number or name are ignored, as the mesh does not depend on names.
#[cold]
fn material(cursor: &mut Cursor<'_>) -> Row {
    match cursor.signed("a material") {
        Ok(tag) => match unquoted(cursor.rest()) {
            [] => Row::Other,
            name => Row::Material(tag, name.to_vec()),
        },
        Err(_) => Row::Other,
    }
}
