//! Tests of the metrics: documented properties, derivatives, and WGSL.

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
