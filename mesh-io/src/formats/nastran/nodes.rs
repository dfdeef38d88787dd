//! Visits the nodes: GRID cards, and the default coordinate system in GRDSET.

use crate::content::remark::Remark;
use crate::edit::numbers::CoordinateEncoding;
use crate::error::ReadError;
use crate::precision::Precision;
use crate::text::card;
use crate::text::card::{CardLine, name_bytes};
use crate::text::cursor::Cursor;
use crate::text::cursor_numbers::NO_Z;
use crate::text::token::{float, fortran_float, integer};
use crate::visit::rows::all_rows;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::ZValues;
use std::ops::Range;

/// A card of the bulk data, reduced to the content that the node reader uses.
enum Card {
    Node(Node),
    /// The coordinate system in GRDSET, which applies to nodes without a system.
    System(u64),
    Other,
}

struct Node {
    id: u64,
    /// The offset of x.
    x_at: usize,
    at: [f64; 2],
    z: (usize, f64),
    field_width: FieldWidth,
    /// Whether the card leaves the coordinate system blank.
    is_of_default: bool,
}

/// The room for a node's coordinates: the width of fixed fields, or the length of the longest number in free field.
#[derive(Clone, Copy)]
struct FieldWidth {
    is_free: bool,
    /// The index of the first precision in [`WIDTH_PRECISIONS`] with enough characters.
    size: usize,
}

/// The precision of coordinates by length: up to 8 characters, up to 16, and longer.
const WIDTH_PRECISIONS: [Precision; 3] = [Precision::Text8, Precision::Text16, Precision::Double];

/// Node counts by field width: first for fixed fields, then for free field.
#[derive(Default)]
struct FieldWidthCounts([[u64; WIDTH_PRECISIONS.len()]; 2]);

impl FieldWidthCounts {
    fn add(&mut self, FieldWidth { is_free, size }: FieldWidth) {
        self.0[usize::from(is_free)][size] += 1;
    }

    /// Returns the precision of all coordinates: the smaller of the narrowest fixed field and the longest number in
    /// free field, as programs may ignore further characters in free field. Also returns the number of nodes with
    /// longer coordinates.
    fn precision(&self) -> (Precision, u64) {
        let [fixed, free] = &self.0;
        let smallest = fixed.iter().position(|&count| count > 0);
        let longest = free.iter().rposition(|&count| count > 0);
        let size = smallest.into_iter().chain(longest).min().unwrap_or(WIDTH_PRECISIONS.len() - 1);
        let longer = |counts: &[u64; 3]| counts[size + 1..].iter().sum::<u64>();
        (WIDTH_PRECISIONS[size], longer(fixed) + longer(free))
    }
}

/// Visits all nodes. Returns the encoding of the coordinates.
///
/// # Errors
/// If there is no node, if a node is not in the basic coordinate system, or if nodes may be hidden in included files or
/// in rows that repeat other rows.
pub(super) fn send(
    rows: &Cursor<'_>,
    visitor: &mut dyn MeshVisitor,
) -> Result<CoordinateEncoding, ReadError> {
    let mut z_values = ZValues::new(visitor);
    let mut rooms = FieldWidthCounts::default();
    // The number of nodes, the offset and id of the first node with a blank coordinate system, and the default system.
    let (mut count, mut first_at, mut system) = (0, None, 0);
    let cursor = &mut rows.clone();
    all_rows(cursor, visitor, card, |cursor, visitor, card| {
        match card {
            Card::Node(Node { id, x_at, at, z, field_width: room, is_of_default }) => {
                visitor.node(cursor, id, 2, x_at, at);
                z_values.push(z);
                rooms.add(room);
                count += 1;
                first_at = first_at.or(is_of_default.then_some((x_at, id)));
            }
            Card::System(own) => system = own,
            Card::Other => {}
        }
        Ok(())
    })?;
    if count == 0 {
        let problem = "the file has no GRID card, so this is no mesh of Nastran";
        return Err(cursor.source.error(problem, "Save the mesh with its nodes and elements"));
    }
    cursor.check_vertex_count(count)?;
    if let (1.., Some((at, id))) = (system, first_at) {
        return Err(in_system(&Cursor::on_line_of(cursor.source, at), id, system));
    }
    visitor.end_nodes(cursor)?;
    let (precision, longer) = rooms.precision();
    if longer > 0 {
        let most = if precision == Precision::Text8 { 8 } else { 16 };
        let (s, have) = if longer == 1 { ("", "has") } else { ("s", "have") };
        let nodes = format!("{longer} node{s} {have} coordinates of more than {most} characters");
        visitor.remark(Remark::Text(format!(
            "{nodes}, beside fields of {most}: they count as rounded to {most}"
        )));
    }
    let numbers = CoordinateEncoding::Fields { precision };
    z_values.send("z", numbers.into(), visitor);
    Ok(numbers)
}

/// Reads a GRID or GRDSET card. Other cards are not parsed.
#[inline]
fn card(cursor: &mut Cursor<'_>) -> Result<Card, ReadError> {
    let row = cursor.row_range();
    let line = CardLine::starting_at(cursor.bytes, row.start);
    match name_bytes(&line.name()) {
        b"GRID" => node(cursor, line, row),
        b"GRDSET" => default_system(cursor, line),
        b"INCLUDE" => {
            let problem = "INCLUDE names another file, which may hold a part of the mesh";
            Err(cursor.error(problem, "Write all of the bulk data in one file"))
        }
        b"BEGIN" => {
            let problem = "a second section of bulk data begins here, with numbers of its own";
            Err(cursor.error(problem, "Write one section at a time"))
        }
        [b'=', ..] => {
            let problem =
                "a row repeats the row above, so several nodes share one place in the file";
            Err(cursor.error(problem, "Write out all cards, without `=`"))
        }
        _ => Ok(Card::Other),
    }
}

#[inline]
fn node(cursor: &Cursor<'_>, line: CardLine<'_>, row: Range<usize>) -> Result<Card, ReadError> {
    let bytes = cursor.bytes;
    let mut fields = line.fields();
    let mut next = || fields.next();
    let word = |field: &Option<Range<usize>>| match field {
        Some(field) => bytes[field.clone()].trim_ascii(),
        None => &[],
    };
    let id = whole(cursor, word(&next()), "the number of a node")?;
    let system = next();
    let system = match word(&system) {
        b"" => None,
        system => Some(whole(cursor, system, format_args!("the coordinate system of node {id}"))?),
    };
    if let Some(system @ 1..) = system {
        return Err(in_system(cursor, id, system));
    }
    let (mut x_at, mut at, mut longest) = (0, [0.0; 2], 0);
    for (axis, x) in ['x', 'y'].into_iter().zip(&mut at) {
        let field = next();
        let Some(start) = field.as_ref().map(|field| field.start) else {
            let problem = format!(
                "{axis} of node {id} is left out at the end of its row, which stands for 0"
            );
            let remedy = "Write the number 0 there, as the field has no room for another value";
            return Err(cursor.error(problem, remedy));
        };
        if axis == 'x' {
            x_at = start;
        }
        let own = word(&field);
        longest = longest.max(own.len());
        *x = number(own).filter(|x| x.is_finite()).ok_or_else(|| {
            cursor.unusable(Some(own), format_args!("{axis} of node {id}"), "a finite number")
        })?;
    }
    // In large field, z is usually the first field of the next line.
    let in_next_line = || card::lines(bytes, row).nth(1).and_then(|line| line.fields().next());
    let z = next().or_else(|| if line.is_large { in_next_line() } else { None });
    let of_z = word(&z);
    longest = longest.max(of_z.len());
    let height = number(of_z)
        .ok_or_else(|| cursor.unusable(Some(of_z), format_args!("z of node {id}"), "a number"))?;
    let z = z.map_or(NO_Z, |z| (z.start, height));
    let given = if line.is_free { longest } else { 0 };
    let size = match given {
        17.. => 2,
        9.. => 1,
        _ => usize::from(line.is_large),
    };
    let room = FieldWidth { is_free: line.is_free, size };
    Ok(Card::Node(Node { id, x_at, at, z, field_width: room, is_of_default: system.is_none() }))
}

/// Reads the default coordinate system in GRDSET, 0 if the field is blank.
#[cold]
fn default_system(cursor: &Cursor<'_>, line: CardLine<'_>) -> Result<Card, ReadError> {
    let field = line.fields().nth(1).unwrap_or(0..0);
    let system = match cursor.bytes[field].trim_ascii() {
        b"" => 0,
        system => whole(cursor, system, "the coordinate system of nodes that name none")?,
    };
    Ok(Card::System(system))
}

#[cold]
fn in_system(cursor: &Cursor<'_>, id: u64, system: u64) -> ReadError {
    let problem = format!("node {id} is in the coordinate system {system}, not in the basic one");
    cursor.error(problem, "Write the nodes in the basic system, with CP blank or 0")
}

/// Reads a whole number, called `what` in messages.
#[inline]
pub(super) fn whole(
    cursor: &Cursor<'_>,
    word: &[u8],
    what: impl std::fmt::Display,
) -> Result<u64, ReadError> {
    integer(word).ok_or_else(|| {
        let token = (!word.is_empty()).then_some(word);
        cursor.unusable(token, what, "a whole number")
    })
}

/// Returns the real number in a field: 0 for a blank field, `None` if the field is not a number.
#[inline]
pub(super) fn number(word: &[u8]) -> Option<f64> {
    if word.is_empty() {
        return Some(0.0);
    }
    float(word).or_else(|| fortran_float(word))
}
