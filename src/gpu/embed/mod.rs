//! For applications: a mesh that stays on their device, sweeps in their command encoders, results in their buffers.

mod budget;
mod clamped_move;
mod corrections;
mod debug;
mod doubt;
mod exchange;
mod last_valid;
mod mesh;
mod objective;
mod pins;
mod readback;
mod sweeps;
mod untangling_sweeps;
mod vertex_buffer;
mod window;

pub use budget::Budget;
pub use clamped_move::BoundMove;
pub use doubt::Doubt;
pub use exchange::BoundVertices;
pub use last_valid::LastValid;
pub use mesh::DeviceMesh;
pub use objective::{BoundObjective, ObjectiveValues};
pub use pins::BoundMask;
pub use readback::Readback;
pub use sweeps::Sweeps;
pub use untangling_sweeps::UntanglingSweeps;
pub use vertex_buffer::VertexBuffer;
