//! The element blocks of an Exodus file.

use super::File;
use crate::binary::byte_order::{ByteOrder, IntegerType};
use crate::binary::number_field::NumberField;
use crate::error::ReadError;
use crate::netcdf::{Items, NumberType, Variable};
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::quoted;
use crate::visit::items::CellKind;
use crate::visit::records::Region;
use crate::visit::rows::volume;
use crate::visit::send::ElementRecords;
use crate::visit::visitor::MeshVisitor;

/// A block of elements of one type.
pub(super) struct Block<'a> {
    /// Position of the block, from 1, which is part of its variables' names.
    pub(super) number: usize,
    pub(super) kind: CellKind,
    /// Whether sides 1 and 2 of an element are its two faces, as for shells, and for triangles in space. Edges then start
    /// at side 3.
    pub(super) has_sides_of_faces: bool,
    /// Number of elements in all earlier blocks.
    pub(super) before: u64,
    /// Number of elements of the block.
    pub(super) count: u64,
    /// Connectivity: the node numbers of each element, as signed integers of `width` bytes.
    items: Items<'a>,
    width: usize,
    order: ByteOrder,
}

impl Block<'_> {
    /// Returns the nodes of an element, given its index in the block from 0, and the offset of the element in the file.
    /// A negative node number becomes 0, which no node has.
    pub(super) fn element(&self, place: u64) -> ([u64; 4], usize) {
        let at = self.items.range(0).start + place as usize * self.kind.nodes() * self.width;
        let mut nodes = [0; 4];
        for (corner, node) in nodes[..self.kind.nodes()].iter_mut().enumerate() {
            let number = &self.items.bytes[at + corner * self.width..][..self.width];
            *node = u64::try_from(self.order.signed(number)).unwrap_or(0);
        }
        (nodes, self.items.byte_of(at))
    }
}

impl<'a> File<'a> {
    /// Visits the elements of all blocks, and the names of the blocks. Returns the blocks, to which side sets and data
    /// refer.
    ///
    /// # Errors
    /// If a connectivity variable is damaged, or its elements are not first-order points, lines, triangles or
    /// quadrilaterals.
    pub(super) fn blocks(
        &self,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<Vec<Block<'a>>, ReadError> {
        let ids = self.ids("eb_prop1");
        let names = self.header.variable("eb_names").map(|names| self.header.texts(names));
        let mut blocks = Vec::new();
        let mut before = 0;
        for (number, variable) in self.header.numbered("connect") {
            let block = self.block(number, before, variable)?;
            let id = self.id(&ids, number);
            if let Some(name) = names.as_ref().and_then(|names| names.get(number - 1))
                && visitor.asks_for_groups()
                && !name.is_empty()
            {
                visitor.group_name("block", None, id, name);
            }
            let (start, size) = (block.items.range(0).start, block.kind.nodes() * block.width);
            let elements = ElementRecords {
                kind: block.kind,
                count: block.count as usize,
                first_tag: before + 1,
                nodes: NumberField::new(Some(block.items.own()), size, block.width, block.order),
                is_signed: true,
                regions: [Region::Same(id), Region::Same(0)],
            };
            elements.send(visitor, |index, _| {
                Cursor::at_byte_offset(self.source, block.items.byte_of(start + index * size))
            })?;
            before += block.count;
            blocks.push(block);
        }
        Ok(blocks)
    }

    fn block(
        &self,
        number: usize,
        before: u64,
        variable: &Variable,
    ) -> Result<Block<'a>, ReadError> {
        let start = self.header.start_of(variable);
        let cursor = Cursor::at_byte_offset(self.source, start);
        let found = (&variable.shape[..], variable.number, variable.is_record);
        let (&[count, corners], NumberType::Whole(IntegerType { bytes: width, .. }), false) = found
        else {
            let problem = format!("connect{number} is not a table of whole numbers");
            return Err(cursor.error(problem, CORRECT));
        };
        let given = variable.text("elem_type").unwrap_or_default();
        let name = String::from_utf8_lossy(given).to_ascii_uppercase();
        let is = |prefixes: &[&str]| prefixes.iter().any(|prefix| name.starts_with(prefix));
        let kind = match corners {
            1 if is(&["SPHERE", "CIRCLE", "POINT", "PARTICLE"]) => CellKind::Point,
            2 if is(&["BAR", "BEAM", "TRUSS", "EDGE", "ROD", "LINE"]) => CellKind::Line,
            3 if is(&["TRI", "SHELL"]) => CellKind::Triangle,
            4 if is(&["QUAD", "SHELL"]) => CellKind::Quadrilateral,
            _ if is(&["TET", "HEX", "PYR", "WEDGE"]) => {
                return Err(volume(&cursor, &format!("elements of the type {}", quoted(given))));
            }
            _ => {
                let problem = format!(
                    "elements of the type {} with {corners} nodes, as in block {number}, are not read",
                    quoted(given)
                );
                let remedy = "Save triangles of three nodes (TRI3), beside QUAD4 and BAR2";
                return Err(cursor.error(problem, remedy));
            }
        };
        // Exodus II: A Finite Element Data Model (SAND92-2137), section 4.10: sides of TRI depend on the dimension.
        let is_in_space = self.header.dimension("num_dim") == Some(3);
        let has_sides_of_faces =
            is(&["SHELL", "TRISHELL"]) || kind == CellKind::Triangle && is_in_space;
        let items = self.header.items(variable)?;
        let order = variable.order;
        Ok(Block { number, kind, has_sides_of_faces, before, count, items, width, order })
    }

    /// Returns the ids of blocks or sets in file order, from the property variable `name`; empty if the file lacks the
    /// variable.
    pub(super) fn ids(&self, name: &str) -> Vec<i64> {
        let variable = self.header.variable(name).filter(|variable| !variable.is_record);
        variable.and_then(|ids| self.header.integers(ids)).unwrap_or_default()
    }

    /// Returns the id of the block or set at position `number`, from 1; the position itself if the file gives no id.
    pub(super) fn id(&self, ids: &[i64], number: usize) -> i64 {
        ids.get(number - 1).copied().unwrap_or(number as i64)
    }
}
