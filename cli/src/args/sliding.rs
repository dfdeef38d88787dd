//! The options that let vertices slide along the boundary.

use clap::Args;

use crate::args::parse;

const HEADING: &str = "What may move";

/// Options of vertices that slide.
#[derive(Args)]
pub(crate) struct SlideArgs {
    /// Let vertices of the boundary, between regions and on lines slide along them, from corner to corner. Straight
    /// lines stay straight; on other lines, vertices follow a cubic through the vertices of IN
    #[arg(long, help_heading = HEADING)]
    pub(crate) slide: bool,
    /// A vertex where a line turns by more than this angle is a corner, and stays where it is
    #[arg(long, value_name = "DEGREES", default_value_t = 40.0, requires = "slide", help_heading = HEADING, value_parser = parse::angle, allow_negative_numbers = true)]
    pub(crate) corner_angle: f64,
    /// Largest distance of lines from those of IN, in the unit of the mesh [default: a tenth of the local edge length]
    #[arg(long, value_name = "DISTANCE", requires = "slide", help_heading = HEADING, value_parser = parse::distance, allow_negative_numbers = true)]
    pub(crate) hausdorff: Option<f64>,
    /// Two sides of the boundary that a translation or a rotation maps onto each other: their vertices slide together.
    /// For files that do not list periodic pairs themselves, as gmsh's do; may be given several times
    #[arg(long, value_name = "NAME,NAME", requires = "slide", help_heading = HEADING, value_parser = parse::two_names)]
    pub(crate) periodic: Vec<[String; 2]>,
}
