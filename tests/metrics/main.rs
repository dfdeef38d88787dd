//! Tests of the metrics: documented properties, derivatives, and WGSL.

mod derivatives;
mod device;
mod differences;
mod oracles;
mod pairs;
mod properties;
mod quadrilaterals;
mod shader;
mod triangles;
mod untangling;
