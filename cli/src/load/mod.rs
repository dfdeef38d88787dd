//! Meshes as the command line works on them: what a file holds, and which vertices may move.

mod mesh;

pub(crate) use mesh::LoadedMesh;
