//! XDMF, versions 2 and 3, with its numbers in the XML.
//!
//! The format: <https://www.xdmf.org/index.php/XDMF_Model_and_Format>. A file has one mesh; data of it may be of several time steps,
//! whose grids refer to the one with the mesh.

mod document;

use crate::error::ReadError;
use crate::file::format::Format;
use crate::file::heights::{Heights, TextNumbers};
use crate::file::numbers::Numbers;
use crate::file::sink::{Column, Layout, PointNumbers, Sink, Walk};
use crate::file::source::Source;
use crate::file::text::{CORRECT, Cursor};
use crate::file::token::quoted;
use crate::file::vtk;
use crate::mesh::Precision;
use document::Item;

pub(crate) struct Xdmf;

/// How many arrays tell regions at most.
const MOST: usize = 2;

impl Walk for Xdmf {
    const VERTICES: &'static str = "Geometry";

    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        let items = document::items(source)?;
        let file = File { source, items };
        let geometry = file.only("Geometry")?;
        let points = file.points(geometry, sink)?;
        file.elements(file.only("Topology")?, sink)?;
        for item in file.attributes("node") {
            if sink.point_array(
                item.name.as_bytes(),
                item.components(points),
                item.precision.is_some(),
            ) && let Ok(numbers) = file.numbers(item)
            {
                let numbers = numbers.finish(item.precision.unwrap_or(Precision::Double), None);
                let stored = numbers.stored.filter(|_| item.precision.is_some());
                sink.point_numbers(PointNumbers { stored, ..numbers });
            }
        }
        let precision = geometry.precision.unwrap_or(Precision::Double);
        Ok(Layout::in_place(Format::Xdmf, Numbers::Text { precision }))
    }
}

/// A file with its items.
struct File<'a> {
    source: &'a Source,
    items: Vec<Item>,
}

impl Item {
    /// How many numbers each of so many owners has.
    fn components(&self, owners: u64) -> u64 {
        self.announced().and_then(|count| count.checked_div(owners)).unwrap_or(1).max(1)
    }
}

impl File<'_> {
    /// The item of a section that a mesh has once.
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
                let remedy = "Save each mesh to a file of its own";
                Err(self.cursor(second).error(problem, remedy))
            }
        }
    }

    /// The data of nodes or cells.
    fn attributes(&self, center: &str) -> impl Iterator<Item = &Item> {
        self.items.iter().filter(move |item| item.section == "Attribute" && item.center == center)
    }

    fn cursor(&self, item: &Item) -> Cursor<'_> {
        Cursor::standing_at(self.source, item.at)
    }

    /// Stands before the numbers of an item.
    fn content(&self, item: &Item) -> Cursor<'_> {
        Cursor::within(self.source, item.content.clone())
    }

    /// Hands on the points. Returns how many there are.
    fn points(&self, item: &Item, sink: &mut dyn Sink) -> Result<u64, ReadError> {
        let axes = match item.kind.as_str() {
            "xy" => 2,
            "" | "xyz" => 3,
            other => {
                let problem = format!("a Geometry of the type {}", quoted(other.as_bytes()));
                return Err(self.cursor(item).error(problem, "Save points as XY or XYZ"));
            }
        };
        if item.precision.is_none() {
            let problem = "points that are whole numbers";
            return Err(self.cursor(item).error(problem, "Save them as Float"));
        }
        let announced = item.announced();
        let count = announced.map(|count| count / axes);
        self.cursor(item).check_vertex_count(count.unwrap_or(0))?;
        let cursor = &mut self.content(item);
        sink.expect_nodes(cursor.capacity(count.unwrap_or(0), "0 0 ".len()));
        let mut heights = Heights::new(sink);
        let mut index = 0;
        while cursor.next_word() {
            if Some(index) == count {
                return Err(cursor.error(format!("more than the {index} points"), CORRECT));
            }
            let own = cursor.clone();
            let mut point = [0.0; 3];
            let mut places = [0; 3];
            for axis in 0..axes as usize {
                if !cursor.next_word() {
                    return Err(cursor.error(format!("point {index} is not whole"), CORRECT));
                }
                places[axis] = cursor.at();
                let owner = format_args!("point {index}");
                point[axis] = match axis {
                    2 => cursor.height(owner)?.1,
                    _ => cursor.coordinate(['x', 'y'][axis], owner)?,
                };
            }
            sink.node(&own, index, 2, places[0], [point[0], point[1]]);
            if axes == 3 {
                heights.see((places[2], point[2]));
            }
            index += 1;
        }
        if announced.is_some_and(|announced| index.checked_mul(axes) != Some(announced)) {
            let problem = format!("the Geometry ends after {index} points");
            return Err(cursor.error(problem, "Its Dimensions announce others: correct them"));
        }
        cursor.check_vertex_count(index)?;
        sink.end_nodes(&self.cursor(item))?;
        let precision = item.precision.unwrap_or(Precision::Double);
        heights.send("z", Numbers::Text { precision }.into(), sink);
        Ok(index)
    }

    /// Hands on the elements and their data.
    fn elements(&self, item: &Item, sink: &mut dyn Sink) -> Result<(), ReadError> {
        let is_region =
            |item: &&Item| item.precision.is_none() && vtk::names_regions(item.name.as_bytes());
        let mut regions: Vec<(&Item, Vec<i64>)> = Vec::new();
        for own in self.attributes("cell").filter(is_region) {
            let known = regions.iter().any(|(other, _)| other.name == own.name);
            if regions.len() < MOST
                && !known
                && let Ok(numbers) = self.integers(own)
            {
                regions.push((own, numbers));
            }
        }
        sink.columns(regions.iter().map(|(own, _)| Column::tags(&own.name, 0)).collect());
        let cursor = &mut self.content(item);
        sink.expect_elements(cursor.capacity(item.elements.unwrap_or(0), "0 1 2 ".len()));
        let (mut tag, mut words) = (0, 0);
        let mut points = Vec::new();
        while cursor.next_word() {
            let (cell_type, corners) = match item.kind.as_str() {
                "mixed" => self.mixed(cursor, &mut words)?,
                kind => self.uniform(item, kind)?,
            };
            points.clear();
            let own = cursor.clone();
            for _ in 0..corners {
                if !cursor.next_word() {
                    let problem = format!("the Topology ends within cell {tag}");
                    return Err(cursor.error(problem, CORRECT));
                }
                points.push(cursor.integer("a node of a cell")?);
            }
            words += corners;
            let mut region = [0; MOST];
            for (number, (_, of_cells)) in region.iter_mut().zip(&regions) {
                *number = of_cells.get(tag as usize).copied().unwrap_or(0);
            }
            vtk::Cell { tag, cell_type, points: &points, region }.send(&own, sink)?;
            tag += 1;
        }
        let differs = |announced: Option<u64>, found: u64| announced.is_some_and(|n| n != found);
        if differs(item.elements, tag) || differs(item.announced(), words) {
            let problem = format!("the Topology ends after {tag} elements of {words} numbers");
            return Err(cursor.error(problem, "Its tags announce others: correct them"));
        }
        if sink.asks_for_data() {
            let of_regions: Vec<&Item> = regions.iter().map(|(own, _)| *own).collect();
            self.cell_data(&of_regions, tag, sink);
        }
        Ok(())
    }

    /// The type in VTK of the elements of a kind, and how many nodes each has.
    fn uniform(&self, item: &Item, kind: &str) -> Result<(u64, u64), ReadError> {
        let several = item.corners.or_else(|| item.dimensions.get(1).copied());
        Ok(match kind {
            "triangle" => (5, 3),
            "quadrilateral" => (9, 4),
            "polyvertex" => of_several(1, several.unwrap_or(1).max(1)),
            "polyline" => of_several(2, several.unwrap_or(2).max(1)),
            "polygon" => of_several(3, several.unwrap_or(3).max(1)),
            "tetrahedron" => (10, 4),
            "hexahedron" => (12, 8),
            "wedge" => (13, 6),
            "pyramid" => (14, 5),
            other => {
                let problem = format!("a Topology of the type {}", quoted(other.as_bytes()));
                let remedy = "Save a mesh of linear triangles (Triangle, or Mixed)";
                return Err(self.cursor(item).error(problem, remedy));
            }
        })
    }

    /// Reads the type of an element among others, and how many nodes it has.
    fn mixed(&self, cursor: &mut Cursor<'_>, words: &mut u64) -> Result<(u64, u64), ReadError> {
        *words += 1;
        let number = cursor.integer("the type of a cell")?;
        Ok(match number {
            1..=3 => {
                *words += 1;
                if !cursor.next_word() {
                    return Err(cursor.error("the number of a cell's nodes is missing", CORRECT));
                }
                of_several(number, cursor.integer("a number of nodes")?)
            }
            4 => (5, 3),
            5 => (9, 4),
            6 => (10, 4),
            7 => (14, 5),
            8 => (13, 6),
            9 => (12, 8),
            other => {
                let problem = format!("a cell of the type {other}, not of first order");
                let remedy = "Save a mesh of linear triangles (type 4)";
                return Err(cursor.error(problem, remedy));
            }
        })
    }

    /// Hands on the data of cells but for those that tell regions.
    fn cell_data(&self, regions: &[&Item], cells: u64, sink: &mut dyn Sink) {
        for item in self.attributes("cell") {
            let is_region = regions.iter().any(|own| own.at == item.at);
            let is_real = item.precision.is_some();
            let components = item.components(cells);
            if !is_region && sink.cell_array(item.name.as_bytes(), components, is_real) {
                match self.numbers(item) {
                    Ok(numbers) => {
                        let precision = item.precision.unwrap_or(Precision::Double);
                        let tags = (0..cells).collect();
                        sink.cell_numbers(numbers.finish(precision, None).numbers, Some(tags));
                    }
                    Err(_) => sink.leaves_out("cell data that are damaged"),
                }
            }
        }
        let is_other = |item: &&Item| !matches!(item.center.as_str(), "node" | "cell");
        if self.items.iter().filter(|i| i.section == "Attribute").any(|i| is_other(&i)) {
            sink.leaves_out("data of grids, faces or edges");
        }
    }

    fn numbers(&self, item: &Item) -> Result<TextNumbers, ReadError> {
        let cursor = &mut self.content(item);
        let mut numbers = TextNumbers::default();
        while cursor.next_word() {
            numbers.read(cursor)?;
        }
        Ok(numbers)
    }

    fn integers(&self, item: &Item) -> Result<Vec<i64>, ReadError> {
        let cursor = &mut self.content(item);
        let mut numbers = Vec::new();
        while cursor.next_word() {
            numbers.push(cursor.signed("a number of a cell")?);
        }
        Ok(numbers)
    }
}

/// The type in VTK of an element of any number of nodes: points, a line through them or a polygon. Returns that number too.
fn of_several(number: u64, nodes: u64) -> (u64, u64) {
    let cell_type = match (number, nodes) {
        (1, 1) => 1,
        (1, _) => 2,
        (2, 2) => 3,
        (2, _) => 4,
        _ => 7,
    };
    (cell_type, nodes)
}
