//! The kernels: a table of them, their WGSL, the uniforms they read, and their pipelines.

mod codes;
pub(crate) mod dispatch;
pub(crate) mod pipelines;
pub(crate) mod source;
pub(crate) mod table;
pub(crate) mod uniforms;

pub use table::{Interface, Kernel};
