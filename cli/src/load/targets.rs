//! Targets of the elements of a mesh, from the mesh itself, other files or background meshes.

use crate::error::CliError;
use crate::load::LoadedMesh;
use std::path::Path;

use gpu_smooth::{
    Mesh, MeshError, Metric, Smoother, TargetField,
    front_ends::Chart,
    options::Precision,
    targets::{OutsideReport, Surface},
};
use gpu_smooth_job::{TargetFacts, TargetKind, TargetSource as Numbers};
use mesh_io::{GmshView, MeditSolution, ReadError, ReadOptions};

use crate::load::{explain, lay_out};
use crate::request::{GivenTargets, TargetRequest, TargetSource, ThirdCoordinate};
use crate::terminal::numbers::sig6;

impl TargetRequest {
    /// Sets the targets of a smoother for a run on a surface with the base metric `metric`. Returns the facts about the
    /// targets, and a remark on vertices outside of the background or on the weight of sizes.
    pub(crate) fn set(
        &self,
        file: &LoadedMesh,
        smoother: &mut Smoother<'_>,
        surface: Surface,
        metric: Metric,
    ) -> Result<(TargetFacts, Option<String>), CliError> {
        let (source, path) = self.read(file, surface)?;
        let &Self { kind, rings, of_places, .. } = self;
        let targets = gpu_smooth_job::TargetRequest { kind, source, rings, of_places, surface };
        let facts = targets
            .set(smoother, file.chart(), metric)
            .map_err(|error| self.explained(file, &error))?;
        let outside = facts.outside.zip(path);
        let outside = outside.and_then(|(outside, path)| outside_of(path, outside));
        Ok((facts, outside.or_else(|| stretched(facts.size_weight?))))
    }

    /// Reads the numbers of the targets. Also returns the path of a background mesh or view.
    fn read(
        &self,
        file: &LoadedMesh,
        surface: Surface,
    ) -> Result<(Numbers, Option<&Path>), CliError> {
        let Some(GivenTargets { text, source }) = &self.given else {
            return Ok((Numbers::Mesh, None));
        };
        let (field, path) = match source {
            TargetSource::OfMesh(_) => {
                let numbers = given(file, text, self.kind.components())?;
                return Ok((Numbers::Vertices(numbers), None));
            }
            TargetSource::Background { mesh, data } => {
                (self.field_of_mesh(file, mesh, data, surface)?, mesh)
            }
            TargetSource::View(path) if !file.domain.is_in_xy() => {
                let text = format!(
                    "{}: a view has positions in x and y, but the mesh lies in another plane",
                    path.display()
                );
                return Err(CliError::input(text)
                    .with_remedy("Take the targets from data of a mesh in this plane"));
            }
            TargetSource::View(path) => (field_of_view(path, surface)?, path),
        };
        Ok((Numbers::Background(Box::new(field)), Some(path)))
    }

    /// Returns the error of targets at the vertices of `file`.
    fn explained(&self, file: &LoadedMesh, error: &MeshError) -> CliError {
        let told = explain::mesh_error(file, error);
        match (error, &self.given) {
            (MeshError::Target { .. }, Some(GivenTargets { text, .. })) => {
                told.within(text).with_remedy(match self.kind {
                    TargetKind::Tensors => "Give positive definite tensors, as xx, xy and yy",
                    _ => "Give sizes above 0",
                })
            }
            _ => told,
        }
    }

    /// Reads the target field on a background mesh, in the plane of the mesh `file`.
    fn field_of_mesh(
        &self,
        file: &LoadedMesh,
        path: &Path,
        data: &str,
        surface: Surface,
    ) -> Result<TargetField, CliError> {
        let kind = self.kind;
        let options = ReadOptions::new().allow_quadrilaterals_alone(true);
        let read = options.read(path).map_err(|error| match error {
            // No option allows a background mesh to refer to files elsewhere.
            ReadError::Outside { .. } => {
                of_background(CliError::from(error).with_remedy("Move the file beside the mesh"))
            }
            error => of_background(error.into()),
        })?;
        let mut background = LoadedMesh::of_elements(read);
        lay_out(&mut background, surface, ThirdCoordinate::Data)?;
        if file.plane().is_some() {
            file.lay_out_likewise(&mut background)?;
        }
        let numbers =
            extended(background.chart(), given(&background, data, kind.components())?, kind);
        kind.field(background.mesh(), &numbers, surface)
            .map_err(|error| self.explained(&background, &error))
    }
}

/// Returns the remark on the weight of the term of size in the metric; `None` for a weight of 1.
fn stretched(size_weight: f64) -> Option<String> {
    (size_weight > 1.0).then(|| {
        format!(
            "--target keep-size: the triangles are stretched, so the metric's term of size has a weight of {size_weight:.2}, \
             which keeps the sizes; --target keep-shape keeps the stretching too"
        )
    })
}

/// Reads the target field of sizes in a view of gmsh.
fn field_of_view(path: &Path, surface: Surface) -> Result<TargetField, CliError> {
    let view = GmshView::read(path).map_err(|error| of_background(error.into()))?;
    let name = path.display();
    let told_of = |error: MeshError| {
        let text = format!("{name}: {error} (counted from 0, in the order of the file)");
        of_background(CliError::input(text))
    };
    let (points, triangles) = (view.points().to_vec(), view.triangles().to_vec());
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    let chart = match surface {
        Surface::Plane => None,
        Surface::Sphere => Chart::new(&mesh, Precision::Double).map_err(told_of)?,
    };
    let values = extended(chart.as_ref(), view.values().to_vec(), TargetKind::Sizes);
    let mesh = chart.as_ref().map_or(&mesh, Chart::mesh);
    TargetKind::Sizes.field(mesh, &values, surface).map_err(told_of)
}

/// Returns numbers for the vertices of a chart, given those of the original vertices.
fn extended(chart: Option<&Chart>, numbers: Vec<f64>, kind: TargetKind) -> Vec<f64> {
    match chart {
        Some(chart) => chart.extended(&numbers, kind.components()),
        None => numbers,
    }
}

/// Returns the remark on vertices outside of a background; `None` if all vertices are inside.
fn outside_of(background: &Path, outside: OutsideReport) -> Option<String> {
    let OutsideReport { count, most } = outside;
    let vertices = match count {
        0 => return None,
        1 => "1 vertex is".to_owned(),
        n => format!("{n} vertices are"),
    };
    Some(format!(
        "{vertices} outside of {}, by up to {}: these vertices take the target of the nearest point of this mesh",
        background.display(),
        sig6(most)
    ))
}

/// Prefixes an error with its origin, the background mesh of a target.
fn of_background(error: CliError) -> CliError {
    error.within("the background of --target")
}

/// Reads `components` numbers per vertex, from a file if `source` exists, else from point data of the mesh.
fn given(file: &LoadedMesh, source: &str, components: usize) -> Result<Vec<f64>, CliError> {
    let (found, values) = match Path::new(source).exists() {
        true => {
            let is_solution =
                Path::new(source).extension().is_some_and(|kind| kind == "sol" || kind == "mtr");
            let solution =
                MeditSolution::read(Path::new(source)).map_err(|error| {
                    match is_solution {
                true => CliError::from(error),
                false => CliError::from(error).with_remedy(format!(
                    "Give a solution of Medit (.sol), or {source}:NAME for point data of this mesh"
                )),
            }
                })?;
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
        ))
        .with_remedy("Give numbers for each vertex of the mesh, in the order of the mesh file"));
    }
    Ok(values)
}
