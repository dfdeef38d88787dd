//! Files of HDF5 and netCDF, of which the content tells the format.

use crate::cgns::{self, Cgns};
use crate::error::ReadError;
use crate::exodus::Exodus;
use crate::med::{self, Med};
use crate::sink::{Layout, Sink, Walk};
use crate::source::Source;
use crate::ugrid::{self, Ugrid};

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
