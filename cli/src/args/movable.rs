//! The options that choose what may move.

use std::path::PathBuf;

use clap::Args;

use crate::args::parse;

const HEADING: &str = "What may move";

/// The options that choose what may move.
#[derive(Args)]
pub(crate) struct MoveArgs {
    /// Let vertices between regions move: gmsh's physical groups and entities, attributes of an .ele, references,
    /// materials. Without it they stay where they are
    #[arg(long, help_heading = HEADING)]
    pub(crate) free_interfaces: bool,
    /// Keep the vertices of all elements of these groups where they are; `gpu-smooth groups` lists what a mesh has. All
    /// options that fix vertices may be given several times
    #[arg(long, value_name = "NAME|TAG,...", help_heading = HEADING, value_parser = parse::group_names, allow_hyphen_values = true)]
    pub(crate) fix: Vec<String>,
    /// Keep the vertices that FILE lists where they are, by the mesh file's own numbers; # starts a comment
    #[arg(long, value_name = "FILE", help_heading = HEADING)]
    pub(crate) fix_vertices: Vec<PathBuf>,
    /// Keep vertices where they are if this array of point data (VTK, PLY) is not zero there
    #[arg(long, value_name = "NAME", help_heading = HEADING)]
    pub(crate) fix_array: Vec<String>,
    /// Keep vertices in this box where they are
    #[arg(long, value_name = "X0,Y0,X1,Y1", help_heading = HEADING, value_parser = parse::corners, allow_hyphen_values = true)]
    pub(crate) fix_box: Vec<[[f64; 2]; 2]>,
    /// Let only those vertices move whose triangles all belong to these groups
    #[arg(long, value_name = "NAME|TAG,...", help_heading = HEADING, value_parser = parse::group_names, allow_hyphen_values = true)]
    pub(crate) only: Vec<String>,
    /// Let only those vertices move that are near a triangle with an inverse mean ratio above Q
    #[arg(long, value_name = "Q", help_heading = HEADING, value_parser = parse::ratio, allow_negative_numbers = true)]
    pub(crate) only_bad: Option<f64>,
    /// How many rings of triangles around those of --only-bad are near
    #[arg(long, value_name = "N", default_value_t = 2, requires = "only_bad", help_heading = HEADING, allow_negative_numbers = true)]
    pub(crate) rings: u32,
}
