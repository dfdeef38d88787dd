//! The request on how meshes are read.

use crate::args::ReadArgs;

/// How meshes are read.
#[derive(Clone, Copy)]
pub(crate) struct ReadRequest {
    /// Whether corners of triangles at one place are joined to one vertex. Only an STL needs it.
    pub(crate) weld: bool,
}

impl From<ReadArgs> for ReadRequest {
    fn from(args: ReadArgs) -> Self {
        Self { weld: args.weld }
    }
}
