//! A mesh with the bytes of its files: reading, rewriting, comparison, groups and data.

#[cfg(test)]
mod ahead_tests;
pub(crate) mod centers;
pub(crate) mod compare;
mod content;
pub(crate) mod fields;
pub(crate) mod mesh;
pub(crate) mod named;
pub(crate) mod parameters;
pub(crate) mod parametric;
pub(crate) mod place;
pub(crate) mod read;
pub(crate) mod save;
