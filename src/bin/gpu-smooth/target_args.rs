//! The options that say what elements are to look like.

use std::path::Path;

use clap::Args;
use gpu_smooth::{MeshError, MeshFile, Metric, Smoother, Solution, Surface, Targets};

use crate::explain;
use crate::report::TargetReport;
use crate::surface_args::SurfaceArgs;

const HEADING: &str = "Target elements";

/// What elements are to look like.
#[derive(Args)]
pub(crate) struct TargetArgs {
    /// What elements are to look like: equilateral, of any size that their neighbors leave them; equilateral, of the sizes
    /// they have (keep-size); of the size, stretching and orientation they have (keep-shape); equilateral, of the sizes
    /// in SOURCE (size=SOURCE), or equilateral under the tensors in SOURCE (metric=SOURCE). SOURCE is a .sol file of Medit,
    /// a metric file of BAMG, or the name of point data of IN, with a value for each vertex
    #[arg(long, default_value = "equilateral", value_name = "TARGET", help_heading = HEADING, value_parser = target)]
    target: Target,
    /// Over how many rings of neighbors the sizes and shapes to keep are averaged: more leave less of the mesh's noise
    #[arg(long, value_name = "N", default_value_t = 2, help_heading = HEADING, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1000))]
    target_rings: u32,
    #[command(flatten)]
    pub(crate) surface: SurfaceArgs,
}

#[derive(Clone, PartialEq, Eq)]
enum Target {
    Equilateral,
    KeepSize,
    KeepShape,
    Size { source: String },
    Metric { source: String },
}

fn target(text: &str) -> Result<Target, String> {
    let source = |source: &str| match source.is_empty() {
        true => Err("the name of a file or of point data is needed after =".to_owned()),
        false => Ok(source.to_owned()),
    };
    match (text, text.split_once('=')) {
        ("equilateral", _) => Ok(Target::Equilateral),
        ("keep-size", _) => Ok(Target::KeepSize),
        ("keep-shape", _) => Ok(Target::KeepShape),
        (_, Some(("size", name))) => Ok(Target::Size { source: source(name)? }),
        (_, Some(("metric", name))) => Ok(Target::Metric { source: source(name)? }),
        _ => Err("there are equilateral, keep-size, keep-shape, size=SOURCE, metric=SOURCE".into()),
    }
}

impl TargetArgs {
    /// The metric where none is chosen.
    pub(crate) fn default_metric(&self) -> Metric {
        if self.is_of_sizes() { Metric::SoftSize } else { Metric::Imr }
    }

    /// Whether a metric that sees no sizes would leave the target without effect.
    pub(crate) fn is_of_sizes(&self) -> bool {
        matches!(self.target, Target::KeepSize | Target::Size { .. })
    }

    /// Whether the coordinates are taken for lengths in the plane.
    pub(crate) fn is_on_plane(&self) -> bool {
        self.surface() == Surface::Plane
    }

    /// What the coordinates are.
    pub(crate) fn surface(&self) -> Surface {
        self.surface.surface()
    }

    /// What there is to report of targets, with f of them before and after.
    pub(crate) fn report(
        &self,
        before: f64,
        after: impl FnOnce() -> Result<f64, String>,
    ) -> Result<Option<TargetReport>, String> {
        let kind = match &self.target {
            Target::Equilateral if self.is_on_plane() => return Ok(None),
            Target::Equilateral => "equilateral".to_owned(),
            Target::KeepSize => "keep-size".to_owned(),
            Target::KeepShape => "keep-shape".to_owned(),
            Target::Size { source } => format!("size={source}"),
            Target::Metric { source } => format!("metric={source}"),
        };
        let f = [before, after()?];
        let surface = self.surface.name();
        Ok(Some(TargetReport { kind, surface, rings: self.target_rings, f }))
    }

    /// Sets the targets of a mesh with its vertices at `points`.
    pub(crate) fn set(
        &self,
        file: &MeshFile,
        smoother: &mut Smoother<'_>,
        points: &[[f64; 2]],
    ) -> Result<(), String> {
        let told = |error: MeshError| explain::mesh_error(file, &error);
        let Some(targets) = self.targets(file, smoother, points, told)? else { return Ok(()) };
        smoother.set_targets(&targets).map_err(told)
    }

    fn targets(
        &self,
        file: &MeshFile,
        smoother: &Smoother<'_>,
        points: &[[f64; 2]],
        told: impl Fn(MeshError) -> String,
    ) -> Result<Option<Targets>, String> {
        let surface = self.surface();
        let (topology, rings) = (smoother.topology(), self.target_rings);
        let targets = match &self.target {
            Target::Equilateral if surface == Surface::Plane => return Ok(None),
            Target::Equilateral => Ok(Targets::equilateral(points.len())),
            Target::KeepSize => Targets::keep_size(topology, points, surface, rings),
            // Shapes are those that the coordinates have.
            Target::KeepShape => {
                return Targets::keep_shape(topology, points, rings).map(Some).map_err(told);
            }
            Target::Size { source } => Targets::sizes(&given(file, source, 1)?),
            Target::Metric { source } => {
                let values = given(file, source, 3)?;
                Targets::tensors(values.as_chunks().0)
            }
        };
        let targets = targets.and_then(|targets| targets.seen_on(surface, points));
        targets.map(Some).map_err(told)
    }
}

/// The numbers of each vertex that a file beside the mesh has, or point data of the mesh.
fn given(file: &MeshFile, source: &str, components: usize) -> Result<Vec<f64>, String> {
    let (found, values) = match Path::new(source).exists() {
        true => {
            let solution = Solution::read(Path::new(source)).map_err(|error| error.to_string())?;
            (solution.components(), solution.values().to_vec())
        }
        false => {
            let fields = file.point_fields(Some(&[source.to_owned()])).map_err(|error| {
                format!("{source}: there is no such file, and {error} (--target)")
            })?;
            (fields[0].components(), fields[0].values().to_vec())
        }
    };
    let vertices = file.original().points.len();
    if found != components {
        return Err(format!(
            "{source}: a vertex has {found} numbers where {components} are needed: --target size= takes one, metric= three (xx, xy, yy)"
        ));
    }
    if values.len() != components * vertices {
        return Err(format!(
            "{source}: there are numbers for {} vertices, and {} has {vertices}",
            values.len() / components,
            file.path().display()
        ));
    }
    Ok(match file.chart() {
        Some(chart) => chart.extended(&values, components),
        None => values,
    })
}
