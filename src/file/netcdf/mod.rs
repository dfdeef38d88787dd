//! netCDF: dimensions and variables by name, in the classic formats and in netCDF-4, which is HDF5.

mod attribute;
mod axes;
mod classic;
mod header;
mod points;
mod version4;

use crate::error::ReadError;
use crate::file::hdf5::SIGNATURE;
use crate::file::source::Source;

pub(in crate::file) use axes::axes;
pub(in crate::file) use header::{Header, Items, Number, Variable};
pub(in crate::file) use points::{Parts, PointData};

/// Reads the header of a file.
///
/// # Errors
/// If it is damaged, of an unknown version, or tells of variables that overlap or end beyond the file.
pub(in crate::file) fn open(source: &Source) -> Result<Header<'_>, ReadError> {
    match source.bytes.starts_with(SIGNATURE) {
        true => version4::read(source),
        false => classic::read(source),
    }
}
