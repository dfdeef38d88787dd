//! The options that belong to a mesh: vertices that may move, targets and the surface of coordinates.

use gpu_smooth::layers::KeepLayers;
use gpu_smooth::options::OptionRange;
use gpu_smooth::targets::Surface;
use gpu_smooth::{Mesh, MeshError};
use gpu_smooth_job::{TargetKind, TargetRequest, TargetSource};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};

use crate::arrays::{self, PerVertex, Points};
use crate::error;
use crate::run_options::{self, RunOptions};
use crate::values::{self, Given, ThirdCoordinate};

/// Names of the options of a mesh.
pub(crate) const NAMES: &[&str] = &[
    "fixed",
    "lines",
    "regions",
    "slide",
    "corner_angle",
    "hausdorff",
    "periodic",
    "keep_layers",
    "only_bad",
    "rings",
    "target",
    "target_rings",
    "target_of",
    "surface",
    "z",
    "untangle",
];

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
    /// Vertices that neither move nor slide.
    pub(crate) fixed: Vec<u32>,
    /// Edges whose vertices stay, or slide along the edges.
    pub(crate) lines: Vec<[u32; 2]>,
    /// Region of each triangle; empty without regions.
    pub(crate) regions: Vec<i64>,
    pub(crate) slides: bool,
    pub(crate) corner_angle: Option<f64>,
    pub(crate) hausdorff: Option<f64>,
    /// Pairs of vertices that slide together.
    pub(crate) periodic: Vec<[u32; 2]>,
    /// Boundary layers that stay.
    pub(crate) keep_layers: KeepLayers,
    /// Vertices of the walls of these layers; `None` for all walls.
    pub(crate) walls: Option<Vec<u32>>,
    /// Inverse mean ratio of bad triangles; only vertices near bad triangles move.
    pub(crate) only_bad: Option<f64>,
    pub(crate) rings: Option<u32>,
    pub(crate) target: Target,
    pub(crate) target_rings: Option<u32>,
    /// Whether targets belong to places.
    pub(crate) of_places: Option<bool>,
    /// Surface of the coordinates; `None` if the caller does not name it.
    pub(crate) surface: Option<Surface>,
    /// Meaning of third coordinates.
    pub(crate) z: ThirdCoordinate,
    pub(crate) untangles: bool,
}

impl MeshOptions {
    fn new() -> Self {
        Self {
            fixed: Vec::new(),
            lines: Vec::new(),
            regions: Vec::new(),
            slides: false,
            corner_angle: None,
            hausdorff: None,
            periodic: Vec::new(),
            keep_layers: KeepLayers::Auto,
            walls: None,
            only_bad: None,
            rings: None,
            target: Target::Equilateral,
            target_rings: None,
            of_places: None,
            surface: None,
            z: ThirdCoordinate::Coordinate,
            untangles: false,
        }
    }

    /// Sets an option of a mesh with `size` vertices and triangles. Returns false if no option of a mesh has the name.
    fn set(&mut self, given: Given<'_, '_>, size: [usize; 2]) -> PyResult<bool> {
        let Given { name, value } = given;
        let [vertices, triangles] = size;
        match name {
            "fixed" => self.fixed = arrays::vertex_set(name, value, vertices)?,
            "lines" => self.lines = arrays::pairs(name, value, vertices)?,
            "regions" => self.regions = arrays::labels(name, value, triangles)?,
            "slide" => self.slides = given.flag()?,
            "corner_angle" => self.corner_angle = Some(given.number(OptionRange::CORNER_ANGLE)?),
            "hausdorff" => self.hausdorff = Some(given.number(OptionRange::HAUSDORFF)?),
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
            "only_bad" => {
                let is_ratio = |ratio: f64| ratio >= 1.0 && ratio.is_finite();
                self.only_bad =
                    Some(given.number_in("an inverse mean ratio, 1 or above", is_ratio)?);
            }
            "rings" => self.rings = Some(given.count(0, u32::MAX)?),
            "target" => self.target = target(given, vertices)?,
            "target_rings" => self.target_rings = Some(given.count(0, 1000)?),
            "target_of" => {
                self.of_places = Some(given.word(&[("vertex", false), ("place", true)])?)
            }
            "surface" => {
                let surfaces = [("plane", Surface::Plane), ("sphere", Surface::Sphere)];
                self.surface = Some(given.word(&surfaces)?);
            }
            "z" => self.z = given.third_coordinate()?,
            "untangle" => self.untangles = given.flag()?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Checks for options that need another option.
    fn check(&self, py: Python<'_>) -> PyResult<()> {
        let has_slide_option =
            self.corner_angle.is_some() || self.hausdorff.is_some() || !self.periodic.is_empty();
        let refusals = [
            (
                has_slide_option && !self.slides,
                "corner_angle, hausdorff and periodic need slide=True. Drop them, or pass it",
            ),
            (
                self.rings.is_some() && self.only_bad.is_none(),
                "rings needs only_bad. Drop it, or pass it",
            ),
            (
                self.target_rings.is_some() && !self.target_kind().keeps(),
                "target_rings needs target=\"keep-size\" or \"keep-shape\". Drop it, or pass one of them",
            ),
            (
                self.of_places == Some(true) && matches!(self.target, Target::Equilateral),
                "target_of needs a target. Drop it, or pass one",
            ),
        ];
        match refusals.iter().find(|(is_refused, _)| *is_refused) {
            Some((_, text)) => Err(error::option(py, text)),
            None => Ok(()),
        }
    }

    /// Returns the surface of the coordinates.
    pub(crate) fn surface(&self) -> Surface {
        self.surface.unwrap_or(Surface::Plane)
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
                let mesh = Mesh { points, triangles, fixed: vec![] };
                let field = kind.field(&mesh, &values.numbers, surface)?;
                TargetSource::Background(Box::new(field))
            }
        };
        let (rings, of_places) = (self.target_rings, self.of_places);
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

/// The options of a call.
pub(crate) struct CallOptions {
    pub(crate) mesh: MeshOptions,
    pub(crate) run: RunOptions,
}

impl CallOptions {
    /// Reads the options of a call for a mesh with `size` vertices and triangles. `None` is the default of each option.
    pub(crate) fn of_call(
        py: Python<'_>,
        options: Option<&Bound<'_, PyDict>>,
        size: [usize; 2],
    ) -> PyResult<Self> {
        let mut all = Self { mesh: MeshOptions::new(), run: RunOptions::default() };
        for (name, value) in options.into_iter().flatten() {
            let name: String = name.extract()?;
            let given = Given { name: &name, value: &value };
            let is_known = match value.is_none() {
                true => NAMES.contains(&&*name) || run_options::NAMES.contains(&&*name),
                false => all.mesh.set(given, size)? || all.run.set(given)?,
            };
            if !is_known {
                let names: Vec<&str> = NAMES.iter().chain(run_options::NAMES).copied().collect();
                return Err(values::unknown(py, &name, "smoothing", &names));
            }
        }
        all.mesh.check(py)?;
        all.run.check(py)?;
        Ok(all)
    }
}
