//! Cells and data of a VTK XML file, piece by piece.

use super::arrays::{File, precision_of};
use super::document::{Array, Content};
use crate::binary::int_array::IntArray;
use crate::error::ReadError;
use crate::formats::vtk::bits_and_texts::lost_text;
use crate::formats::vtk::cells::{BulkBackoff, Cell, Triangles};
use crate::formats::vtk::regions::{MAX_ARRAYS, RegionNumbers, names_regions, unread_regions};
use crate::formats::vtk::types;
use crate::text::cursor::{CORRECT, Cursor};
use crate::visit::items::RegionAttribute;
use crate::visit::visitor::MeshVisitor;

/// Type numbers of the cells of a list.
enum Types<'a> {
    /// One type for all cells: a section of polygonal data.
    Same(u64),
    PerCell(IntArray<'a>),
}

/// A cell list of a piece, such as `Cells` or `Polys`.
struct List<'a> {
    connectivity: IntArray<'a>,
    /// End of each cell's point indices in `connectivity`.
    offsets: IntArray<'a>,
    types: Types<'a>,
    /// Offset of the connectivity array's tag in the file, for messages.
    at: usize,
}

impl File<'_> {
    /// Visits the cells of all pieces, and their cell data if the visitor asks for data.
    pub(super) fn cells(&self, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
        let regions = self.region_names(visitor);
        visitor
            .region_attributes(regions.iter().map(|name| RegionAttribute::tags(name, 0)).collect());
        let (mut first_point, mut first_cell) = (0, 0);
        for (piece, announced) in self.document.pieces.iter().enumerate() {
            let lists = self.lists(piece)?;
            let count: usize = lists.iter().map(|list| list.offsets.len()).sum();
            if visitor.asks_for_cell_arrays() {
                let cells = first_cell..first_cell + count as u64;
                self.cell_arrays(piece, &regions, cells, visitor);
            }
            visitor.expect_elements(count);
            let of_cells: RegionNumbers =
                regions.iter().map(|name| self.regions(piece, name, visitor)).collect();
            let mut index = 0;
            let mut points: Vec<u64> = Vec::new();
            for List { connectivity, offsets, types, at } in &lists {
                let cursor = &Cursor::on_line_of(self.source, *at);
                let (mut start, mut own) = (0, 0);
                let mut tries = BulkBackoff::NEW;
                while own < offsets.len() {
                    let end = offsets.at(own) as usize;
                    let of_triangles = match types {
                        Types::Same(types::POLYGON) => Some(None),
                        Types::Same(_) => None,
                        Types::PerCell(types) => Some(Some(types.field(own, 1))),
                    };
                    if end - start == 3
                        && tries.is_due(own)
                        && let Some(types) = of_triangles
                    {
                        let triangles = Triangles {
                            count: offsets.len() - own,
                            numbers: connectivity,
                            own: start..end,
                            ends: Some(offsets.field(own, 1)),
                            types,
                            first: first_point,
                            below: announced.points,
                            regions: of_cells.from(index),
                        };
                        let (taken, last) = triangles.send(visitor);
                        tries.done(own, taken);
                        if taken > 0 {
                            (own, index, start) = (own + taken, index + taken, last);
                            continue;
                        }
                    }
                    let cell_type = match types {
                        &Types::Same(cell_type) => cell_type,
                        Types::PerCell(types) => types.at(own),
                    };
                    points.clear();
                    for point in connectivity.range(start..end) {
                        if point >= announced.points {
                            let cell = first_cell + index as u64;
                            let problem =
                                format!("cell {cell} has node {point}, which Points does not list");
                            return Err(cursor.error(problem, CORRECT));
                        }
                        points.push(first_point + point);
                    }
                    (start, own) = (end, own + 1);
                    let region = of_cells.of(index);
                    let id = first_cell + index as u64;
                    Cell { id, cell_type, points: &points, region }.send(cursor, visitor)?;
                    index += 1;
                }
            }
            first_point += announced.points;
            first_cell += count as u64;
        }
        Ok(())
    }

    /// Reads the cell lists of a piece. Leaves out lists without cells, except that of a grid piece with points.
    ///
    /// # Errors
    /// If an array is missing or damaged, or if offsets, types and connectivity of a list contradict each other.
    fn lists(&self, piece: usize) -> Result<Vec<List<'_>>, ReadError> {
        let announced = &self.document.pieces[piece];
        let sections: &[(&str, Option<u64>)] = match self.document.content {
            Content::Grid => &[("Cells", None)],
            // Sections of polygonal data, with the type of their cells.
            Content::Polygons => &[
                ("Verts", Some(types::POLY_VERTEX)),
                ("Lines", Some(types::POLY_LINE)),
                ("Strips", Some(types::TRIANGLE_STRIP)),
                ("Polys", Some(types::POLYGON)),
            ],
        };
        let mut lists = Vec::new();
        for (&(section, cell_type), &cells) in sections.iter().zip(&announced.cells) {
            if cells == 0 && (cell_type.is_some() || announced.points == 0) {
                continue;
            }
            let list = self.array(piece, section, Some("connectivity"))?;
            let connectivity = self.integers(list)?;
            let offsets = self.integers(self.array(piece, section, Some("offsets"))?)?;
            let types = match cell_type {
                Some(cell_type) => Types::Same(cell_type),
                None => {
                    Types::PerCell(self.integers(self.array(piece, section, Some("types"))?)?)
                }
            };
            let cursor = &Cursor::on_line_of(self.source, list.at);
            let types_count = match &types {
                Types::Same(_) => offsets.len(),
                Types::PerCell(types) => types.len(),
            };
            let counts = [offsets.len(), types_count].map(|count| count as u64);
            if counts != [cells; 2] {
                let [offsets, types] = counts;
                let problem = format!("{offsets} offsets and {types} types for {cells} cells");
                return Err(cursor.error(problem, CORRECT));
            }
            let most = connectivity.len() as u64;
            let last = offsets.len().checked_sub(1).map(|last| offsets.at(last));
            if !offsets.is_sorted() || last.is_some_and(|last| last > most) {
                return Err(cursor.error("the offsets do not fit the connectivity", CORRECT));
            }
            lists.push(List { connectivity, offsets, types, at: list.at });
        }
        Ok(lists)
    }

    /// Returns the names of the first [`MAX_ARRAYS`] region arrays of whole numbers. A damaged array yields a remark, as
    /// the mesh itself does not depend on regions.
    fn region_names(&self, visitor: &mut dyn MeshVisitor) -> Vec<String> {
        let (mut names, mut damaged): (Vec<String>, Vec<&str>) = Default::default();
        for array in self.document.arrays.iter().filter(|array| is_region_array(array)) {
            let is_known = names.contains(&array.name) || damaged.contains(&&*array.name);
            if names.len() == MAX_ARRAYS || is_known || precision_of(array).is_some() {
                continue;
            }
            match self.signed_integers(array) {
                Ok(_) => names.push(array.name.clone()),
                Err(_) => {
                    damaged.push(&array.name);
                    visitor.remark(unread_regions(array.name.as_bytes()));
                }
            }
        }
        names
    }

    /// Reads the region numbers of a piece's cells from the array called `name`. A missing or damaged array yields an
    /// empty list, a damaged one also a remark.
    fn regions(&self, piece: usize, name: &str, visitor: &mut dyn MeshVisitor) -> Vec<i64> {
        let mut arrays = self.document.arrays_of(piece).iter();
        let array = arrays.find(|array| is_region_array(array) && array.name == name);
        let numbers = array.map(|array| self.signed_integers(array)).transpose();
        numbers
            .unwrap_or_else(|_| {
                visitor.remark(unread_regions(name.as_bytes()));
                None
            })
            .unwrap_or_default()
    }

    /// Visits the arrays of point data that the visitor wants. Damaged arrays are skipped, as the mesh does not depend
    /// on data.
    pub(super) fn point_arrays(&self, visitor: &mut dyn MeshVisitor) {
        let pieces = &self.document.pieces;
        let mut first = 0;
        for (piece, announced) in pieces.iter().enumerate() {
            let points = first..first + announced.points;
            first = points.end;
            for array in self.document.arrays_of(piece) {
                let of_points = array.section == "PointData" && announced.points > 0;
                let is_real = precision_of(array).is_some();
                if of_points && array.is_text() {
                    visitor.unsupported(&lost_text("vertices", array.name.as_bytes()));
                } else if of_points
                    && visitor.point_array(array.name.as_bytes(), array.components, is_real)
                    && let Ok(mut numbers) = self.numbers(array)
                {
                    let fits = Some(numbers.numbers.len() as u64)
                        == announced.points.checked_mul(array.components);
                    if pieces.len() > 1 {
                        if !fits {
                            continue;
                        }
                        numbers.nodes = Some(points.clone().collect());
                    }
                    visitor.point_numbers(numbers);
                }
            }
        }
    }

    /// Visits the arrays of cell data that the visitor wants, except those of the given `regions`.
    fn cell_arrays(
        &self,
        piece: usize,
        regions: &[String],
        cells: std::ops::Range<u64>,
        visitor: &mut dyn MeshVisitor,
    ) {
        for array in self.document.arrays_of(piece) {
            let is_region = is_region_array(array) && regions.contains(&array.name);
            let is_real = precision_of(array).is_some();
            match array.section.as_str() {
                "FieldData" => visitor.unsupported("field data"),
                "CellData" if array.is_text() => {
                    visitor.unsupported(&lost_text("elements", array.name.as_bytes()));
                }
                "CellData"
                    if !is_region
                        && visitor.cell_array(array.name.as_bytes(), array.components, is_real) =>
                {
                    if let Ok(numbers) = self.numbers(array) {
                        visitor.cell_numbers(numbers.numbers, Some(cells.clone().collect()));
                    }
                }
                _ => {}
            }
        }
    }
}

fn is_region_array(array: &Array) -> bool {
    let named = names_regions(array.name.as_bytes());
    array.section == "CellData" && array.components == 1 && named && !array.is_text()
}
