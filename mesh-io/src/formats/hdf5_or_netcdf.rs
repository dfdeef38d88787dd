//! HDF5 and netCDF files, whose format depends on their objects and variables.

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::formats::cgns;
use crate::formats::cgns::Cgns;
use crate::formats::exodus::Exodus;
use crate::formats::med;
use crate::formats::med::Med;
use crate::formats::ugrid;
use crate::formats::ugrid::Ugrid;
use crate::visit::reader::FormatReader;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;

/// Reader of HDF5 and netCDF files: chooses among MED, CGNS, UGRID and Exodus by the content.
pub(crate) struct Hdf5OrNetcdf;

impl FormatReader for Hdf5OrNetcdf {
    const VERTICES: &'static str = "the list of nodes";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        match med::is_in(source)? {
            true => Med::visit(source, visitor),
            false if cgns::is_in(source)? => Cgns::visit(source, visitor),
            false if ugrid::is_in(source)? => Ugrid::visit(source, visitor),
            false => Exodus::visit(source, visitor),
        }
    }
}
