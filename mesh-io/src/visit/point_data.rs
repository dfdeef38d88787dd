//! Visitor of a second reading, which collects arrays of point data.

use crate::content::decoded::decoded;
use crate::content::id_index::IdIndexBuilder;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::field::PointField;
use crate::visit::items::PointNumbers;
use crate::visit::reader::ReaderFunctions;
use crate::visit::visitor::MeshVisitor;
use std::collections::HashSet;

/// The arrays of point data to read.
#[derive(Clone, Copy)]
pub(crate) enum FieldSelection<'n> {
    /// Arrays with these names, of real or whole numbers.
    Named(&'n [String]),
    /// All arrays of real numbers.
    Real,
}

/// Arrays of point data in a file.
#[derive(Default)]
pub(crate) struct PointData {
    /// The selected arrays in file order. Several arrays may have equal names.
    pub(crate) fields: Vec<PointField>,
    /// Distinct names of all arrays in the file, each with whether its numbers are real.
    pub(crate) known: Vec<(String, bool)>,
}

/// Reads a file again, and returns the selected arrays of point data.
pub(crate) fn point_data(
    reader: &ReaderFunctions,
    source: &Source,
    wanted: FieldSelection<'_>,
) -> Result<PointData, ReadError> {
    let (last, ids, found) = (Default::default(), IdIndexBuilder::default(), PointData::default());
    let (is_third, named) = (false, HashSet::new());
    let mut visitor = PointDataVisitor { wanted, last, is_third, ids, found, named };
    (reader.visit)(source, &mut visitor)?;
    Ok(visitor.found)
}

/// Visitor that collects arrays of point data.
struct PointDataVisitor<'n> {
    wanted: FieldSelection<'n>,
    /// Name and number of components of the array announced last.
    last: (String, usize),
    /// Whether this array has the third numbers of the points.
    is_third: bool,
    ids: IdIndexBuilder,
    found: PointData,
    /// The names in `found.known` as a set, as a damaged file may announce very many names.
    named: HashSet<String>,
}

impl MeshVisitor for PointDataVisitor<'_> {
    fn allows_parallel(&self) -> bool {
        true
    }

    fn node(&mut self, _: &Cursor<'_>, id: u64, _: u64, _: usize, _: [f64; 2]) {
        self.ids.push(id);
    }

    fn asks_for_data(&self) -> bool {
        true
    }

    fn z_array(&mut self, name: &[u8]) -> bool {
        let is_wanted = self.point_array(name, 1, true);
        self.is_third = name == b"z";
        is_wanted
    }

    fn point_array(&mut self, name: &[u8], components: u64, is_real: bool) -> bool {
        self.is_third = false;
        let name = decoded(name);
        let wanted = match self.wanted {
            FieldSelection::Named(names) => names.contains(&name),
            FieldSelection::Real => is_real,
        };
        if self.named.insert(name.clone()) {
            self.found.known.push((name.clone(), is_real));
        }
        self.last = (name, usize::try_from(components).unwrap_or(usize::MAX));
        wanted
    }

    fn point_numbers(&mut self, numbers: PointNumbers) {
        let index = |&node: &u64| self.ids.index(node).unwrap_or(u32::MAX);
        let vertices = numbers.nodes.as_ref().map(|nodes| nodes.iter().map(index).collect());
        let (name, components) = std::mem::take(&mut self.last);
        let count = self.ids.len();
        let field = PointField::new(name, components, count, numbers, vertices);
        self.found.fields.push(if self.is_third { field.of_third_numbers() } else { field });
    }
}
