//! The options that belong to a mesh: vertices that may move, targets and the surface of coordinates.

use std::ops::Deref;

use gpu_smooth::layers::KeepLayers;
use gpu_smooth::targets::Surface;
use gpu_smooth::{Mesh, MeshError};
use gpu_smooth_job::options::{Belongs, GivenOptions, Settings, Spelling};
use gpu_smooth_job::{TargetKind, TargetRequest, TargetSource};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};

use crate::arrays::{self, PerVertex, Points};
use crate::error;
use crate::run_options::{self, RunOptions};
use crate::values::{self, Given, ThirdCoordinate};

/// Names of the options of a mesh that are not in the table.
const OWN: [&str; 7] =
    ["quadrilaterals", "fixed", "lines", "regions", "periodic", "keep_layers", "target"];

/// Returns the names of the options of a mesh.
pub(crate) fn names() -> Vec<String> {
    let own = OWN.into_iter().map(str::to_owned);
    own.chain(run_options::of_table(Belongs::ToMesh)).collect()
}

/// The target shape and size of elements.
pub(crate) enum Target {
    Equilateral,
    KeepSize,
    KeepShape,
    /// Sizes or tensors of the vertices.
    Given(PerVertex),
    /// Sizes or tensors of the vertices of another mesh.
    Background {
        points: Box<Points>,
        triangles: Vec<[u32; 3]>,
        values: PerVertex,
    },
}

/// The options that belong to a mesh.
pub(crate) struct MeshOptions {
    given: GivenOptions,
    /// Vertices that neither move nor slide.
    pub(crate) fixed: Vec<u32>,
    /// Edges whose vertices stay, or slide along the edges.
    pub(crate) lines: Vec<[u32; 2]>,
    /// Region of each triangle, then of each quadrilateral; empty without regions.
    pub(crate) regions: Vec<i64>,
    /// Pairs of vertices that slide together.
    pub(crate) periodic: Vec<[u32; 2]>,
    /// Boundary layers that stay.
    pub(crate) keep_layers: KeepLayers,
    /// Vertices of the walls of these layers; `None` for all walls.
    pub(crate) walls: Option<Vec<u32>>,
    pub(crate) target: Target,
}

impl Deref for MeshOptions {
    type Target = GivenOptions;

    fn deref(&self) -> &GivenOptions {
        &self.given
    }
}

impl MeshOptions {
    fn new() -> Self {
        Self {
            given: GivenOptions::default(),
            fixed: Vec::new(),
            lines: Vec::new(),
            regions: Vec::new(),
            periodic: Vec::new(),
            keep_layers: KeepLayers::Auto,
            walls: None,
            target: Target::Equilateral,
        }
    }

    /// Sets an option of a mesh of a size. Returns false if no option of a mesh has the name. Quadrilaterals are read before.
    fn set(&mut self, given: Given<'_, '_>, size: Size) -> PyResult<bool> {
        let Given { name, value } = given;
        let Size { vertices, triangles, elements } = size;
        if let Some(row) = GivenOptions::row(name).filter(|row| row.belongs == Belongs::ToMesh) {
            given.set(row, &mut self.given)?;
            return Ok(true);
        }
        match name {
            "fixed" => self.fixed = arrays::vertex_set(name, value, vertices)?,
            "lines" => self.lines = arrays::pairs(name, value, vertices)?,
            "regions" => self.regions = arrays::labels(name, value, [triangles, elements])?,
            "periodic" => self.periodic = arrays::pairs(name, value, vertices)?,
            "keep_layers" => {
                let words = "\"auto\", \"none\", \"rows=N\" with N from 1 to 1000, or \"within=DISTANCE\", alone or in a \
                     tuple with the vertices of walls";
                let of_walls = value.cast::<PyTuple>().ok().filter(|tuple| tuple.len() == 2);
                let text = match of_walls {
                    Some(pair) => pair.get_item(0)?,
                    None => value.clone(),
                };
                let text = text.extract::<String>().map_err(|_| given.refused(words))?;
                self.keep_layers = text.parse().map_err(|_| given.refused(words))?;
                if let Some(pair) = of_walls {
                    if self.keep_layers == KeepLayers::None {
                        return Err(given.refused(words));
                    }
                    let walls = pair.get_item(1)?;
                    self.walls = Some(arrays::vertex_set("keep_layers[1]", &walls, vertices)?);
                }
            }
            "target" => self.target = target(given, vertices)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Checks the options of the mesh, and the options of a run on the mesh, for contradictions.
    pub(crate) fn check(&self, py: Python<'_>, run: &RunOptions) -> PyResult<()> {
        if !self.periodic.is_empty() && !self.has("slide") {
            let text = "periodic needs slide=True. Drop it, or pass slide=True";
            return Err(error::option(py, text));
        }
        let kind = self.target_kind();
        let is_on_background = matches!(self.target, Target::Background { .. });
        let is_of_places = self.settings().of_places.unwrap_or(is_on_background);
        let features = self.features(kind, is_of_places && kind != TargetKind::Equilateral);
        let checked = self.and(run).check(kind, &features, Spelling::Python);
        checked.map_err(|text| error::option(py, &text))
    }

    /// Returns the surface of the coordinates.
    pub(crate) fn surface(&self) -> Surface {
        self.settings().surface
    }

    /// Returns the meaning of third coordinates.
    pub(crate) fn z(&self) -> ThirdCoordinate {
        match self.settings().z_is_data {
            true => ThirdCoordinate::Data,
            false => ThirdCoordinate::Coordinate,
        }
    }

    /// Returns the kind of the target.
    pub(crate) fn target_kind(&self) -> TargetKind {
        match &self.target {
            Target::Equilateral => TargetKind::Equilateral,
            Target::KeepSize => TargetKind::KeepSize,
            Target::KeepShape => TargetKind::KeepShape,
            Target::Given(values) | Target::Background { values, .. } => match values.each {
                1 => TargetKind::Sizes,
                _ => TargetKind::Tensors,
            },
        }
    }

    /// Returns the targets of a run.
    pub(crate) fn targets(&self) -> Result<TargetRequest, MeshError> {
        let (kind, surface) = (self.target_kind(), self.surface());
        let source = match &self.target {
            Target::Equilateral | Target::KeepSize | Target::KeepShape => TargetSource::Mesh,
            Target::Given(values) => TargetSource::Vertices(values.numbers.clone()),
            Target::Background { points, triangles, values } => {
                let (points, triangles) = (points.xy.clone(), triangles.clone());
                let mesh = Mesh { points, triangles, ..Mesh::default() };
                let field = kind.field(&mesh, &values.numbers, surface)?;
                TargetSource::Background(Box::new(field))
            }
        };
        let Settings { target_rings: rings, of_places, .. } = *self.settings();
        Ok(TargetRequest { kind, source, rings, of_places, surface })
    }
}

/// Reads a target: a word, an array, or a background as a tuple of points, triangles and an array.
fn target(given: Given<'_, '_>, vertices: usize) -> PyResult<Target> {
    let Given { name, value } = given;
    if value.is_instance_of::<PyString>() {
        let words = [("equilateral", 0), ("keep-size", 1), ("keep-shape", 2)];
        return Ok(match given.word(&words)? {
            0 => Target::Equilateral,
            1 => Target::KeepSize,
            _ => Target::KeepShape,
        });
    }
    if let Ok(background) = value.cast::<PyTuple>() {
        let Ok((points, triangles, values)) =
            background.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>)>()
        else {
            return Err(given.refused("a tuple of points, triangles and sizes or tensors"));
        };
        let points = Box::new(arrays::points("target[0]", &points)?);
        let count = points.xy.len();
        let triangles = arrays::triangles("target[1]", &triangles, count)?;
        let values = checked("target[2]", arrays::per_vertex("target[2]", &values, count)?, value)?;
        return Ok(Target::Background { points, triangles, values });
    }
    Ok(Target::Given(checked(name, arrays::per_vertex(name, value, vertices)?, value)?))
}

/// Returns an error unless there is a size or a tensor for each vertex.
fn checked(name: &str, values: PerVertex, value: &Bound<'_, PyAny>) -> PyResult<PerVertex> {
    match values.each {
        1 | 3 => Ok(values),
        each => {
            let text = format!(
                "{name}: the vertices have {each} numbers each, and need 1 (a size) or 3 (a tensor, as xx, xy, yy)"
            );
            Err(error::mesh(value.py(), &text))
        }
    }
}

/// Returns the names of all options of smoothing.
pub(crate) fn all_names() -> Vec<String> {
    [names(), run_options::names()].concat()
}

/// The numbers of vertices, of triangles, and of triangles and quadrilaterals of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct Size {
    pub(crate) vertices: usize,
    pub(crate) triangles: usize,
    pub(crate) elements: usize,
}

/// The options of a call.
pub(crate) struct CallOptions {
    pub(crate) mesh: MeshOptions,
    pub(crate) run: RunOptions,
}

impl CallOptions {
    /// Reads the options of a call for a mesh of a size. `None` is the default of each option.
    pub(crate) fn of_call(
        py: Python<'_>,
        options: Option<&Bound<'_, PyDict>>,
        size: Size,
    ) -> PyResult<Self> {
        let mut all = Self { mesh: MeshOptions::new(), run: RunOptions::default() };
        for (name, value) in options.into_iter().flatten() {
            let name: String = name.extract()?;
            let given = Given { name: &name, value: &value };
            let is_known = match value.is_none() {
                true => all_names().contains(&name),
                false => all.mesh.set(given, size)? || all.run.set(given)?,
            };
            if !is_known {
                return Err(values::unknown(&name, "smoothing", &all_names()));
            }
        }
        all.run.check(py)?;
        all.mesh.check(py, &all.run)?;
        Ok(all)
    }
}
