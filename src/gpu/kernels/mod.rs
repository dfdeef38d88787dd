//! The kernels: a table of them, what they bind, the structs they share with Rust, their WGSL, and their pipelines.

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
