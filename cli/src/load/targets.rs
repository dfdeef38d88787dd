//! Targets of the elements of a mesh, from the mesh itself, other files or background meshes.

use crate::error::CliError;
use crate::load::LoadedMesh;
use std::path::Path;

use gpu_smooth::{
    Mesh, MeshError, Metric, Smoother, TargetField, Targets,
    interpolate::Chart,
    precision::Precision,
    targets::{OutsideReport, Surface},
};
use mesh_io::{GmshView, MeditSolution, MeshFile, ReadError};

use crate::load::{explain, lay_out};
use crate::request::{
    ElementProperty, TargetNumbers, TargetRequest, TargetSource, ThirdCoordinate,
};
use crate::terminal::numbers::sig6;

/// Facts about the targets of a smoother that users are told.
#[derive(Default)]
pub(crate) struct TargetFacts {
    /// A remark on vertices outside of the background, or on the weight of sizes.
    pub(crate) remark: Option<String>,
    /// Factor of the term of size in the base metric; `None` for targets other than `keep-size`, and for metrics without
    /// this factor.
    pub(crate) size_weight: Option<f64>,
}

impl TargetRequest {
    /// Sets the targets of a smoother, for vertices at `points` on a surface and a run with the base metric `metric`.
    pub(crate) fn set(
        &self,
        file: &LoadedMesh,
        smoother: &mut Smoother<'_>,
        points: &[[f64; 2]],
        surface: Surface,
        metric: Metric,
    ) -> Result<TargetFacts, CliError> {
        let explained = |error: MeshError| explain::mesh_error(file, &error);
        if let Some((path, field)) = self.field(file, surface)? {
            let outside = match self.is_of_places() {
                true => smoother.set_target_field(field).map_err(explained)?,
                false => {
                    let (targets, outside) = field.at(points).map_err(explained)?;
                    smoother.set_targets(&targets).map_err(explained)?;
                    outside
                }
            };
            return Ok(TargetFacts { remark: remark(path, outside), size_weight: None });
        }
        let Some(given) = self.targets(file, smoother, points, surface)? else {
            return Ok(TargetFacts::default());
        };
        let MeshTargets { targets, surface } = given;
        let facts = self.facts(&targets, metric);
        if !self.is_of_places() {
            let seen = targets.seen_on(surface, points, &file.mesh().triangles);
            let set = seen.and_then(|targets| smoother.set_targets(&targets));
            return set.map(|()| facts).map_err(explained);
        }
        let triangles = smoother.topology().triangles().to_vec();
        let mesh = Mesh { points: points.to_vec(), triangles, fixed: Vec::new() };
        let field = TargetField::new(&mesh, &targets).map_err(explained)?.seen_on(surface);
        smoother.set_target_field(field).map(|_| facts).map_err(explained)
    }

    /// Returns the facts about targets made from the mesh itself or from numbers for its vertices.
    fn facts(&self, targets: &Targets, metric: Metric) -> TargetFacts {
        let keeps_sizes = matches!(self, Self::Keep { what: ElementProperty::Size, .. });
        if !keeps_sizes || !metric.has_size_weight() {
            return TargetFacts::default();
        }
        let size_weight = targets.size_weight();
        let remark = (size_weight > 1.0).then(|| {
            format!(
                "--target keep-size: the triangles are stretched, so the metric's term of size has a weight of {size_weight:.2}, \
                 which keeps the sizes; --target keep-shape keeps the stretching too"
            )
        });
        TargetFacts { remark, size_weight: Some(size_weight) }
    }

    /// Reads the target field on a background mesh or view. Returns the field and the path of its file; `None` for
    /// other targets.
    fn field(
        &self,
        file: &LoadedMesh,
        surface: Surface,
    ) -> Result<Option<(&Path, TargetField)>, CliError> {
        let Self::Given { what, source, .. } = self else { return Ok(None) };
        match source {
            TargetSource::OfMesh(_) => Ok(None),
            TargetSource::Background { mesh, data } => {
                Ok(Some((mesh, field_of_mesh(file, mesh, data, *what, surface)?)))
            }
            TargetSource::View(path) if !file.is_in_xy() => {
                let text = format!(
                    "{}: a view has positions in x and y, but the mesh lies in another plane",
                    path.display()
                );
                Err(CliError::input(text)
                    .with_remedy("Take the targets from data of a mesh in this plane"))
            }
            TargetSource::View(path) => Ok(Some((path, field_of_view(path, surface)?))),
        }
    }

    /// Returns the targets of the vertices; `None` for equilateral targets in the plane.
    fn targets(
        &self,
        file: &LoadedMesh,
        smoother: &Smoother<'_>,
        points: &[[f64; 2]],
        surface: Surface,
    ) -> Result<Option<MeshTargets>, CliError> {
        let topology = smoother.topology();
        let targets = match self {
            Self::Equilateral if surface == Surface::Plane => return Ok(None),
            Self::Equilateral => Ok(Targets::equilateral(points.len())),
            Self::Keep { what: ElementProperty::Size, rings, .. } => {
                Targets::keep_size(topology, points, surface, *rings)
            }
            Self::Keep { what: ElementProperty::Shape, rings, .. } => {
                Targets::keep_shape(topology, points, *rings)
            }
            Self::Given { what, text, .. } => {
                of_numbers(*what, &given(file, text, components(*what))?)
            }
        };
        let surface = match self {
            // Shapes are kept as they appear in coordinates, also on the sphere.
            Self::Keep { what: ElementProperty::Shape, .. } => Surface::Plane,
            _ => surface,
        };
        let targets = targets.map_err(|error| explain::mesh_error(file, &error))?;
        Ok(Some(MeshTargets { targets, surface }))
    }
}

/// Targets of the vertices of a mesh, with lengths measured on `surface`.
struct MeshTargets {
    targets: Targets,
    surface: Surface,
}

/// Returns the count of numbers per vertex in a source of targets.
fn components(what: TargetNumbers) -> usize {
    match what {
        TargetNumbers::Sizes => 1,
        TargetNumbers::Tensors => 3,
    }
}

/// Makes targets from the numbers of a source, in the order of the vertices.
fn of_numbers(what: TargetNumbers, numbers: &[f64]) -> Result<Targets, MeshError> {
    match what {
        TargetNumbers::Sizes => Targets::sizes(numbers),
        TargetNumbers::Tensors => Targets::tensors(numbers.as_chunks().0),
    }
}

/// Reads the target field on a background mesh, in the plane of the mesh `file`.
fn field_of_mesh(
    file: &LoadedMesh,
    path: &Path,
    data: &str,
    what: TargetNumbers,
    surface: Surface,
) -> Result<TargetField, CliError> {
    let read = MeshFile::read(path).map_err(|error| match error {
        // No option allows a background mesh to refer to files elsewhere.
        ReadError::Outside { .. } => {
            of_background(CliError::from(error).with_remedy("Move the file beside the mesh"))
        }
        error => of_background(error.into()),
    })?;
    let mut background = LoadedMesh::new(read);
    lay_out(&mut background, surface, ThirdCoordinate::Data)?;
    if file.plane().is_some() {
        file.lay_out_likewise(&mut background)?;
    }
    let numbers = given(&background, data, components(what))?;
    of_numbers(what, &numbers)
        .and_then(|targets| TargetField::new(background.mesh(), &targets))
        .map(|field| field.seen_on(surface))
        .map_err(|error| explain::mesh_error(&background, &error))
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
    let mesh = Mesh { points, triangles, fixed: Vec::new() };
    let chart = match surface {
        Surface::Plane => None,
        Surface::Sphere => Chart::new(&mesh, Precision::Double).map_err(told_of)?,
    };
    let (mesh, values) = match &chart {
        Some(chart) => (chart.mesh(), chart.extended(view.values(), 1)),
        None => (&mesh, view.values().to_vec()),
    };
    Targets::sizes(&values)
        .and_then(|targets| TargetField::new(mesh, &targets))
        .map(|field| field.seen_on(surface))
        .map_err(told_of)
}

/// Returns the remark on vertices outside of a background; `None` if all vertices are inside.
fn remark(background: &Path, outside: OutsideReport) -> Option<String> {
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
            let solution = MeditSolution::read(Path::new(source))?;
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
