//! Reads arrays of cell data, one value for each triangle and each quadrilateral.

use crate::content::decoded::decoded;
use crate::content::regions::Interner;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element, RegionAttribute};
use crate::visit::reader::ReaderFunctions;
use crate::visit::visitor::MeshVisitor;
use std::collections::HashMap;

/// Reads the cell data of these names. Returns for each name the value of each triangle and then of each quadrilateral, NaN
/// for an element without a value. The list is empty for a name that the file lacks. Region arrays of usual names, which
/// readers pass as regions of elements, yield numbers, equal ones for equal regions.
///
/// # Errors
/// If the file cannot be read.
pub(crate) fn cell_values(
    reader: &ReaderFunctions,
    source: &Source,
    names: &[String],
) -> Result<Vec<Vec<f64>>, ReadError> {
    let parts = names.iter().map(|_| Vec::new()).collect();
    let columns = Default::default();
    let ids = Default::default();
    let mut visitor = ValueVisitor { names, parts, columns, announced: None, ids };
    (reader.visit)(source, &mut visitor)?;
    let ValueVisitor { parts, columns, ids, .. } = visitor;
    let mut of_columns: Vec<Vec<f64>> = names.iter().map(|_| Vec::new()).collect();
    for Column { array, numbers, .. } in columns {
        if let Some(array) = array {
            of_columns[array] = numbers.concat();
        }
    }
    let of_elements = |(parts, of_column): (Vec<Part>, Vec<f64>)| {
        if parts.is_empty() {
            return of_column;
        }
        let mut values: HashMap<u64, f64> = HashMap::new();
        for Part { numbers, ids } in parts {
            match ids {
                Some(ids) => values.extend(ids.into_iter().zip(numbers)),
                None => values.extend((0..).zip(numbers)),
            }
        }
        let value = |id| values.get(id).copied().unwrap_or(f64::NAN);
        ids.iter().flatten().map(value).collect()
    };
    Ok(parts.into_iter().zip(of_columns).map(of_elements).collect())
}

/// Values of an array that one call of the reader passes, with the ids of their elements; `None` if the value at index
/// `i` belongs to the element with id `i`.
struct Part {
    numbers: Vec<f64>,
    ids: Option<Vec<u64>>,
}

/// One of the two integers of [`Element::region`].
#[derive(Default)]
struct Column {
    /// Index of the wanted array whose numbers the integers are; `None` for an array that is not wanted.
    array: Option<usize>,
    met: Interner<i64>,
    /// Number of the integer of each triangle, and of each quadrilateral.
    numbers: [Vec<f64>; 2],
}

/// Visitor that collects cell data and the ids of all triangles and quadrilaterals.
struct ValueVisitor<'n> {
    names: &'n [String],
    /// Parts of each wanted array, in file order.
    parts: Vec<Vec<Part>>,
    columns: [Column; 2],
    /// Index of the array whose numbers come next.
    announced: Option<usize>,
    /// Ids of the triangles, and of the quadrilaterals.
    ids: [Vec<u64>; 2],
}

impl MeshVisitor for ValueVisitor<'_> {
    fn allows_parallel(&self) -> bool {
        true
    }

    fn node(&mut self, _: &Cursor<'_>, _: u64, _: u64, _: usize, _: [f64; 2]) {}

    fn visit_element(&mut self, _: &Cursor<'_>, element: &Element) -> Result<(), ReadError> {
        let kind = match element.kind {
            CellKind::Triangle => 0,
            CellKind::Quadrilateral => 1,
            _ => return Ok(()),
        };
        self.ids[kind].push(element.id);
        for (column, region) in self.columns.iter_mut().zip(element.region) {
            if column.array.is_some() {
                column.numbers[kind].push(column.met.intern(region).into());
            }
        }
        Ok(())
    }

    fn region_attributes(&mut self, columns: Vec<RegionAttribute>) {
        for (own, column) in self.columns.iter_mut().zip(columns) {
            own.array = self.names.iter().position(|name| *name == column.kind);
        }
    }

    fn asks_for_cell_arrays(&self) -> bool {
        true
    }

    fn cell_array(&mut self, name: &[u8], components: u64, _: bool) -> bool {
        let index = self.names.iter().position(|own| *own == decoded(name));
        self.announced = index.filter(|_| components == 1);
        self.announced.is_some()
    }

    fn cell_numbers(&mut self, numbers: Vec<f64>, ids: Option<Vec<u64>>) {
        if let Some(index) = self.announced.take() {
            self.parts[index].push(Part { numbers, ids });
        }
    }
}
