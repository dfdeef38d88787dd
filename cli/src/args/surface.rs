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
    /// Meaning of third coordinates that differ: a coordinate of a mesh that lies in any plane and is smoothed in it, or
    /// data of a mesh in x and y, such as depths. A mesh on a curved surface is refused unless z is data. Files of SMS
    /// 2dm, MIKE, ADCIRC, SCHISM, FVCOM, SELAFIN and UGRID have z as data
    #[arg(
        long,
        value_enum,
        default_value = "coordinate",
        value_name = "MEANING",
        help_heading = "Target elements"
    )]
    pub(crate) z: ZArg,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ZArg {
    Coordinate,
    Data,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SurfaceArg {
    Plane,
    Sphere,
}
