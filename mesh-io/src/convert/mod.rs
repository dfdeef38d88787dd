//! Writes a mesh of one format in another. A reader's walk makes a description of the mesh ([`mod@content`]), a row of
//! [`targets`] says what the format holds of it, and a writer writes that.

mod conversion;
#[cfg(test)]
mod documented;
mod names;
#[cfg(test)]
mod tables;
mod targets;

pub use conversion::Conversion;
