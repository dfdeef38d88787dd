//! netCDF: dimensions and variables by name, in the classic formats and in netCDF-4, which is HDF5.

mod attribute;
mod classic;
mod header;
mod types;
mod version4;
pub(crate) mod write;

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::hdf5::SIGNATURE;

pub(crate) use header::{Header, Items, Variable};
pub(crate) use types::NumberType;

/// Reads the dimensions and variables of a netCDF file.
///
/// # Errors
/// If the file is damaged, of an unknown version, or if variables overlap or end beyond the file.
pub(crate) fn open(source: &Source) -> Result<Header<'_>, ReadError> {
    match source.bytes.starts_with(SIGNATURE) {
        true => version4::read(source),
        false => classic::read(source),
    }
}
