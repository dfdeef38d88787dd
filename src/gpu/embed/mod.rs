//! For applications: a mesh that stays on their device, sweeps in their command encoders, results in their buffers.

mod clamped_move;
mod exchange;
mod mesh;
mod objective;
mod sweeps;
mod vertex_buffer;
mod window;

pub use clamped_move::BoundMove;
pub use exchange::BoundVertices;
pub use mesh::DeviceMesh;
pub use objective::{BoundObjective, ObjectiveValues};
pub use sweeps::Sweeps;
pub use vertex_buffer::VertexBuffer;
