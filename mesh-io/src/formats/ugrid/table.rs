//! Connectivity tables: the nodes of faces or edges.

use super::kind::TableKind;
use super::mesh::Mesh;
use crate::error::ReadError;
use crate::netcdf::{Header, Items, NumberType, Variable};
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::quoted;

/// Connectivity table of faces or edges, with a row or a column per element.
pub(super) struct Table<'h, 'a> {
    header: &'h Header<'a>,
    kind: TableKind,
    pub(super) variable: &'h Variable,
    pub(super) items: Items<'a>,
    /// Number of faces or edges.
    pub(super) count: usize,
    /// Number of corners in the table per element. Faces with fewer corners have missing ones at the end.
    pub(super) corners: usize,
    /// Whether the table has a row per element, not a column.
    pub(super) has_rows: bool,
    /// Value that marks a missing corner, from the attribute `_FillValue` or `missing_value`.
    missing: Option<f64>,
    /// Start index of the numbers of nodes, faces and edges in the file: 0 or 1.
    pub(super) first: u64,
}

/// An entry of a connectivity table.
enum Corner {
    /// Number of a node, counted from the start index.
    Node(u64),
    /// Entry of a face with fewer corners than the table has.
    Missing,
    /// Invalid entry: no node has this number.
    Other(f64),
}

impl<'h, 'a> Table<'h, 'a> {
    /// Finds the connectivity table of faces or edges in a variable.
    ///
    /// # Errors
    /// If the variable is no table of numbers with enough corners per element, has an unknown start index, or cannot be
    /// read.
    pub(super) fn find(
        mesh: &Mesh<'h, 'a>,
        variable: &'h Variable,
        what: TableKind,
    ) -> Result<Table<'h, 'a>, ReadError> {
        let header = mesh.header;
        let (_, several, dimension, least) = what.words();
        let wrong = |problem: &str| {
            let name = quoted(&variable.name);
            let problem = format!("{name}, the nodes of the {several}, {problem}");
            Cursor::at_byte_offset(header.source, header.start_of(variable)).error(problem, CORRECT)
        };
        let is_numeric = matches!(variable.number, NumberType::Whole(_) | NumberType::Real(_));
        let (&[rows, columns], true, false) = (&variable.shape[..], is_numeric, variable.is_record)
        else {
            return Err(wrong("are not a table of numbers"));
        };
        // The mesh may name the dimension of its elements, and positions or data may have that dimension.
        let dimension = str::from_utf8(mesh.attribute(dimension)).ok();
        let count = dimension.and_then(|name| header.dimension(name));
        let count = count.or_else(|| mesh.element_count(what));
        let is_told = count.filter(|&count| (count == rows) != (count == columns));
        let has_rows = match is_told {
            Some(count) => count == rows,
            None => rows >= columns || columns == 2 || what == TableKind::Faces,
        };
        let mut table = Table {
            header,
            kind: what,
            variable,
            items: header.items(variable)?,
            count: if has_rows { rows } else { columns } as usize,
            corners: if has_rows { columns } else { rows } as usize,
            has_rows,
            missing: variable.missing(),
            first: 0,
        };
        // By the conventions, a row is then a face. Some files have columns instead, whose rows repeat nodes.
        if is_told.is_none() && has_rows && rows < columns && table.repeats_a_node() {
            (table.count, table.corners, table.has_rows) = (columns as usize, rows as usize, false);
        }
        let corners = table.corners as u64;
        if corners < least || (corners > 2 && matches!(what, TableKind::Edges)) {
            return Err(wrong(&format!("have {corners} corners")));
        }
        let first = match variable.whole("start_index") {
            Some(first @ (0 | 1)) => first as u64,
            Some(other) => return Err(wrong(&format!("start at number {other}, not at 0 or 1"))),
            // Delft3D FM counts from 1, and its older nets do not say so.
            None if mesh.is_of_links() => table.likely_first(0),
            None => table.likely_first(mesh.nodes as u64),
        };
        Ok(Table { first, ..table })
    }

    /// Reads the node numbers of a face or an edge into `nodes`.
    ///
    /// # Errors
    /// If the element has too few nodes, an invalid entry, or a node after a missing corner.
    pub(super) fn nodes(&self, element: usize, nodes: &mut Vec<u64>) -> Result<(), ReadError> {
        nodes.clear();
        let (one, .., least) = self.kind.words();
        let wrong = |problem: String| {
            let problem = format!("{one} {} {problem}", element as u64 + self.first);
            Err(self.cursor(element).error(problem, CORRECT))
        };
        let mut has_ended = false;
        for place in 0..self.corners {
            match self.corner(element, place) {
                Corner::Missing => has_ended = true,
                Corner::Node(_) if has_ended => {
                    return wrong("has a corner after a missing one".into());
                }
                Corner::Node(node) => nodes.push(node),
                Corner::Other(number) => {
                    return wrong(format!("has the corner {number}, which is no node"));
                }
            }
        }
        match (nodes.len() as u64) < least {
            true => wrong(format!("has {} corners", nodes.len())),
            false => Ok(()),
        }
    }

    /// Returns a cursor at the first entry of a face or an edge, for messages.
    pub(super) fn cursor(&self, element: usize) -> Cursor<'a> {
        Cursor::at_byte_offset(self.header.source, self.items.byte_of(self.position(element, 0)))
    }

    /// Returns the offset of an entry in the bytes of the variable.
    fn position(&self, element: usize, corner: usize) -> usize {
        let item = match self.has_rows {
            true => element * self.corners + corner,
            false => corner * self.count + element,
        };
        self.items.range(0).start + item * self.variable.number.bytes()
    }

    fn corner(&self, element: usize, corner: usize) -> Corner {
        let at = self.position(element, corner);
        let own = &self.items.bytes[at..at + self.variable.number.bytes()];
        let order = self.variable.order;
        let (number, is_negative) = match self.variable.number {
            NumberType::Real(precision) => {
                let number = order.real(precision, own);
                (number, number < 0.0)
            }
            NumberType::Whole(kind) => {
                let number = order.integer_as_real(kind, own);
                // -1 as an unsigned integer, and netCDF's default fill value of 64 bits, -2.
                let is_negative = !kind.is_signed && matches!(order.signed(own), -2 | -1);
                (number, number < 0.0 || is_negative)
            }
            NumberType::Text | NumberType::Other(_) => (f64::NAN, false),
        };
        let is_missing = number.is_nan() || Some(number) == self.missing;
        // Some files name no fill value. A negative entry from the fourth corner on, which no node has as its number,
        // then marks a missing corner.
        if is_missing || (is_negative && corner >= 3) {
            return Corner::Missing;
        }
        let is_node = number >= 0.0 && number.fract() == 0.0 && number < 9e15;
        if is_node { Corner::Node(number as u64) } else { Corner::Other(number) }
    }

    /// Returns whether some element lists a node twice.
    fn repeats_a_node(&self) -> bool {
        (0..self.count).any(|element| {
            let corner = |corner| match self.corner(element, corner) {
                Corner::Node(node) => Some(node),
                Corner::Missing | Corner::Other(_) => None,
            };
            let mut nodes: Vec<u64> = (0..self.corners).filter_map(corner).collect();
            let count = nodes.len();
            nodes.sort_unstable();
            nodes.dedup();
            nodes.len() < count
        })
    }

    /// Guesses the start index of a file without `start_index`: 1 if node numbers range from at least 1 to at least
    /// `nodes`, else 0, the default of the conventions.
    fn likely_first(&self, nodes: u64) -> u64 {
        let (mut least, mut most) = (u64::MAX, 0);
        for element in 0..self.count {
            for corner in 0..self.corners {
                if let Corner::Node(node) = self.corner(element, corner) {
                    (least, most) = (least.min(node), most.max(node));
                }
            }
        }
        u64::from(least >= 1 && most >= nodes)
    }
}
