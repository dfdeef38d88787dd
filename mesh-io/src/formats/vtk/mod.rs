//! VTK files: the legacy format, the XML formats, and the writers of both.

pub(crate) mod legacy;
pub(crate) mod write;
pub(crate) mod xml;
