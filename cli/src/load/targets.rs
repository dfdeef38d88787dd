//! The targets of the elements of a mesh, from the mesh itself, other files or background meshes.

use crate::error::CliError;
use crate::load::LoadedMesh;
use std::path::Path;

use gpu_smooth::{
    Chart, Mesh, MeshError, Outside, Precision, Smoother, Surface, TargetField, Targets,
};
use mesh_io::{MeshFile, Solution, View};

use crate::args::{Target, TargetArgs};
use crate::load::explain;
use crate::terminal::numbers::six;

impl TargetArgs {
    /// Sets the targets of a mesh whose vertices are at `points`. Returns a remark on vertices outside of a background.
    pub(crate) fn set(
        &self,
        file: &LoadedMesh,
        smoother: &mut Smoother<'_>,
        points: &[[f64; 2]],
    ) -> Result<Option<String>, CliError> {
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
    fn field(&self, path: &Path, data: &str) -> Result<TargetField, CliError> {
        if data.is_empty() {
            return self.field_of_view(path);
        }
        let read = MeshFile::read(path);
        let mut background = LoadedMesh::new(read.map_err(|error| of_background(error.into()))?);
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
    fn field_of_view(&self, path: &Path) -> Result<TargetField, CliError> {
        let view = View::read(path).map_err(|error| of_background(error.into()))?;
        let name = path.display();
        let told_of = |error: MeshError| {
            let text = format!("{name}: {error} (counted from 0, in the order of the file)");
            of_background(CliError::input(text))
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
        told: impl Fn(MeshError) -> CliError,
    ) -> Result<Option<(Targets, Surface)>, CliError> {
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

/// Words an error in the background mesh of a target.
fn of_background(error: CliError) -> CliError {
    error.within("the background of --target")
}

/// Reads `components` numbers for each vertex, from a file beside the mesh or from point data of the mesh.
fn given(file: &LoadedMesh, source: &str, components: usize) -> Result<Vec<f64>, CliError> {
    let (found, values) = match Path::new(source).exists() {
        true => {
            let solution = Solution::read(Path::new(source))?;
            (solution.components(), solution.values().to_vec())
        }
        false => {
            let fields = file.source.point_fields(Some(&[source.to_owned()])).map_err(|error| {
                CliError::from(error)
                    .about("--target")
                    .after(&format!("{source}: there is no such file, and"))
            })?;
            (fields[0].components(), fields[0].values().to_vec())
        }
    };
    let vertices = file.source.points().len();
    if found != components {
        let text = format!("{source}: numbers per vertex: {found}, needed: {components}");
        return Err(CliError::input(text)
            .with_remedy("--target size= takes one, metric= three (xx, xy, yy)"));
    }
    if values.len() != components * vertices {
        return Err(CliError::input(format!(
            "{source}: it has numbers for {} vertices, but {} has {vertices} vertices",
            values.len() / components,
            file.source.path().display()
        )));
    }
    Ok(match file.chart() {
        Some(chart) => chart.extended(&values, components),
        None => values,
    })
}
