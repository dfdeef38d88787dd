//! Visitor of a second reading, which collects the parameters of vertices on surfaces of a model.

use crate::content::id_index::IdIndex;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::field::PointField;
use crate::visit::items::PointNumbers;
use crate::visit::reader::ReaderFunctions;
use crate::visit::visitor::MeshVisitor;

/// Returns a field for each surface, with two parameters for each of its vertices. The file must have been read before.
pub(crate) fn parameters(
    reader: &ReaderFunctions,
    source: &Source,
) -> Result<Vec<PointField>, ReadError> {
    let mut visitor = ParameterVisitor::default();
    (reader.visit)(source, &mut visitor)?;
    // Repeated ids would have been an error of the first reading.
    let map = IdIndex::new(&visitor.ids).unwrap_or(IdIndex::Run { first: 0, count: 0 });
    let field = |(surface, numbers): (i64, PointNumbers)| {
        let nodes = numbers.nodes.as_deref().unwrap_or_default();
        let vertices = nodes.iter().map(|&node| map.index(node).unwrap_or(u32::MAX)).collect();
        let name = format!("parameters on surface {surface}");
        PointField::new(name, 2, visitor.ids.len(), numbers, Some(vertices))
    };
    Ok(visitor.found.into_iter().map(field).collect())
}

/// Visitor that collects the parameters of nodes on surfaces of a model.
#[derive(Default)]
struct ParameterVisitor {
    ids: Vec<u64>,
    surface: i64,
    found: Vec<(i64, PointNumbers)>,
}

impl MeshVisitor for ParameterVisitor {
    fn allows_parallel(&self) -> bool {
        true
    }

    fn node(&mut self, _: &Cursor<'_>, id: u64, _: u64, _: usize, _: [f64; 2]) {
        self.ids.push(id);
    }

    fn parameters(&mut self, surface: i64) -> bool {
        self.surface = surface;
        true
    }

    fn parameter_numbers(&mut self, numbers: PointNumbers) {
        self.found.push((self.surface, numbers));
    }
}
