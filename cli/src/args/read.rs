//! The options of every command that reads meshes.

use clap::Args;

/// The options of reading, which all commands share.
#[derive(Args, Clone)]
pub(crate) struct ReadArgs {
    /// Join corners of triangles at the same place to one vertex, as an STL lists the corners of each triangle by
    /// themselves, and VTK XML (.vtu, .vtp) may do. No effect on other formats
    #[arg(long)]
    pub(crate) weld: bool,
    /// Let a mesh name files outside of its directory: an XDMF its files of numbers, which a run in place replaces, and an Abaqus
    /// input file what it includes
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Cell data that number the regions of the mesh, whose common vertices stay fixed [default: the entries of the format, else
    /// the first cell data of whole numbers that form few connected regions]
    #[arg(long, value_name = "NAME")]
    pub(crate) regions: Option<String>,
}
