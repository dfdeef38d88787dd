//! The option that names sides of the boundary.

use clap::Args;

use crate::args::parse;

/// The option that names sides of the boundary whose vertices slide together.
#[derive(Args)]
pub(crate) struct SideArgs {
    /// Two sides of the boundary that a translation or a rotation maps onto each other: their vertices slide together.
    /// For files that do not list periodic pairs themselves, as gmsh's do; may be given several times
    #[arg(long, value_name = "NAME,NAME", requires = "slide", help_heading = "What may move", value_parser = parse::two_names)]
    pub(crate) periodic: Vec<[String; 2]>,
}
