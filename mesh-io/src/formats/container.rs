//! Files of HDF5 and netCDF, of which the content tells the format.

use crate::disk::source::Source;
use crate::error::ReadError;
use crate::formats::cgns;
use crate::formats::cgns::Cgns;
use crate::formats::exodus::Exodus;
use crate::formats::med;
use crate::formats::med::Med;
use crate::formats::ugrid;
use crate::formats::ugrid::Ugrid;
use crate::visit::reader::Walk;
use crate::visit::sink::Sink;
use crate::visit::storage::Layout;

pub(crate) struct Container;

impl Walk for Container {
    const VERTICES: &'static str = "the list of nodes";

    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        match med::is_in(source)? {
            true => Med::walk(source, sink),
            false if cgns::is_in(source)? => Cgns::walk(source, sink),
            false if ugrid::is_in(source)? => Ugrid::walk(source, sink),
            false => Exodus::walk(source, sink),
        }
    }
}
