//! Writes a mesh of one format in another. A reader and a visitor make the [`content`](mod@crate::export::content) of a mesh, a row of
//! [`targets`] says which parts the format holds, and a writer writes these parts.

mod conversion;
#[cfg(test)]
mod doc_tests;
mod names;
#[cfg(test)]
mod tables;
mod targets;

pub use conversion::Conversion;
