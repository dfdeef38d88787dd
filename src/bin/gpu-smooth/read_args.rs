//! The options of every command that reads meshes.

use clap::Args;

/// How meshes are read, whatever the command.
#[derive(Args, Clone, Copy)]
pub(crate) struct ReadArgs {
    /// Join corners of triangles at the same place, without which an STL has no vertices. Of no effect on other formats
    #[arg(long)]
    pub(crate) weld: bool,
}
