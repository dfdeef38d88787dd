//! Options that select the vertices which may move.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::args::parse;
use crate::kept_layers::KeptLayers;

const HEADING: &str = "What may move";

/// The choice whether vertices of quadrilaterals move.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Quadrilaterals {
    Keep,
    Move,
}

/// Options that select the vertices which may move.
#[derive(Args)]
pub(crate) struct MoveArgs {
    /// Let vertices between regions move. Regions are gmsh's physical groups and entities, attributes of an .ele,
    /// references, and materials. Without this option, vertices between regions are fixed
    #[arg(long, help_heading = HEADING)]
    pub(crate) free_interfaces: bool,
    /// Fix the vertices of all elements of these groups; `gpu-smooth groups` lists the groups of a mesh. Each option
    /// that fixes vertices may be given several times
    #[arg(long, value_name = "NAME|TAG,...", help_heading = HEADING, value_parser = parse::group_names, allow_hyphen_values = true)]
    pub(crate) fix: Vec<String>,
    /// Fix the vertices listed in FILE, by the mesh file's own numbers; # starts a comment
    #[arg(long, value_name = "FILE", help_heading = HEADING)]
    pub(crate) fix_vertices: Vec<PathBuf>,
    /// Fix the vertices at which this array of point data (VTK, PLY) is not zero
    #[arg(long, value_name = "NAME", help_heading = HEADING)]
    pub(crate) fix_array: Vec<String>,
    /// Fix the vertices in this box
    #[arg(long, value_name = "X0,Y0,X1,Y1", help_heading = HEADING, value_parser = parse::corners, allow_hyphen_values = true)]
    pub(crate) fix_box: Vec<[[f64; 2]; 2]>,
    /// Let the vertices of quadrilaterals move as those of triangles do (move), or keep all of them where they are (keep). No
    /// quadrilateral loses its convexity, and each becomes as square as it can be
    #[arg(long, value_name = "move|keep", help_heading = HEADING, default_value = "move", hide_possible_values = true)]
    pub(crate) quadrilaterals: Quadrilaterals,
    /// Boundary layers that stay: those found above walls (auto), none, the first N rows (rows=N), or all vertices within a
    /// distance of walls (within=DISTANCE), in the unit of the mesh. Names or tags of groups behind a comma limit the walls
    /// to these groups; without groups, rows=N and within=DISTANCE take each wall, from corner to corner, with flat
    /// elements at a quarter of its vertices or more, and of other walls the vertices with flat elements
    /// [default: auto; none for compare without --slide]
    #[arg(long, value_name = "auto|none|rows=N|within=DISTANCE[,GROUP...]", help_heading = HEADING, value_parser = parse::kept_layers)]
    pub(crate) keep_layers: Option<KeptLayers>,
    /// Let only vertices move whose elements all belong to these groups
    #[arg(long, value_name = "NAME|TAG,...", help_heading = HEADING, value_parser = parse::group_names, allow_hyphen_values = true)]
    pub(crate) only: Vec<String>,
}
