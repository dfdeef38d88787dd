//! The option that improves the worst triangles.

use clap::{Args, ValueEnum};

/// The option that improves the worst triangles.
#[derive(Args)]
pub(crate) struct WorstArgs {
    /// Improve the worst triangles after the last sweep, at a small cost in f: move the vertices around the worst
    /// thousandth of the triangles until the largest imr is as small as it can be made, or the least angle or altitude
    /// as large. Least angles grow at the cost of angles above 90 degrees, so min-angle is not for solvers that need
    /// orthogonal meshes [default without =MEASURE: imr]
    #[arg(
        long,
        value_enum,
        value_name = "MEASURE",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "imr",
        help_heading = "Method"
    )]
    pub(crate) improve_worst: Option<WorstChoice>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum WorstChoice {
    Imr,
    MinAngle,
    Altitude,
}
