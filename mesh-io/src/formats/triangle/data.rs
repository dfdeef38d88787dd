//! The attributes of vertices in a `.node` of the mesh generator Triangle.

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::formats::triangle::mesh::{attribute_names, rows, vertex_header};
use crate::precision::Precision;
use crate::visit::field::PointField;
use crate::visit::heights::TextNumbers;
use crate::visit::point_data::{PointData, Wanted};

/// Reads the wanted attributes of vertices. The file must have been read before.
pub(crate) fn point_data(node: &Source, wanted: Wanted<'_>) -> Result<PointData, ReadError> {
    let cursor = &mut rows(node);
    let count = vertex_header(cursor)?;
    let attributes = cursor.integer_or(0, "the number of attributes per vertex")?;
    let mut data = PointData::default();
    // A row cannot hold more attributes than this.
    let most = cursor.capacity(attributes, 1) as u64;
    for (column, name) in attribute_names(most).enumerate() {
        let is_wanted = match wanted {
            Wanted::Named(names) => names.contains(&name),
            Wanted::Real => true,
        };
        data.known.push((name.clone(), true));
        if is_wanted {
            let mut numbers = TextNumbers::default();
            numbers.column(cursor.clone(), count, 3 + column as u64)?;
            let numbers = numbers.finish(Precision::Double, None);
            data.fields.push(PointField::new(name, 1, count as usize, numbers, None));
        }
    }
    Ok(data)
}
