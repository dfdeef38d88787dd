//! Changed numbers of a file: their encodings and offsets, and the rewritten bytes of the file.

pub(crate) mod column;
pub(crate) mod numbers;
pub(crate) mod rewrite;
