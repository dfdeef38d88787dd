//! For applications: a mesh that stays on their device, sweeps in their command encoders, results in their buffers.

mod exchange;
mod mesh;
mod objective;
mod sweeps;
mod vertex_buffer;

pub use exchange::BoundVertices;
pub use mesh::DeviceMesh;
pub use objective::{BoundObjective, ObjectiveValues};
pub use sweeps::Sweeps;
pub use vertex_buffer::VertexBuffer;
