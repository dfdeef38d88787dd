//! Conversion of meshes between formats. A reader and a visitor make the [`content`](mod@crate::export::content) of a
//! mesh, a row of [`targets`] defines the capabilities of the target format, and a writer writes the supported content.

mod conversion;
#[cfg(test)]
mod doc_tests;
mod names;
#[cfg(test)]
mod tables;
mod targets;

pub use conversion::{Conversion, Encoding};
