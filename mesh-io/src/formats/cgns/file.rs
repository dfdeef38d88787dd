//! A CGNS file with one zone, and access to the content of its nodes.

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::hdf5::{Dataset, DatasetArray, Datatype, Hdf5, Object};
use crate::text::cursor::Cursor;

/// A CGNS file with its base and its only zone.
pub(super) struct File<'a> {
    pub(super) source: &'a Source,
    pub(super) hdf5: &'a Hdf5<'a>,
    pub(super) base: &'a Object,
    pub(super) zone: &'a Object,
}

impl<'a> File<'a> {
    pub(super) fn open(source: &'a Source, hdf5: &'a Hdf5<'a>) -> Result<File<'a>, ReadError> {
        let refused = |problem: String, remedy| {
            Err(Cursor::at_byte_offset(source, hdf5.root().at).error(problem, remedy))
        };
        let bases = labeled(hdf5, hdf5.root(), b"CGNSBase_t");
        let zones: Vec<_> = bases
            .iter()
            .flat_map(|&(_, base)| {
                labeled(hdf5, base, b"Zone_t").into_iter().map(move |zone| (base, zone))
            })
            .collect();
        let &[(base, (_, zone))] = &zones[..] else {
            let problem = format!("a CGNS file of {} zones is not read", zones.len());
            return refused(problem, "Save a mesh of one unstructured zone, or as gmsh or VTK");
        };
        let file = File { source, hdf5, base, zone };
        let kind = labeled(hdf5, zone, b"ZoneType_t").first().and_then(|(_, kind)| file.text(kind));
        if kind.is_some_and(|kind| kind != b"Unstructured") {
            return refused("a structured zone is not read".into(), "Save an unstructured mesh");
        }
        Ok(file)
    }

    pub(super) fn cursor(&self, object: &Object) -> Cursor<'a> {
        Cursor::at_byte_offset(self.source, object.at)
    }

    /// Returns the dataset with the content of a node; `None` if the node has no content.
    pub(super) fn data(&self, node: &'a Object) -> Option<&'a Object> {
        self.hdf5.child(node, b" data")
    }

    /// Returns the integers of a node; `None` if the node has no integers.
    pub(super) fn integers(&self, node: &'a Object) -> Option<Vec<i64>> {
        self.hdf5.integers(self.data(node)?)
    }

    /// Returns the text of a node, without blanks around it. CGNS stores each character as an integer of 8 bits.
    pub(super) fn text(&self, node: &'a Object) -> Option<Vec<u8>> {
        let letters = self.integers(node)?;
        let text: Vec<u8> = letters.into_iter().map(|letter| letter as u8).collect();
        Some(text.trim_ascii().to_vec())
    }

    /// Returns the dataset and the content of a node with real numbers; `None` if the node has no real numbers.
    ///
    /// # Errors
    /// If the dataset is damaged.
    pub(super) fn reals(
        &self,
        node: &'a Object,
    ) -> Result<Option<(Dataset, DatasetArray<'a>)>, ReadError> {
        let dataset = self.data(node).map(|data| self.hdf5.dataset(data)).transpose()?.flatten();
        let dataset = dataset.filter(|dataset| matches!(dataset.datatype, Datatype::Real(..)));
        dataset
            .map(|dataset| Ok((self.hdf5.array(&dataset)?, dataset)).map(|(a, d)| (d, a)))
            .transpose()
    }
}

/// Returns the children of a node with a CGNS label, such as `Zone_t`, each with its name.
pub(super) fn labeled<'h>(
    file: &'h Hdf5<'_>,
    of: &'h Object,
    label: &[u8],
) -> Vec<(&'h [u8], &'h Object)> {
    let is =
        |node: &Object| file.attribute(node, b"label").is_some_and(|own| own.text() == Some(label));
    file.children(of).filter(|(_, node)| is(node)).collect()
}
