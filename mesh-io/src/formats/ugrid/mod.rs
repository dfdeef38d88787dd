//! UGRID, the convention of coastal and atmospheric models, in netCDF's classic formats and in netCDF-4.
//!
//! The format: <https://ugrid-conventions.github.io/ugrid-conventions>, version 1.0. The mesh variable has no numbers;
//! its attributes name the variables of coordinates and connectivity. Faces are triangles, quadrilaterals and larger
//! polygons. Older nets of Delft3D FM have variables of fixed names instead of a mesh variable: `NetNode_x`, `NetNode_y` and
//! `NetLink`. A file of either kind may list edges and no faces.

mod cells;
mod centers;
mod data;
mod faces;
mod kind;
mod mesh;
mod planar;
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
use faces::Faces;
use mesh::Mesh;

pub(crate) struct Ugrid;

/// Returns whether a netCDF file has a UGRID mesh, or is an older net of Delft3D FM.
///
/// # Errors
/// If the header of the file is damaged.
pub(crate) fn is_in(source: &Source) -> Result<bool, ReadError> {
    let header = netcdf::open(source)?;
    Ok(header.variables.iter().any(mesh::is_mesh) || mesh::is_net(&header))
}

impl FormatReader for Ugrid {
    const VERTICES: &'static str = "the list of nodes";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let header = netcdf::open(source)?;
        let mesh = Mesh::find(&header)?;
        let faces = Faces::find(&mesh)?;
        let first = faces.table().first;
        let layout = mesh.axes()?.send(Format::Ugrid, mesh.nodes, first, visitor)?;
        let says_degrees = mesh.says_degrees();
        if says_degrees == Some(true) {
            visitor.remark(Remark::Degrees);
        }
        faces.send(visitor)?;
        mesh.data(&mesh.tables(faces), visitor);
        header.hdf5.as_ref().map_or(Ok(()), Hdf5::check_no_overlaps)?;
        Ok(CoordinateStorage { says_degrees, ..layout })
    }
}
