//! The request for the format in which a mesh is written.

use mesh_io::{Encoding, Format};

use crate::args::FormArgs;

/// The format in which a run or a conversion writes a mesh.
#[derive(Clone, Copy)]
pub(crate) struct FormRequest {
    /// The format; `None` for the format of the name of the written file.
    pub(crate) to: Option<Format>,
    /// The encoding; `None` for the usual encoding of the format, and for the encoding of IN in a rewrite.
    pub(crate) encoding: Option<Encoding>,
    /// Whether the mesh may lose what the format cannot hold.
    pub(crate) is_lossy: bool,
}

impl From<&FormArgs> for FormRequest {
    fn from(args: &FormArgs) -> Self {
        Self { to: args.to, encoding: args.encoding.map(Into::into), is_lossy: args.lossy }
    }
}
