//! The kernels: their table, bind layouts, structs shared with Rust, WGSL sources and pipelines.

mod codes;
pub(crate) mod dispatch;
pub(crate) mod form;
pub(crate) mod layouts;
pub(crate) mod pipelines;
pub(crate) mod row;
pub(crate) mod source;
pub(crate) mod table;
pub(crate) mod uniforms;

pub use layouts::BindLayout;
pub use table::Kernel;
