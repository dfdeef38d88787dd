//! The commands of the command line, one module each.

pub(crate) mod adapters;
mod bash_words;
pub(crate) mod batch;
pub(crate) mod bench;
pub(crate) mod compare;
pub(crate) mod convert;
pub(crate) mod groups;
pub(crate) mod metrics;
pub(crate) mod quality;
pub(crate) mod shell;
pub(crate) mod smooth;
pub(crate) mod trial;
