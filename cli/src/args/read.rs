//! The options of every command that reads meshes.

use clap::Args;

/// The options of reading, which all commands share.
#[derive(Args, Clone, Copy)]
pub(crate) struct ReadArgs {
    /// Join corners of triangles at the same place to one vertex, as an STL lists the corners of each triangle by
    /// themselves. No effect on other formats
    #[arg(long)]
    pub(crate) weld: bool,
    /// Let a mesh name files outside of its directory: an XDMF its files of numbers, which a run in place replaces, and an Abaqus
    /// input file what it includes
    #[arg(long)]
    pub(crate) allow_outside: bool,
}
