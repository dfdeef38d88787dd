//! XDMF, versions 2 and 3, with its numbers in the XML or in companion files, HDF5 or raw.
//!
//! The format: <https://www.xdmf.org/index.php/XDMF_Model_and_Format>. A file has a single mesh. Data may have several
//! time steps, in grids that refer to the grid with the mesh. Mesh tags are in grids that refer to its Geometry.

mod cells;
mod companions;
mod document;
mod heavy;
mod points;
mod tags;
pub(crate) mod write;

use crate::disk::source::Source;
use crate::edit::numbers::ByteEdit;
use crate::error::{ReadError, WriteError};
use crate::hdf5::Datatype;
use crate::precision::Precision;
use crate::text::cursor::Cursor;
use crate::text::token::quoted;
use crate::visit::items::PointNumbers;
use crate::visit::reader::FormatReader;
use crate::visit::shared::{SharedBytes, shared_bytes};
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::z_values::TextNumbers;
use document::{Content, Item};
use heavy::HeavyData;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

pub(crate) struct Xdmf;

impl FormatReader for Xdmf {
    const VERTICES: &'static str = "Geometry";

    fn load_companions(mut given: Source) -> Result<Source, ReadError> {
        let references = document::items(&given)?.into_iter().filter_map(Item::reference);
        companions::load(&mut given, references.collect())?;
        Ok(given)
    }

    fn require_single(source: &Source) -> Result<(), ReadError> {
        match document::items(source)?.into_iter().find_map(Item::reference) {
            None => Ok(()),
            Some(reference) => {
                let name = quoted(reference.name.as_bytes());
                let problem = format!("its numbers are in the file {name}");
                Err(source.error(
                    problem,
                    "Name the file instead of its content, so that both files are read",
                ))
            }
        }
    }

    fn destinations(source: &Source, path: &Path) -> Result<Vec<PathBuf>, WriteError> {
        companions::destinations(source, path)
    }

    fn renames(source: &Source, path: &Path) -> Vec<ByteEdit> {
        companions::renames(source, path)
    }

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let (items, tagged) = document::split(document::items(source)?);
        let heavy = HeavyData::open(source)?;
        let shared = shared(items.iter().chain(&tagged), &heavy);
        let file = File { source, items, tagged, heavy, shared };
        let geometry = file.only("Geometry")?;
        let (layout, points) = file.points(geometry, visitor)?;
        let shared_with = file.shared.get(&geometry.at).map(|shared| shared.other.clone());
        let topology = file.only("Topology")?;
        let (tags, lines) = file.tag_regions(topology)?;
        let (cells, regions) = file.elements(topology, tags, visitor)?;
        let mut id = cells;
        for tags in lines {
            id = file.lines_of_tags(tags, id, visitor)?;
        }
        if visitor.asks_for_data() {
            document::left_out(source)?.iter().for_each(|what| visitor.unsupported(what));
        }
        if visitor.asks_for_cell_arrays() {
            file.cell_data(&regions, cells, visitor);
        }
        file.point_data(points, visitor);
        file.heavy.check_no_overlaps()?;
        Ok(CoordinateStorage { shared_with, ..layout })
    }
}

/// An XDMF file with its items and companion files.
struct File<'a> {
    source: &'a Source,
    /// Items of the mesh and its data.
    items: Vec<Item>,
    /// Items of mesh tags.
    tagged: Vec<Item>,
    heavy: HeavyData<'a>,
    /// Items with bytes of other items in companion files, by the offsets of their tags.
    shared: HashMap<usize, SharedBytes>,
}

/// Returns the items with bytes of other items in companion files, by the offsets of their tags: several attributes may
/// name one dataset, or the dataset of the points.
fn shared<'i>(
    items: impl Iterator<Item = &'i Item>,
    heavy: &HeavyData<'_>,
) -> HashMap<usize, SharedBytes> {
    let items: Vec<&Item> = items.collect();
    let ranges: Vec<_> = items.iter().map(|item| heavy.range_of(item)).collect();
    let name = |index: usize| match items[index].section.as_str() {
        "Geometry" => "the points".to_owned(),
        "Topology" => "the elements".to_owned(),
        _ => format!("'{}'", quoted(items[index].name.as_bytes())),
    };
    let found = shared_bytes(&ranges, name);
    items.iter().zip(found).filter_map(|(item, own)| Some((item.at, own?))).collect()
}

impl Item {
    /// Returns the numbers per owner of data of `owners` points or cells: at least 1, and 1 if `Dimensions` is missing.
    fn components(&self, owners: u64) -> u64 {
        self.announced().and_then(|count| count.checked_div(owners)).unwrap_or(1).max(1)
    }
}

impl<'a> File<'a> {
    /// Returns the sole item of a section.
    ///
    /// # Errors
    /// If the section has no item with numbers, or several in the file.
    fn only(&self, section: &str) -> Result<&Item, ReadError> {
        let mut items = self.items.iter().filter(|item| item.section == section);
        match (items.next(), items.next()) {
            (Some(item), None) => Ok(item),
            (None, _) => {
                let problem = format!("it has no {section} with numbers");
                Err(self.source.error(problem, "Save an unstructured mesh again"))
            }
            (_, Some(second)) => {
                let problem = format!("this is the second {section}");
                Err(self.cursor(second).error(problem, "Save each mesh to a separate file"))
            }
        }
    }

    /// Returns the items with data of `center`: `node` or `cell`.
    fn attributes(&self, center: &str) -> impl Iterator<Item = &Item> {
        self.items.iter().filter(move |item| item.section == "Attribute" && item.center == center)
    }

    fn cursor(&self, item: &Item) -> Cursor<'a> {
        Cursor::on_line_of(self.source, item.at)
    }

    /// Returns a cursor before the numbers of an item in the XML. The cursor of an item in a companion file has no
    /// words.
    fn content(&self, item: &Item) -> Cursor<'a> {
        let range = match &item.content {
            Content::Text(range) => range.clone(),
            _ => item.at..item.at,
        };
        Cursor::within(self.source, range)
    }

    /// Returns whether an item has real numbers. In a companion file, the type of the dataset decides, not the tag.
    fn is_real(&self, item: &Item) -> bool {
        match self.heavy.number(item) {
            Some(number) => matches!(number, Datatype::Real(..)),
            None => item.precision.is_some(),
        }
    }

    /// Visits the data of `points` points.
    fn point_data(&self, points: u64, visitor: &mut dyn MeshVisitor) {
        for item in self.attributes("node") {
            let (components, is_real) = (item.components(points), self.is_real(item));
            if visitor.point_array(item.name.as_bytes(), components, is_real)
                && let Ok(mut numbers) = self.numbers(item)
            {
                if let Some(stored) = &mut numbers.location {
                    stored.shared = self.shared.get(&item.at).cloned();
                }
                visitor.point_numbers(numbers);
            }
        }
    }

    /// Reads the numbers of an item with data. Only real numbers can be rewritten.
    fn numbers(&self, item: &Item) -> Result<PointNumbers, ReadError> {
        if let Some(mut numbers) = self.heavy.read(item, &self.cursor(item))? {
            let reals = numbers.reals();
            let Some(reals) = reals else {
                return Err(self
                    .cursor(item)
                    .error("the data are not numbers", "Save the data as Float or Int"));
            };
            let stored = heavy::stored(&mut numbers, &self.heavy);
            return Ok(PointNumbers { numbers: reals, nodes: None, location: stored });
        }
        let cursor = &mut self.content(item);
        let mut numbers = TextNumbers::default();
        while cursor.next_word() {
            numbers.read(cursor)?;
        }
        let numbers = numbers.finish(item.precision.unwrap_or(Precision::Double), None);
        let stored = numbers.location.filter(|_| item.precision.is_some());
        Ok(PointNumbers { location: stored, ..numbers })
    }
}
