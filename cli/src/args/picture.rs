//! The options of pictures, which commands share.

use std::path::PathBuf;

use clap::Args;
use gpu_smooth::measure::Measure;

use crate::args::{names, parse};

#[derive(Args)]
pub(crate) struct PictureArgs {
    /// Draw the mesh, colored by its quality, as .png or .svg
    #[arg(long, value_name = "FILE", help_heading = "Picture")]
    pub(crate) picture: Option<PathBuf>,
    /// The measure that colors show, on a page at first (see `gpu-smooth quality --help`). orthogonality, flow-link
    /// and smoothness color edges, other measures elements
    #[arg(
        long,
        value_name = "NAME",
        default_value = "shape",
        value_parser = names::measures(),
        hide_possible_values = true,
        requires = "drawing",
        help_heading = "Picture"
    )]
    pub(crate) picture_measure: Measure,
    /// The values of the measure between which the colors change, on a page too. Values beyond have the color of the nearer
    /// end. The default depends on the measure, and is 0.5,1 for shape (see docs/quality.md)
    #[arg(
        long,
        value_name = "LOW,HIGH",
        requires = "drawing",
        help_heading = "Picture",
        value_parser = parse::two_numbers,
        allow_hyphen_values = true
    )]
    pub(crate) picture_range: Option<[f64; 2]>,
    /// The width of the picture in pixels
    #[arg(
        long,
        value_name = "PIXELS",
        default_value_t = 1600,
        requires = "picture",
        help_heading = "Picture",
        value_parser = parse::pixels
    )]
    pub(crate) picture_size: u32,
    /// Draw only the part of the mesh in this rectangle, between two opposite corners
    #[arg(
        long,
        value_name = "X0,Y0,X1,Y1",
        requires = "picture",
        help_heading = "Picture",
        value_parser = parse::area,
        allow_hyphen_values = true
    )]
    pub(crate) picture_box: Option<[[f64; 2]; 2]>,
    /// Draw how far the vertices of a run have moved, as arrows on the mesh after the run
    #[arg(long, requires = "picture", help_heading = "Picture")]
    pub(crate) picture_arrows: bool,
}
