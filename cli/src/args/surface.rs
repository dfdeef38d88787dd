//! The option `--surface`, which sets the meaning of coordinates.

use clap::{Args, ValueEnum};

/// The option that sets the meaning of coordinates.
#[derive(Args)]
pub(crate) struct SurfaceArgs {
    /// Meaning of coordinates: lengths in the plane, or longitude and latitude in degrees on a sphere,
    /// continued across the meridian at which longitudes wrap
    #[arg(
        long,
        value_enum,
        default_value = "plane",
        value_name = "SURFACE",
        help_heading = "Target elements"
    )]
    pub(crate) surface: SurfaceArg,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SurfaceArg {
    Plane,
    Sphere,
}
