//! VTK files: the legacy format, the XML formats, and the writers for both.

pub(crate) mod bits_and_texts;
pub(crate) mod cells;
pub(crate) mod legacy;
pub(crate) mod regions;
pub(crate) mod types;
pub(crate) mod write;
pub(crate) mod xml;
