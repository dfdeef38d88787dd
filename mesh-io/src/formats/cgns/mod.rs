//! CGNS in HDF5, with a single unstructured zone.
//!
//! The format: <https://cgns.github.io/standard/SIDS/CGNS_SIDS.html>, and its mapping to HDF5:
//! <https://cgns.github.io/standard/filemap/hdf5.html>. A node is an HDF5 group with a label attribute and a dataset
//! called ` data`. Elements form sections, each with a range of the element numbers of the zone.

mod boundaries;
mod file;
mod periodic;
mod sections;
pub(crate) mod write;

use crate::disk::source::Source;
use crate::edit::numbers::{EncodedArrays, NumberEncoding, Offsets};
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::axes::{Axes, BinaryReals};
use crate::hdf5::{Dataset, DatasetArray, Datatype, Hdf5, Hdf5Arrays, Object, SIGNATURE};
use crate::text::cursor::Cursor;
use crate::visit::items::{CellKind, Element, PointNumbers};
use crate::visit::reader::FormatReader;
use crate::visit::storage::{ArrayLocation, ByteSpace, CoordinateStorage};
use crate::visit::visitor::MeshVisitor;
use boundaries::Boundaries;
use file::{File, labeled};
use std::sync::Arc;

pub(crate) struct Cgns;

/// Returns whether a file is CGNS in HDF5.
///
/// # Errors
/// If the file is damaged HDF5.
pub(crate) fn is_in(source: &Source) -> Result<bool, ReadError> {
    Ok(source.bytes.starts_with(SIGNATURE)
        && Hdf5::open(source)?.find(b"CGNSLibraryVersion").is_some())
}

impl FormatReader for Cgns {
    const VERTICES: &'static str = "the list of coordinates";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        Hdf5::read(source, |hdf5| File::open(source, hdf5)?.read(visitor))
    }
}

impl<'a> File<'a> {
    fn read(&self, visitor: &mut dyn MeshVisitor) -> Result<CoordinateStorage, ReadError> {
        let (axes, count) = self.axes()?;
        let layout = axes.send(Format::Cgns, count, 1, visitor)?;
        let boundaries = match visitor.asks_for_groups() {
            true => self.boundaries(count, visitor),
            false => Boundaries::default(),
        };
        self.sections(&boundaries, visitor)?;
        if visitor.asks_for_periodic_pairs() {
            visitor.periodic_pairs(self.periodic());
        }
        self.solutions(count, visitor)?;
        Ok(layout)
    }

    /// Locates the coordinates of the zone. Returns the coordinates and the number of vertices.
    ///
    /// # Errors
    /// If the arrays of x and y are missing, or differ in number type or length.
    fn axes(&self) -> Result<(Axes<'a>, usize), ReadError> {
        let grids = labeled(self.hdf5, self.zone, b"GridCoordinates_t");
        let mut read = Vec::new();
        for name in [b"CoordinateX", b"CoordinateY", b"CoordinateZ"] {
            // The first grid is that of the mesh; further grids are those of later times.
            let node = grids.first().and_then(|(_, grid)| self.hdf5.child(grid, name));
            let Some(node) = node else { break };
            read.extend(self.reals(node)?);
        }
        let first = read.first().map(|(dataset, array)| (dataset.datatype, array.bytes.len()));
        let is_same = |(dataset, array): &(Dataset, DatasetArray<'_>)| {
            Some((dataset.datatype, array.bytes.len())) == first
        };
        let (Some((Datatype::Real(precision, order), length)), 2..=3, true) =
            (first, read.len(), read.iter().all(is_same))
        else {
            let problem = "the zone has no CoordinateX and CoordinateY of one type and length";
            return Err(self.cursor(self.zone).error(problem, "Save a mesh of the plane"));
        };
        let count = length / precision.bytes();
        self.cursor(self.zone).check_vertex_count(count as u64)?;
        let (axes, form) = (read.len(), BinaryReals { order, precision });
        let arrays = read.into_iter().map(|(_, array)| array).collect();
        Ok((Axes::of_arrays(self.hdf5, form, arrays, axes, count), count))
    }

    /// Visits the data of vertices and of faces. Other data are only reported as unsupported.
    ///
    /// # Errors
    /// If a second reading of the sections fails.
    fn solutions(&self, vertices: usize, visitor: &mut dyn MeshVisitor) -> Result<(), ReadError> {
        for (_, solution) in labeled(self.hdf5, self.zone, b"FlowSolution_t") {
            let location =
                self.hdf5.child(solution, b"GridLocation").and_then(|own| self.text(own));
            match location.as_deref() {
                None | Some(b"Vertex") => {}
                Some(b"CellCenter") => {
                    self.face_data(solution, visitor)?;
                    continue;
                }
                Some(_) => {
                    if visitor.asks_for_data() {
                        visitor.unsupported("data of edges");
                    }
                    continue;
                }
            }
            for (name, node) in labeled(self.hdf5, solution, b"DataArray_t") {
                let dataset = self.data(node).and_then(|data| self.hdf5.dataset(data).ok()?);
                let Some(Datatype::Real(precision, order)) = dataset.map(|own| own.datatype) else {
                    if visitor.asks_for_data() {
                        visitor.unsupported("data of vertices that are no real numbers");
                    }
                    continue;
                };
                if !visitor.point_array(name, 1, true) {
                    continue;
                }
                let Ok(Some((_, array))) = self.reals(node) else { continue };
                let each = array.bytes.chunks_exact(precision.bytes()).take(vertices);
                let numbers = each.map(|number| order.real(precision, number)).collect();
                let (form, stride) = (NumberEncoding::Binary(order, precision), precision.bytes());
                let (start, home) = match array.start() {
                    Some(start) => (start, ByteSpace::File),
                    None => {
                        let encoding = Hdf5Arrays::new(self.hdf5, vec![array]);
                        (0, ByteSpace::Encoded(Arc::new(encoding) as Arc<dyn EncodedArrays>))
                    }
                };
                let stored = ArrayLocation {
                    offsets: Offsets::Regular { start, stride },
                    encoding: form,
                    space: home,
                    file_index: 0,
                    shared: None,
                };
                visitor.point_numbers(PointNumbers {
                    numbers,
                    nodes: None,
                    location: Some(stored),
                });
            }
        }
        Ok(())
    }

    /// Visits the data of a solution at the centers of cells, which are the faces of a mesh in the order of their
    /// numbers. Damaged data are ignored.
    ///
    /// # Errors
    /// If a second reading of the sections fails.
    fn face_data(
        &self,
        solution: &'a Object,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<(), ReadError> {
        if !visitor.asks_for_cell_arrays() {
            return Ok(());
        }
        let mut faces = FaceIds(Vec::new());
        for (name, node) in labeled(self.hdf5, solution, b"DataArray_t") {
            let reals = self.reals(node).ok().flatten();
            if !visitor.cell_array(name, 1, reals.is_some()) {
                continue;
            }
            let numbers: Vec<f64> = match &reals {
                Some((Dataset { datatype: Datatype::Real(precision, order), .. }, array)) => {
                    let each = array.bytes.chunks_exact(precision.bytes());
                    each.map(|number| order.real(*precision, number)).collect()
                }
                _ => self.integers(node).unwrap_or_default().iter().map(|&n| n as f64).collect(),
            };
            if faces.0.is_empty() {
                self.sections(&Boundaries::default(), &mut faces)?;
            }
            if numbers.len() == faces.0.len() {
                visitor.cell_numbers(numbers, Some(faces.0.clone()));
            }
        }
        Ok(())
    }
}

/// Visitor that collects the ids of faces.
struct FaceIds(Vec<u64>);

impl MeshVisitor for FaceIds {
    fn node(&mut self, _: &Cursor<'_>, _: u64, _: u64, _: usize, _: [f64; 2]) {}

    fn visit_element(&mut self, _: &Cursor<'_>, element: &Element) -> Result<(), ReadError> {
        if matches!(element.kind, CellKind::Triangle | CellKind::Quadrilateral) {
            self.0.push(element.id);
        }
        Ok(())
    }
}
