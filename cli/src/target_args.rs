//! The options that say what elements should look like.

use crate::load::LoadedMesh;
use std::path::Path;

use clap::{Args, ValueEnum};
use gpu_smooth::{
    Chart, Mesh, MeshError, Metric, Outside, Precision, Smoother, Surface, TargetField, Targets,
};
use mesh_io::{MeshFile, Solution, View};

use crate::explain;
use crate::numbers::six;
use crate::report::TargetReport;
use crate::surface_args::SurfaceArgs;

const HEADING: &str = "Target elements";

/// The options that say what elements should look like.
#[derive(Args)]
pub(crate) struct TargetArgs {
    /// What elements are to look like: equilateral, of any size that their neighbors leave them (equilateral); equilateral, of the
    /// sizes they have (keep-size); of the size, stretching and orientation they have (keep-shape); equilateral, of the sizes
    /// in SOURCE (size=SOURCE); or equilateral under the tensors in SOURCE (metric=SOURCE). SOURCE has a value for each vertex:
    /// a .sol file of Medit, a metric file of BAMG, or the name of point data of IN. Or it is on another mesh: BACKGROUND:DATA, where
    /// BACKGROUND is a mesh file and DATA its point data or such a file, or a view of gmsh (.pos) of scalars on triangles
    #[arg(long, default_value = "equilateral", value_name = "TARGET", help_heading = HEADING, value_parser = target)]
    target: Target,
    /// Over how many rings of neighbors the sizes and shapes to keep are averaged: more leave less of the mesh's noise [default: 2]
    #[arg(long, value_name = "N", help_heading = HEADING, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1000))]
    target_rings: Option<u32>,
    /// What a target belongs to: vertices, which take it along, or places, so that it is taken anew from where vertices have moved
    /// [default: place for a BACKGROUND, else vertex]
    #[arg(long, value_enum, value_name = "WHAT", help_heading = HEADING)]
    target_of: Option<Owner>,
    #[command(flatten)]
    pub(crate) surface: SurfaceArgs,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Owner {
    Vertex,
    Place,
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
        _ => Err("give equilateral, keep-size, keep-shape, size=SOURCE or metric=SOURCE".into()),
    }
}

impl TargetArgs {
    /// Returns the metric if the user chose none.
    pub(crate) fn default_metric(&self) -> Metric {
        if self.is_of_sizes() { Metric::SoftSize } else { Metric::Imr }
    }

    /// Whether the target is only of sizes, so that a metric that sees no sizes would ignore it.
    pub(crate) fn is_of_sizes(&self) -> bool {
        matches!(self.target, Target::KeepSize | Target::Size { .. })
    }

    /// Whether the coordinates are taken for lengths in the plane.
    pub(crate) fn is_on_plane(&self) -> bool {
        self.surface() == Surface::Plane
    }

    /// Returns what the coordinates are: lengths in the plane or degrees on the sphere.
    pub(crate) fn surface(&self) -> Surface {
        self.surface.surface()
    }

    /// Returns the report on targets, with the objective of targets before and after, unless elements were to be
    /// equilateral in the plane.
    pub(crate) fn report(
        &self,
        before: f64,
        after: impl FnOnce() -> Result<f64, String>,
    ) -> Result<Option<TargetReport>, String> {
        if self.target == Target::Equilateral && self.is_on_plane() {
            return Ok(None);
        }
        let kind = self.kind();
        let f = [before, after()?];
        let surface = self.surface.name();
        let of = if self.is_of_places() { "place" } else { "vertex" };
        let rings = self.keeps().then(|| self.rings());
        Ok(Some(TargetReport { kind, of, surface, rings, f }))
    }

    /// The target as it is given.
    pub(crate) fn kind(&self) -> String {
        match &self.target {
            Target::Equilateral => "equilateral".to_owned(),
            Target::KeepSize => "keep-size".to_owned(),
            Target::KeepShape => "keep-shape".to_owned(),
            Target::Size { source } => format!("size={source}"),
            Target::Metric { source } => format!("metric={source}"),
        }
    }

    /// Whether sizes or shapes of the mesh itself are kept.
    fn keeps(&self) -> bool {
        matches!(self.target, Target::KeepSize | Target::KeepShape)
    }

    fn rings(&self) -> u32 {
        self.target_rings.unwrap_or(2)
    }

    /// The option that the target leaves without effect, and what would give it one.
    pub(crate) fn without_effect(&self) -> Option<(&'static str, &'static str)> {
        if self.target_rings.is_some() && !self.keeps() {
            return Some(("--target-rings", "--target keep-size or keep-shape"));
        }
        let is_uniform = matches!(self.target, Target::Equilateral);
        (self.target_of.is_some() && is_uniform).then_some(("--target-of", "another --target"))
    }

    /// Whether targets belong to places, not to vertices.
    pub(crate) fn is_of_places(&self) -> bool {
        let is_uniform = matches!(self.target, Target::Equilateral);
        let default = if self.background().is_some() { Owner::Place } else { Owner::Vertex };
        !is_uniform && self.target_of.unwrap_or(default) == Owner::Place
    }

    /// Returns the background mesh and the name of its data, if the target is given on one. The name is empty for a
    /// view of gmsh.
    fn background(&self) -> Option<(&Path, &str)> {
        let (Target::Size { source } | Target::Metric { source }) = &self.target else {
            return None;
        };
        if is_view(source) {
            return Some((Path::new(source), ""));
        }
        let (mesh, data) = source.rsplit_once(':')?;
        let is_file = Path::new(source).exists() || data.is_empty();
        (!is_file && Path::new(mesh).exists()).then_some((Path::new(mesh), data))
    }

    /// Sets the targets of a mesh whose vertices are at `points`. Returns a remark on vertices outside of a background.
    pub(crate) fn set(
        &self,
        file: &LoadedMesh,
        smoother: &mut Smoother<'_>,
        points: &[[f64; 2]],
    ) -> Result<Option<String>, String> {
        let told = |error: MeshError| explain::mesh_error(file, &error);
        if let Some((path, data)) = self.background() {
            let field = self.field(path, data)?;
            let outside = match self.is_of_places() {
                true => smoother.set_target_field(field).map_err(told)?,
                false => {
                    let (targets, outside) = field.at(points).map_err(told)?;
                    smoother.set_targets(&targets).map_err(told)?;
                    outside
                }
            };
            return Ok(remark(path, outside));
        }
        let Some((targets, surface)) = self.targets(file, smoother, points, told)? else {
            return Ok(None);
        };
        if !self.is_of_places() {
            let seen = targets.seen_on(surface, points, &file.mesh().triangles);
            let set = seen.and_then(|targets| smoother.set_targets(&targets));
            return set.map(|()| None).map_err(told);
        }
        let triangles = smoother.topology().triangles().to_vec();
        let mesh = Mesh { points: points.to_vec(), triangles, fixed: Vec::new() };
        let field = TargetField::new(&mesh, &targets).map_err(told)?.seen_on(surface);
        smoother.set_target_field(field).map(|_| None).map_err(told)
    }

    /// Reads the targets that a background mesh carries.
    fn field(&self, path: &Path, data: &str) -> Result<TargetField, String> {
        if data.is_empty() {
            return self.field_of_view(path);
        }
        let read = MeshFile::read(path);
        let mut background =
            LoadedMesh::new(read.map_err(|error| format!("the background of --target: {error}"))?);
        self.surface.lay_out(&mut background)?;
        let targets = match &self.target {
            Target::Metric { .. } => Targets::tensors(given(&background, data, 3)?.as_chunks().0),
            _ => Targets::sizes(&given(&background, data, 1)?),
        };
        let mesh = background.mesh();
        targets
            .and_then(|targets| TargetField::new(mesh, &targets))
            .map(|field| field.seen_on(self.surface()))
            .map_err(|error| explain::mesh_error(&background, &error))
    }

    /// Reads the sizes in a view of gmsh.
    fn field_of_view(&self, path: &Path) -> Result<TargetField, String> {
        let told = |problem: String| format!("the background of --target: {problem}");
        let view = View::read(path).map_err(|error| told(error.to_string()))?;
        let name = path.display();
        if matches!(self.target, Target::Metric { .. }) {
            return Err(told(format!(
                "{name}: a view of gmsh holds sizes, not tensors: give size={name}"
            )));
        }
        let told_of = |error: MeshError| {
            told(format!("{name}: {error} (counted from 0, in the order of the file)"))
        };
        let (points, triangles) = (view.points().to_vec(), view.triangles().to_vec());
        let mesh = Mesh { points, triangles, fixed: Vec::new() };
        let chart = match self.surface() {
            Surface::Plane => None,
            Surface::Sphere => Chart::new(&mesh, Precision::Double).map_err(told_of)?,
        };
        let (mesh, values) = match &chart {
            Some(chart) => (chart.mesh(), chart.extended(view.values(), 1)),
            None => (&mesh, view.values().to_vec()),
        };
        Targets::sizes(&values)
            .and_then(|targets| TargetField::new(mesh, &targets))
            .map(|field| field.seen_on(self.surface()))
            .map_err(told_of)
    }

    /// Returns the targets of the vertices, and the surface in whose lengths they are given. `None` for equilateral in
    /// the plane.
    fn targets(
        &self,
        file: &LoadedMesh,
        smoother: &Smoother<'_>,
        points: &[[f64; 2]],
        told: impl Fn(MeshError) -> String,
    ) -> Result<Option<(Targets, Surface)>, String> {
        let surface = self.surface();
        let (topology, rings) = (smoother.topology(), self.rings());
        let in_coordinates = |targets| (targets, Surface::Plane);
        let targets = match &self.target {
            Target::Equilateral if surface == Surface::Plane => return Ok(None),
            Target::Equilateral => Ok((Targets::equilateral(points.len()), surface)),
            Target::KeepSize => Targets::keep_size(topology, points, surface, rings)
                .map(|targets| (targets, surface)),
            // Shapes are kept as they are in the coordinates, also on the sphere.
            Target::KeepShape => Targets::keep_shape(topology, points, rings).map(in_coordinates),
            Target::Size { source } => {
                Targets::sizes(&given(file, source, 1)?).map(|targets| (targets, surface))
            }
            Target::Metric { source } => {
                let values = given(file, source, 3)?;
                Targets::tensors(values.as_chunks().0).map(|targets| (targets, surface))
            }
        };
        targets.map(Some).map_err(told)
    }
}

/// Whether a source is an existing `.pos` file, a view of gmsh.
fn is_view(source: &str) -> bool {
    let path = Path::new(source);
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("pos")) && path.exists()
}

/// Words the remark on vertices outside of a background.
fn remark(background: &Path, outside: Outside) -> Option<String> {
    let Outside { count, most } = outside;
    let vertices = match count {
        0 => return None,
        1 => "1 vertex is".to_owned(),
        n => format!("{n} vertices are"),
    };
    Some(format!(
        "{vertices} outside of {}, by up to {}: the target of the nearest point in it is taken there",
        background.display(),
        six(most)
    ))
}

/// Reads `components` numbers for each vertex, from a file beside the mesh or from point data of the mesh.
fn given(file: &LoadedMesh, source: &str, components: usize) -> Result<Vec<f64>, String> {
    let (found, values) = match Path::new(source).exists() {
        true => {
            let solution = Solution::read(Path::new(source)).map_err(|error| error.to_string())?;
            (solution.components(), solution.values().to_vec())
        }
        false => {
            let fields = file.source.point_fields(Some(&[source.to_owned()])).map_err(|error| {
                format!("{source}: there is no such file, and {error} (--target)")
            })?;
            (fields[0].components(), fields[0].values().to_vec())
        }
    };
    let vertices = file.source.points().len();
    if found != components {
        return Err(format!(
            "{source}: numbers per vertex: {found}, needed: {components}. --target size= takes one, metric= three (xx, xy, yy)"
        ));
    }
    if values.len() != components * vertices {
        return Err(format!(
            "{source}: it has numbers for {} vertices, but {} has {vertices} vertices",
            values.len() / components,
            file.source.path().display()
        ));
    }
    Ok(match file.chart() {
        Some(chart) => chart.extended(&values, components),
        None => values,
    })
}
