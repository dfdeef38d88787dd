//! HDF5: the objects of a file by path, the chunks of a dataset with their byte ranges, and the edits that store new
//! numbers in a dataset. `write` makes new files.
//!
//! The format: <https://docs.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html>. Supported are superblocks of
//! versions 0 to 3; groups as symbol tables and as link messages; compact, contiguous and chunked datasets; the filters
//! deflate, shuffle and Fletcher32.

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
pub(crate) mod write;

pub(crate) use dataset::{Dataset, DatasetArray};
pub(crate) use encoding::Hdf5Arrays;
pub(crate) use file::{Hdf5, Object};
pub(crate) use file_bytes::{REMOVE_USER_BLOCK, SIGNATURE, user_block};
pub(crate) use types::Datatype;
