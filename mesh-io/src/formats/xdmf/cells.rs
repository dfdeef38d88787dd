//! The elements of an XDMF file.

use super::File;
use super::document::Item;
use super::heavy;
use crate::binary::byte_order::IntegerType;
use crate::binary::int_array::IntArray;
use crate::error::ReadError;
use crate::formats::vtk::cells::Cell;
use crate::formats::vtk::regions::{MAX_ARRAYS, RegionNumbers, names_regions, unread_regions};
use crate::formats::vtk::types;
use crate::text::cursor::{CORRECT, Cursor};
use crate::text::token::quoted;
use crate::visit::items::RegionAttribute;
use crate::visit::records::TriangleRecords;
use crate::visit::visitor::MeshVisitor;

/// Region numbers of mesh tags, in addition to the arrays of the mesh.
#[derive(Default)]
pub(super) struct TagRegions {
    /// The numbers of all cells of the mesh, for each list of mesh tags.
    pub(super) numbers: Vec<(RegionAttribute, Vec<i64>)>,
    /// Least dimension of elements with numbers in the arrays of the mesh.
    pub(super) from_dimension: u8,
}

/// Stream of the integers of a Topology, in the XML or in a companion file.
pub(super) enum CellNumbers<'a> {
    Text(Cursor<'a>),
    /// Integers of a companion file: `taken` of them were taken, each is `size` bytes wide.
    Heavy {
        numbers: Box<heavy::HeavyArray<'a>>,
        whole: IntArray<'a>,
        taken: usize,
        size: usize,
    },
}

impl<'a> CellNumbers<'a> {
    /// Returns a cursor for messages: at the next integer in a companion file, at the current word in the XML.
    fn cursor(&self) -> Cursor<'a> {
        match self {
            CellNumbers::Text(cursor) => cursor.clone(),
            CellNumbers::Heavy { numbers, taken, size, .. } => numbers.cursor(taken * size),
        }
    }

    /// Returns whether another integer follows. In the XML, the cursor moves to the next word.
    pub(super) fn has_next(&mut self) -> bool {
        match self {
            CellNumbers::Text(cursor) => cursor.next_word(),
            CellNumbers::Heavy { whole, taken, .. } => *taken < whole.len(),
        }
    }

    /// Takes the next integer, called `what` in messages. A companion file must have one left.
    pub(super) fn take(&mut self, what: &str) -> Result<u64, ReadError> {
        match self {
            CellNumbers::Text(cursor) => cursor.integer(what),
            CellNumbers::Heavy { whole, taken, .. } => {
                *taken += 1;
                Ok(whole.at(*taken - 1))
            }
        }
    }

    #[cold]
    fn error(&self, problem: impl Into<String>, remedy: &str) -> ReadError {
        self.cursor().error(problem, remedy)
    }
}

impl<'a> File<'a> {
    /// Visits the elements of a Topology with their region numbers. `tags` are further region numbers, one for each cell.
    /// Returns the number of cells, and the arrays that number regions.
    ///
    /// # Errors
    /// If the Topology is damaged, or if its attributes announce other counts of elements or integers.
    pub(super) fn elements(
        &self,
        item: &Item,
        tags: TagRegions,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(u64, Vec<&Item>), ReadError> {
        let is_region = |item: &&Item| !self.is_real(item) && names_regions(item.name.as_bytes());
        let (mut of_regions, mut regions): (Vec<&Item>, Vec<Vec<i64>>) = (Vec::new(), Vec::new());
        for own in self.attributes("cell").filter(is_region) {
            let known = of_regions.iter().any(|other| other.name == own.name);
            if regions.len() == MAX_ARRAYS || known {
                continue;
            }
            match self.integers(own) {
                Ok(numbers) => {
                    of_regions.push(own);
                    regions.push(numbers);
                }
                Err(_) => visitor.remark(unread_regions(own.name.as_bytes())),
            }
        }
        let mut attributes: Vec<_> = of_regions
            .iter()
            .map(|own| RegionAttribute::tags(&own.name, tags.from_dimension))
            .collect();
        for (attribute, numbers) in tags.numbers {
            if regions.len() < MAX_ARRAYS {
                attributes.push(attribute);
                regions.push(numbers);
            } else {
                visitor.unsupported("mesh tags of triangles, of which two are read");
            }
        }
        let regions = RegionNumbers::from_iter(regions);
        visitor.region_attributes(attributes);
        let words = &mut self.words(item)?;
        let (mut id, mut count) = self.triangles(item, words, &regions, visitor);
        let mut points = Vec::new();
        while words.has_next() {
            let (cell_type, corners) = match item.kind.as_str() {
                "mixed" => mixed(words, &mut count)?,
                kind => self.uniform(item, kind)?,
            };
            points.clear();
            let own = words.cursor();
            for _ in 0..corners {
                if !words.has_next() {
                    let problem = format!("the Topology ends within cell {id}");
                    return Err(words.error(problem, CORRECT));
                }
                points.push(words.take("a node of a cell")?);
            }
            count += corners;
            let region = regions.of(id as usize);
            Cell { id, cell_type, points: &points, region }.send(&own, visitor)?;
            id += 1;
        }
        let differs = |announced: Option<u64>, found: u64| announced.is_some_and(|n| n != found);
        if differs(item.elements, id) || differs(item.announced(), count) {
            let problem = format!("the Topology ends after {id} elements of {count} numbers");
            return Err(words.error(problem, "Its attributes announce other numbers: correct them"));
        }
        Ok((id, of_regions))
    }

    pub(super) fn words(&self, item: &Item) -> Result<CellNumbers<'a>, ReadError> {
        let Some(mut numbers) = self.heavy.read(item, &self.cursor(item))? else {
            let cursor = self.content(item);
            return Ok(CellNumbers::Text(cursor));
        };
        let Some((IntegerType { bytes: size, .. }, order)) = numbers.whole() else {
            let problem = "a Topology with fractions";
            return Err(self.cursor(item).error(problem, "Save the mesh again"));
        };
        let whole = IntArray::binary(std::mem::take(&mut numbers.bytes), size, order);
        Ok(CellNumbers::Heavy { numbers: Box::new(numbers), whole, taken: 0, size })
    }

    /// Visits triangles of a companion file in bulk. Returns the number of triangles taken by the visitor, and the
    /// number of Topology integers consumed.
    fn triangles(
        &self,
        item: &Item,
        words: &mut CellNumbers<'_>,
        regions: &RegionNumbers,
        visitor: &mut dyn MeshVisitor,
    ) -> (u64, u64) {
        let CellNumbers::Heavy { whole, taken, .. } = words else {
            let room = words.cursor().capacity(item.elements.unwrap_or(0), "0 1 2 ".len());
            visitor.expect_elements(room);
            return (0, 0);
        };
        visitor.expect_elements(whole.len() / 4);
        if item.kind != "triangle" {
            return (0, 0);
        }
        let found = visitor.triangle_records(&TriangleRecords {
            count: whole.len() / 3,
            nodes: whole.field(0, 3),
            min_node: 0,
            node_end: u64::MAX,
            regions: regions.from(0),
            required_fields: &[],
        });
        *taken = 3 * found;
        (found as u64, *taken as u64)
    }

    /// Returns VTK's cell type and the number of nodes for all elements of a Topology of one `kind`. Polyvertices,
    /// polylines and polygons have as many nodes as `NodesPerElement`, else the second dimension, announces.
    pub(super) fn uniform(&self, item: &Item, kind: &str) -> Result<(u64, u64), ReadError> {
        let several = item.corners.or_else(|| item.dimensions.get(1).copied());
        Ok(match kind {
            "triangle" => (types::TRIANGLE, 3),
            "quadrilateral" => (types::QUAD, 4),
            "polyvertex" => of_several(1, several.unwrap_or(1).max(1)),
            "polyline" => of_several(2, several.unwrap_or(2).max(1)),
            "polygon" => of_several(3, several.unwrap_or(3).max(1)),
            "tetrahedron" => (types::TETRA, 4),
            "hexahedron" => (types::HEXAHEDRON, 8),
            "wedge" => (types::WEDGE, 6),
            "pyramid" => (types::PYRAMID, 5),
            other => {
                let problem =
                    format!("a Topology of the type {} is not read", quoted(other.as_bytes()));
                let remedy = "Save a mesh of linear triangles (Triangle, or Mixed)";
                return Err(self.cursor(item).error(problem, remedy));
            }
        })
    }

    /// Visits the arrays of cell data that the visitor wants, except the region arrays `regions`.
    pub(super) fn cell_data(&self, regions: &[&Item], cells: u64, visitor: &mut dyn MeshVisitor) {
        for item in self.attributes("cell") {
            let is_region = regions.iter().any(|own| own.at == item.at);
            let (is_real, components) = (self.is_real(item), item.components(cells));
            if !is_region
                && visitor.cell_array(item.name.as_bytes(), components, is_real)
                && let Ok(numbers) = self.numbers(item)
            {
                visitor.cell_numbers(numbers.numbers, Some((0..cells).collect()));
            }
        }
        let is_other = |item: &&Item| !matches!(item.center.as_str(), "node" | "cell");
        if self.items.iter().filter(|i| i.section == "Attribute").any(|i| is_other(&i)) {
            visitor.unsupported("data of grids, faces or edges");
        }
    }

    pub(super) fn integers(&self, item: &Item) -> Result<Vec<i64>, ReadError> {
        if let Some(numbers) = self.heavy.read(item, &self.cursor(item))? {
            let whole = numbers.integers();
            return whole.ok_or_else(|| {
                self.cursor(item).error("the numbers of cells are not whole", CORRECT)
            });
        }
        let cursor = &mut self.content(item);
        let mut numbers = Vec::new();
        while cursor.next_word() {
            numbers.push(cursor.signed("a number of a cell")?);
        }
        Ok(numbers)
    }
}

/// Reads the type of the next element of a mixed Topology. Returns VTK's cell type and the number of nodes; adds the
/// integers read to `count`.
fn mixed(words: &mut CellNumbers<'_>, count: &mut u64) -> Result<(u64, u64), ReadError> {
    *count += 1;
    let place = words.cursor();
    let number = words.take("the type of a cell")?;
    Ok(match number {
        1..=3 => {
            *count += 1;
            if !words.has_next() {
                return Err(words.error("the number of a cell's nodes is missing", CORRECT));
            }
            of_several(number, words.take("a number of nodes")?)
        }
        4 => (types::TRIANGLE, 3),
        5 => (types::QUAD, 4),
        6 => (types::TETRA, 4),
        7 => (types::PYRAMID, 5),
        8 => (types::WEDGE, 6),
        9 => (types::HEXAHEDRON, 8),
        other => {
            let problem =
                format!("cells of the type {other} are not read, as only first-order cells are");
            let remedy = "Save a mesh of linear triangles (type 4)";
            return Err(place.error(problem, remedy));
        }
    })
}

/// Returns VTK's cell type for an element with XDMF's type `number` (1 a polyvertex, 2 a polyline, 3 a polygon), and
/// passes on the number of nodes.
fn of_several(number: u64, nodes: u64) -> (u64, u64) {
    let cell_type = match (number, nodes) {
        (1, 1) => types::VERTEX,
        (1, _) => types::POLY_VERTEX,
        (2, 2) => types::LINE,
        (2, _) => types::POLY_LINE,
        _ => types::POLYGON,
    };
    (cell_type, nodes)
}
