//! The options that let vertices slide along the boundary.

use clap::Args;
use gpu_smooth::{MeshFile, Slide, Smoother, Topology};

use crate::explain;
use crate::numbers::number;

const HEADING: &str = "What may move";

/// What slides.
#[derive(Args)]
pub(crate) struct SlideArgs {
    /// Let vertices of the boundary, between regions and on lines slide along them, from corner to corner. What is straight stays
    /// straight; elsewhere they follow a cubic through the vertices of IN
    #[arg(long, help_heading = HEADING)]
    pub(crate) slide: bool,
    /// A vertex where a line turns by more degrees is a corner, and stays
    #[arg(long, value_name = "DEGREES", default_value_t = 40.0, requires = "slide", help_heading = HEADING, value_parser = angle, allow_negative_numbers = true)]
    corner_angle: f64,
    /// How far lines may leave those of IN, in the unit of the mesh [default: a tenth of the edge there]
    #[arg(long, value_name = "DISTANCE", requires = "slide", help_heading = HEADING, value_parser = distance, allow_negative_numbers = true)]
    hausdorff: Option<f64>,
}

fn angle(text: &str) -> Result<f64, String> {
    number(text, |angle| (0.0..=180.0).contains(&angle), "an angle from 0 to 180 degrees")
}

fn distance(text: &str) -> Result<f64, String> {
    number(text, |length| length > 0.0 && length.is_finite(), "a length above 0")
}

impl SlideArgs {
    /// What slides in a mesh, if anything is to.
    pub(crate) fn slide(&self, file: &MeshFile) -> Result<Option<Slide>, String> {
        if !self.slide {
            return Ok(None);
        }
        let mut held = file.held_vertices().to_vec();
        if file.is_periodic() {
            let topology =
                Topology::new(file.mesh()).map_err(|error| explain::mesh_error(file, &error))?;
            held.extend(topology.boundary_edges().into_iter().flatten());
        }
        let Self { corner_angle, hausdorff, .. } = *self;
        Ok(Some(Slide { corner_angle, hausdorff, lines: file.lines(), held }))
    }

    /// Lets vertices of a mesh slide. Returns a remark on it.
    pub(crate) fn set(
        &self,
        file: &MeshFile,
        smoother: &mut Smoother<'_>,
    ) -> Result<Option<String>, String> {
        let Some(slide) = self.slide(file)? else { return Ok(None) };
        let count = smoother.set_slide(Some(&slide)).map_err(|error| error.to_string())?;
        let periodic = match file.is_periodic() {
            true => "; the boundary stays, as the model is periodic",
            false => "",
        };
        Ok(Some(match count {
            0 => format!(
                "--slide: no vertex can slide, as all on lines are corners or fixed{periodic}"
            ),
            1 => format!("--slide: 1 vertex on the boundary or another line may slide{periodic}"),
            n => {
                format!("--slide: {n} vertices on the boundary and other lines may slide{periodic}")
            }
        }))
    }
}
