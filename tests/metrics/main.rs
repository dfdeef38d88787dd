//! The metrics: the properties stated in their files, their derivatives, and their WGSL.

#[path = "../support/mod.rs"]
mod support;

mod derivatives;
mod device;
mod differences;
mod oracles;
mod pairs;
mod properties;
mod shader;
mod triangles;
mod untangling;
