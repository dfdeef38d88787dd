//! UGRID, the convention of coastal and atmospheric models, in netCDF's classic formats and in netCDF-4.
//!
//! The format: <https://ugrid-conventions.github.io/ugrid-conventions>, version 1.0. The mesh variable has no numbers;
//! its attributes name the variables of coordinates and connectivity. Faces are triangles, quadrilaterals and larger
//! polygons.

mod centers;
mod data;
mod faces;
mod mesh;
mod table;
pub(crate) mod write;

use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::format::Format;
use crate::hdf5::Hdf5;
use crate::netcdf;
use crate::visit::reader::FormatReader;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;
use mesh::Mesh;
use table::{Table, TableKind};

pub(crate) struct Ugrid;

/// Returns whether a netCDF file has a UGRID mesh.
///
/// # Errors
/// If the header of the file is damaged.
pub(crate) fn is_in(source: &Source) -> Result<bool, ReadError> {
    let header = netcdf::open(source)?;
    Ok(header.variables.iter().any(mesh::is_mesh))
}

impl FormatReader for Ugrid {
    const VERTICES: &'static str = "the list of nodes";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let header = netcdf::open(source)?;
        let mesh = Mesh::find(&header)?;
        let faces = Table::find(&mesh, mesh.face_nodes, TableKind::Faces)?;
        let layout = mesh.axes()?.send(Format::Ugrid, mesh.nodes, faces.first, visitor)?;
        if mesh.is_in_degrees() {
            visitor.remark(Remark::Degrees);
        }
        faces::send(&faces, visitor)?;
        mesh.data(&mesh.tables(faces), visitor);
        header.hdf5.as_ref().map_or(Ok(()), Hdf5::check_no_overlaps)?;
        Ok(layout)
    }
}
