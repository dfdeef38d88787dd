//! The option `--interpolate`, which names data of vertices.

use clap::Args;

use crate::args::parse;

/// The option that names the data to interpolate.
#[derive(Args)]
pub(crate) struct FieldArgs {
    /// Data of vertices to interpolate at the new positions, linearly in the triangles of IN: depth, z, variables,
    /// point data, or all real numbers (all). Data that are not named stay unchanged
    #[arg(long, value_name = "NAME,...|all", help_heading = "What may move", value_parser = parse::field_name)]
    pub(crate) interpolate: Vec<String>,
}
