//! The request on a picture.

use std::path::{Path, PathBuf};

use crate::args::PictureArgs;
use crate::color_scale::ColorScale;
use crate::error::CliError;

/// The format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFormat {
    Png,
    Svg,
}

/// A picture of a mesh.
pub(crate) struct PictureRequest {
    pub(crate) path: PathBuf,
    pub(crate) format: PictureFormat,
    pub(crate) colors: ColorScale,
    /// The width in pixels.
    pub(crate) width: u32,
    /// Opposite corners of the drawn part; `None` for the whole mesh.
    pub(crate) part: Option<[[f64; 2]; 2]>,
    /// Whether arrows show how far vertices have moved.
    pub(crate) with_arrows: bool,
}

impl PictureRequest {
    /// Returns the requested picture; `None` without `--picture`.
    ///
    /// # Errors
    /// A usage error if the extension of the path is neither `.png` nor `.svg`.
    pub(super) fn of(args: &PictureArgs, colors: ColorScale) -> Result<Option<Self>, CliError> {
        let Some(path) = &args.picture else { return Ok(None) };
        Ok(Some(Self {
            path: path.clone(),
            format: format(path)?,
            colors,
            width: args.picture_size,
            part: args.picture_box,
            with_arrows: args.picture_arrows,
        }))
    }
}

impl PictureRequest {
    /// Checks that the drawn part has a vertex of the mesh.
    ///
    /// # Errors
    /// An input error if no vertex lies in the rectangle of `--picture-box`.
    pub(crate) fn check_part(&self, points: &[[f64; 2]]) -> Result<(), CliError> {
        let Some([p, q]) = self.part else { return Ok(()) };
        let is_between = |axis: usize, x: f64| (x - p[axis]) * (x - q[axis]) <= 0.0;
        match points.iter().any(|&[x, y]| is_between(0, x) && is_between(1, y)) {
            true => Ok(()),
            false => Err(CliError::input("no vertex lies in the rectangle of --picture-box")
                .with_remedy("Give two opposite corners in coordinates of the mesh")),
        }
    }
}

/// Returns the scale of colors in a picture, and on a page by the same measure.
///
/// # Errors
/// A usage error if `--picture-range` is not in the range of the measure.
pub(super) fn colors(args: &PictureArgs) -> Result<ColorScale, CliError> {
    let (measure, usual) = (args.picture_measure, ColorScale::usual(args.picture_measure));
    let Some(range) = args.picture_range else { return Ok(usual) };
    ColorScale::new(measure, range).map_err(|problem| {
        let [low, high] = usual.range();
        CliError::usage(format!("--picture-range: {problem}")).with_remedy(format!(
            "Give two values of {measure}, as in --picture-range {low},{high}"
        ))
    })
}

fn format(path: &Path) -> Result<PictureFormat, CliError> {
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
    match ending.as_deref() {
        Some("png") => Ok(PictureFormat::Png),
        Some("svg") => Ok(PictureFormat::Svg),
        _ => Err(CliError::usage(format!("{}: a picture is PNG or SVG", path.display()))
            .with_remedy("End its name in .png or .svg")),
    }
}
