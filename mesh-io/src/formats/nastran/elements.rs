//! Visits the elements, and the nodes that masses, springs and rigid elements constrain.

use super::nodes::{number, whole};
use super::types::{Class, RigidFields, class};
use crate::content::remark::Remark;
use crate::error::ReadError;
use crate::text::card;
use crate::text::card::{CardLine, CardName, name_bytes};
use crate::text::cursor::Cursor;
use crate::text::token::{integer, quoted};
use crate::visit::items::{CellKind, Element, RegionAttribute};
use crate::visit::rows::{all_rows, volume};
use crate::visit::visitor::MeshVisitor;
use std::collections::{BTreeSet, HashSet};

/// A card of the bulk data, reduced to the content that the element reader uses.
enum Card {
    Element(Element),
    /// An element whose property is blank.
    WithoutProperty(Element),
    /// The name of a card whose element constrains nodes, and the ids of these nodes.
    Constrains(CardName, Vec<u64>),
    /// A GRID card with the id of the node; 0 if `card` read the row, since elements need no ids of nodes.
    Node(u64),
    Other(CardName),
}

/// Visits all elements, then the nodes that elements constrain. Cards of other kinds are reported as unsupported.
pub(super) fn send(rows: &Cursor<'_>, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
    visitor.region_attributes(vec![RegionAttribute::tags_from_one("property")]);
    let mut cursor = rows.clone();
    // The constrained nodes, the number of constraining elements, and the names of their cards.
    let (mut held, mut holding, mut names) = (Vec::new(), 0, BTreeSet::new());
    let mut properties = None;
    let (mut others, asks_for_data) = (BTreeSet::new(), visitor.asks_for_data());
    all_rows(&mut cursor, visitor, card, |cursor, visitor, card| {
        match card {
            Card::Element(element) => visitor.element(cursor, &element)?,
            Card::WithoutProperty(element) => {
                let known = properties.get_or_insert_with(|| property_ids(rows));
                let property =
                    if known.contains(&element.id) { element.id.cast_signed() } else { 0 };
                visitor.element(cursor, &Element { region: [property, 0], ..element })?;
            }
            Card::Constrains(name, nodes) => {
                held.extend(nodes);
                holding += 1;
                names.insert(name);
            }
            Card::Other(name) if asks_for_data => drop(others.insert(name)),
            Card::Node(_) | Card::Other(_) => {}
        }
        Ok(())
    })?;
    if let Some(first) = names.first() {
        let word = if names.len() == 1 { "called" } else { "such as" };
        let first = quoted(name_bytes(first));
        visitor.remark(Remark::elements(holding, "element", &format!(" {word} {first}")));
        visitor.unsupported(&format!("elements that constrain nodes, {word} {first}"));
    }
    if asks_for_data {
        left_out(rows, visitor);
    }
    others.retain(|name| !matches!(name_bytes(name), b"" | b"GRDSET"));
    if let Some(first) = others.first() {
        let first = quoted(name_bytes(first));
        visitor.unsupported(&match others.len() - 1 {
            0 => format!("the contents of {first}"),
            more => format!("the contents of {first} and of {more} other kinds of cards"),
        });
    }
    send_constrained_nodes(rows, held, visitor)
}

/// Reports fields of nodes and elements that are not read and are neither blank nor 0: those behind z of a node, and those
/// behind the nodes of an element.
#[cold]
fn left_out(rows: &Cursor<'_>, visitor: &mut dyn MeshVisitor) {
    let cursor = &mut rows.clone();
    while cursor.next_row() {
        let row = cursor.row_range();
        let name = CardLine::starting_at(cursor.bytes, row.start).name();
        let has_more = |read: usize| {
            card::words(cursor.bytes, row.clone()).skip(read).any(|word| number(word) != Some(0.0))
        };
        match (name_bytes(&name), class(&name)) {
            // Number, coordinate system, x, y and z. GRDSET has its systems and constraints in the same fields.
            (b"GRID" | b"GRDSET", _) if has_more(5) => {
                visitor.unsupported("systems and constraints of nodes (CD, PS, SEID)");
            }
            (_, Some(Class::Of(kind))) if has_more(2 + kind.nodes()) => {
                visitor.unsupported(
                    "fields of elements behind their nodes, such as thicknesses and angles",
                );
            }
            (b"CONROD", _) if has_more(3) => visitor.unsupported("properties of CONROD"),
            _ => {}
        }
    }
}

/// Visits the nodes that elements constrain, as points. Ids without a GRID card, such as scalar points, are not in the
/// mesh and are skipped.
fn send_constrained_nodes(
    rows: &Cursor<'_>,
    held: Vec<u64>,
    visitor: &mut dyn MeshVisitor,
) -> Result<(), ReadError> {
    if held.is_empty() {
        return Ok(());
    }
    let held: HashSet<u64> = held.into_iter().collect();
    let mut there = BTreeSet::new();
    let cursor = &mut rows.clone();
    all_rows(cursor, visitor, node, |_, _, card| {
        if let Card::Node(id) = card
            && held.contains(&id)
        {
            there.insert(id);
        }
        Ok(())
    })?;
    there.into_iter().try_for_each(|id| {
        let nodes = [id, 0, 0, 0];
        visitor.element(cursor, &Element { id: 0, kind: CellKind::Point, region: [0; 2], nodes })
    })
}

/// Reads the id of a GRID card. Any other card is [`Card::Other`].
fn node(cursor: &mut Cursor<'_>) -> Result<Card, ReadError> {
    let line = CardLine::starting_at(cursor.bytes, cursor.row_range().start);
    let name = line.name();
    let id = line.fields().next().filter(|_| name_bytes(&name) == b"GRID");
    let id = id.and_then(|field| integer(cursor.bytes[field].trim_ascii()));
    Ok(id.map_or(Card::Other(name), Card::Node))
}

/// Reads a card of an element. Other cards are not parsed.
///
/// # Errors
/// For volume elements, elements with possible mid-side nodes, and fields that are not whole numbers.
#[inline]
fn card(cursor: &mut Cursor<'_>) -> Result<Card, ReadError> {
    let row = cursor.row_range();
    let name = CardLine::starting_at(cursor.bytes, row.start).name();
    if name_bytes(&name) == b"GRID" {
        return Ok(Card::Node(0));
    }
    let Some(class) = class(&name) else { return Ok(Card::Other(name)) };
    let shown = || quoted(name_bytes(&name));
    let mut words = card::words(cursor.bytes, row);
    let mut next = || words.next().unwrap_or_default();
    let (kind, has_property) = match class {
        Class::Of(kind) => (kind, true),
        Class::Line => (CellKind::Line, false),
        Class::Constraining(fields) => {
            let words: Vec<&[u8]> = words.take(1 + fields[fields.len() - 1]).collect();
            let node = |&field: &usize| words.get(field).and_then(|word| integer(word));
            return Ok(Card::Constrains(name, fields.iter().filter_map(node).collect()));
        }
        Class::Rigid(listed) => return Ok(Card::Constrains(name, rigid(words, listed))),
        Class::Volume => return Err(volume(cursor, &format!("{} elements", shown()))),
        Class::SecondOrder => {
            let problem =
                format!("{} elements may have nodes on their sides, which are not read", shown());
            return Err(cursor.error(problem, "Save linear elements (CTRIA3, CQUAD4)"));
        }
    };
    let id = whole(cursor, next(), format_args!("the number of a {}", kind.name()))?;
    let word = has_property.then(&mut next);
    let property = match word {
        None | Some(b"") => 0,
        Some(word) => whole(cursor, word, format_args!("the property of {} {id}", kind.name()))?,
    };
    let mut nodes = [0; 4];
    for node in &mut nodes[..kind.nodes()] {
        *node = whole(cursor, next(), format_args!("a vertex of {} {id}", kind.name()))?;
    }
    let element = Element { id, kind, region: [property.cast_signed(), 0], nodes };
    Ok(match word {
        Some(b"") => Card::WithoutProperty(element),
        _ => Card::Element(element),
    })
}

/// Returns the ids of all property cards (`PSHELL`, `PCOMP` and so on). An element with a blank property has the
/// property of the element's own number, or no property if no property card has this number.
#[cold]
fn property_ids(rows: &Cursor<'_>) -> HashSet<u64> {
    let cursor = &mut rows.clone();
    let mut ids = HashSet::new();
    while cursor.next_row() {
        let line = CardLine::starting_at(cursor.bytes, cursor.row_range().start);
        if name_bytes(&line.name()).starts_with(b"P")
            && let Some(field) = line.fields().next()
        {
            ids.extend(integer(cursor.bytes[field].trim_ascii()));
        }
    }
    ids
}

/// Returns the nodes of a rigid element. `words` lists the card's fields, element number first.
#[cold]
fn rigid<'a>(mut words: impl Iterator<Item = &'a [u8]>, listed: RigidFields) -> Vec<u64> {
    let _number_of_element = words.next();
    // Some fields are no numbers: `UM` precedes dependent nodes in RBE1 and RBE3, and RBE2 may end with a real number.
    let given = words.filter(|word| !word.is_empty());
    let mut nodes = Vec::new();
    // The number of fields to skip before the next node.
    let mut until = 0;
    let mut first = true;
    for word in given {
        match (integer(word), listed) {
            (Some(node), _) if until == 0 => {
                nodes.push(node);
                until = match listed {
                    RigidFields::Pairs => 1,
                    RigidFields::Nodes | RigidFields::Weights => usize::from(first),
                };
                first = false;
            }
            (Some(_), _) => until -= 1,
            // A weight, which components follow.
            (None, RigidFields::Weights) if word.contains(&b'.') => until = 1,
            // The nodes after `UM` in RBE3 were listed before.
            (None, RigidFields::Nodes | RigidFields::Weights) => break,
            (None, RigidFields::Pairs) => until = 0,
        }
    }
    nodes
}
