//! The option `--surface`, which says what coordinates mean.

use clap::{Args, ValueEnum};

/// The option that says what coordinates mean.
#[derive(Args)]
pub(crate) struct SurfaceArgs {
    /// What coordinates are: lengths in the plane, or longitude and latitude in degrees on a sphere, which are
    /// continued across the line where longitudes start again
    #[arg(
        long,
        value_enum,
        default_value = "plane",
        value_name = "SURFACE",
        help_heading = "Target elements"
    )]
    pub(crate) surface: OnSurface,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OnSurface {
    Plane,
    Sphere,
}
