//! HDF5: what a file holds by its paths, where the numbers of a dataset stand, and what it becomes with other numbers.
//!
//! The format: <https://docs.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html>, versions 0 to 3 of the superblock. Groups of the
//! old style and of the new; datasets in the header, in one piece or in chunks; of filters deflate, shuffle and Fletcher's checksum.

mod attribute;
mod btree;
mod bytes;
mod checksum;
mod chunks;
mod dataset;
mod encoding;
mod entry;
mod file;
mod file_bytes;
mod filters;
mod fixed_array;
mod groups;
mod header;
mod heap;
mod layout;
mod strings;
#[cfg(test)]
mod tests;
mod types;

pub(crate) use dataset::{Dataset, DatasetArray};
pub(crate) use encoding::Hdf5Arrays;
pub(crate) use file::{Hdf5, Object};
pub(crate) use file_bytes::SIGNATURE;
pub(crate) use types::Datatype;
