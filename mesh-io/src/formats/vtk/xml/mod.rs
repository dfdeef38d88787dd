//! VTK's XML formats of unstructured grids and polygonal data, `.vtu` and `.vtp`. Arrays are text, base64 or appended
//! data, uncompressed or compressed by zlib or LZ4, in one piece or several.
//!
//! The format: <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>. A rewrite encodes only arrays
//! with changed numbers again, and corrects the offsets of later appended arrays.

mod arrays;
mod blocks;
mod cells;
mod document;
mod encoding;
mod ghosts;
mod points;
pub(crate) mod write;

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::format::Format;
use crate::visit::reader::FormatReader;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use crate::visit::weld::{NodePositions, Welder};
use arrays::File;
use document::{Content, Document};

pub(crate) struct Vtu;

impl FormatReader for Vtu {
    const VERTICES: &'static str = "Points";
    const NAMES_OTHER_LINES: bool = false;

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let document = Document::read(source)?;
        let file = File::new(source, document);
        if !source.options.welds {
            return file.visit(visitor);
        }
        let mut positions = NodePositions::default();
        points::read(&file, &mut positions)?;
        match Welder::new(visitor, positions) {
            Ok(mut welder) => {
                let storage = file.visit(&mut welder)?;
                Ok(CoordinateStorage { repeated_vertices: Some(welder.finish()), ..storage })
            }
            Err(visitor) => file.visit(visitor),
        }
    }
}

impl File<'_> {
    /// Visits all items of the mesh. Returns the encoding and location of the coordinates.
    fn visit(&self, visitor: &mut dyn MeshVisitor) -> Result<CoordinateStorage, ReadError> {
        let points::PointStorage { numbers, encoded, shared_with } = points::read(self, visitor)?;
        self.cells(visitor)?;
        if visitor.asks_for_ghosts() {
            self.ghosts(visitor)?;
        }
        self.point_arrays(visitor);
        let format = match self.document.content {
            Content::Grid => Format::Vtu,
            Content::Polygons => Format::Vtp,
        };
        let storage = CoordinateStorage::in_place(format, numbers);
        Ok(CoordinateStorage { encoded, shared_with, ..storage })
    }
}
