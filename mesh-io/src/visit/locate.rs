//! Finds the locations of nodes and elements in a file that was read before. Only messages need locations, and
//! therefore the first reading stores none.

use crate::disk::source::Source;
use crate::error::{Location, ReadError};
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element};
use crate::visit::reader::ReaderFunctions;
use crate::visit::visitor::MeshVisitor;

/// The list of a mesh in which items are located.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ItemList {
    Nodes,
    Triangles,
    Quadrilaterals,
}

impl ItemList {
    /// Returns whether elements of a kind are in the list.
    fn has(self, kind: CellKind) -> bool {
        match self {
            Self::Nodes => false,
            Self::Triangles => kind == CellKind::Triangle,
            Self::Quadrilaterals => kind == CellKind::Quadrilateral,
        }
    }
}

/// Location and id of an item of a file.
#[derive(Clone, Copy)]
pub(crate) struct ItemLocation {
    /// [`Location::Unknown`] if the reader does not visit the item.
    pub(crate) location: Location,
    /// Id of the item in the file; its 0-based index in the list if the location is unknown.
    pub(crate) id: u64,
    /// The index of the file, in the order of [`Source::files`].
    pub(crate) file_index: usize,
}

/// Reads the file again, and returns the locations of the items with the given 0-based indices in a list. `indices`
/// must ascend.
pub(crate) fn locate(
    reader: &ReaderFunctions,
    source: &Source,
    list: ItemList,
    indices: &[usize],
) -> Vec<ItemLocation> {
    let found = Vec::with_capacity(indices.len());
    let mut locator = LocationVisitor { list, left: indices, next: 0, found, source };
    // The first reading had no error. If this reading has an error, the items behind the error have unknown locations.
    let _ = (reader.visit)(source, &mut locator);
    let LocationVisitor { left, mut found, .. } = locator;
    let unknown = |&index: &usize| ItemLocation {
        location: Location::Unknown,
        id: index as u64,
        file_index: 0,
    };
    found.extend(left.iter().map(unknown));
    found
}

/// Visitor that finds the locations of some items of a list, in ascending order of their indices.
struct LocationVisitor<'a> {
    list: ItemList,
    /// The indices not found yet, ascending.
    left: &'a [usize],
    /// The index of the next item of the list.
    next: usize,
    found: Vec<ItemLocation>,
    source: &'a Source,
}

impl LocationVisitor<'_> {
    /// Advances to the next item of the list, and stores the item's location if its index is wanted.
    fn pass(&mut self, cursor: &Cursor<'_>, label: u64) {
        if self.left.first() == Some(&self.next) {
            let mut files = self.source.files();
            let file_index = files.position(|file| std::ptr::eq(file, cursor.source)).unwrap_or(0);
            self.found.push(ItemLocation { location: cursor.location(), id: label, file_index });
            self.left = &self.left[1..];
        }
        self.next += 1;
    }

    /// Returns an error once all items are found, to stop the reader. [`locate`] discards the error.
    fn end_if_found(&self, cursor: &Cursor<'_>) -> Result<(), ReadError> {
        if self.left.is_empty() { Err(cursor.error("", "")) } else { Ok(()) }
    }
}

impl MeshVisitor for LocationVisitor<'_> {
    fn asks_for_nodes(&self) -> bool {
        self.list == ItemList::Nodes
    }

    fn node(&mut self, cursor: &Cursor<'_>, id: u64, _: u64, _: usize, _: [f64; 2]) {
        if self.list == ItemList::Nodes {
            self.pass(cursor, id);
        }
    }

    fn end_nodes(&mut self, cursor: &Cursor<'_>) -> Result<(), ReadError> {
        self.end_if_found(cursor)
    }

    fn visit_element(&mut self, cursor: &Cursor<'_>, element: &Element) -> Result<(), ReadError> {
        if self.list.has(element.kind) {
            self.pass(cursor, element.id);
            return self.end_if_found(cursor);
        }
        Ok(())
    }
}
