//! The metrics: what their rows in src/metric.rs promise, their derivatives, and their WGSL.

#[path = "../support/mod.rs"]
mod support;

mod derivatives;
mod device;
mod differences;
mod pairs;
mod properties;
mod shader;
mod triangles;
