//! Requests for the targets of elements, and for the surface on which coordinates lie.

use std::path::{Path, PathBuf};

use gpu_smooth::{Metric, targets::Surface};

use crate::args::{Owner, SurfaceArg, SurfaceArgs, Target, TargetArgs, ZArg};

impl From<&SurfaceArgs> for Surface {
    fn from(args: &SurfaceArgs) -> Self {
        match args.surface {
            SurfaceArg::Plane => Surface::Plane,
            SurfaceArg::Sphere => Surface::Sphere,
        }
    }
}

/// Whether third coordinates that differ are coordinates or data.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ThirdCoordinate {
    /// A mesh must lie in a plane, in which it is smoothed.
    Coordinate,
    /// A mesh is smoothed in x and y.
    Data,
}

impl ThirdCoordinate {
    /// Returns the meaning of z: data by `--z data`, if `--interpolate` names z, and on a sphere.
    pub(crate) fn of(args: &SurfaceArgs, interpolated: &[String]) -> Self {
        let mut names = interpolated.iter().flat_map(|names| names.split(','));
        let is_interpolated = names.any(|name| name.trim() == "z");
        match args.z == ZArg::Data || args.surface == SurfaceArg::Sphere || is_interpolated {
            true => Self::Data,
            false => Self::Coordinate,
        }
    }
}

/// The desired shape and size of elements.
pub(crate) enum TargetRequest {
    Equilateral,
    /// The present sizes, or sizes and shapes, of the elements of the mesh.
    Keep {
        what: ElementProperty,
        /// The number of rings of neighbors over which sizes and shapes are averaged.
        rings: u32,
        is_of_places: bool,
    },
    /// Sizes or tensors of a file or of point data.
    Given {
        what: TargetNumbers,
        /// The text after `size=` or `metric=` on the command line.
        text: String,
        source: TargetSource,
        is_of_places: bool,
    },
}

/// A property of the elements of a mesh that a target keeps.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ElementProperty {
    Size,
    Shape,
}

/// The quantity given for each vertex by the source of a target.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum TargetNumbers {
    /// One length for each vertex.
    Sizes,
    /// A symmetric tensor for each vertex: xx, xy, yy.
    Tensors,
}

/// The location of the numbers of targets.
pub(crate) enum TargetSource {
    /// A file with numbers for each vertex of the mesh, or point data of the mesh.
    OfMesh(String),
    /// A background mesh, with the name of its point data or a file with numbers for each of its vertices.
    Background { mesh: PathBuf, data: String },
    /// A view of gmsh: triangles with a size at each corner.
    View(PathBuf),
}

impl From<&TargetArgs> for TargetRequest {
    fn from(args: &TargetArgs) -> Self {
        let is_of_places = args.is_of_places();
        let keep = |what| Self::Keep { what, rings: args.rings_of(what), is_of_places };
        let given = |what, text: &String| {
            let (text, source) = (text.clone(), TargetSource::of(text));
            Self::Given { what, text, source, is_of_places }
        };
        match &args.target {
            Target::Equilateral => Self::Equilateral,
            Target::KeepSize => keep(ElementProperty::Size),
            Target::KeepShape => keep(ElementProperty::Shape),
            Target::Size { source } => given(TargetNumbers::Sizes, source),
            Target::Metric { source } => given(TargetNumbers::Tensors, source),
        }
    }
}

impl TargetRequest {
    /// Returns whether targets belong to places, and are evaluated again at the new positions of vertices.
    pub(crate) fn is_of_places(&self) -> bool {
        match self {
            Self::Equilateral => false,
            Self::Keep { is_of_places, .. } | Self::Given { is_of_places, .. } => *is_of_places,
        }
    }

    /// Returns the value of `--target` on the command line.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Equilateral => "equilateral".to_owned(),
            Self::Keep { what: ElementProperty::Size, .. } => "keep-size".to_owned(),
            Self::Keep { what: ElementProperty::Shape, .. } => "keep-shape".to_owned(),
            Self::Given { what: TargetNumbers::Sizes, text, .. } => format!("size={text}"),
            Self::Given { what: TargetNumbers::Tensors, text, .. } => format!("metric={text}"),
        }
    }

    /// Returns the existing files from which targets are read.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let Self::Given { source, .. } = self else { return Vec::new() };
        let files = match source {
            TargetSource::OfMesh(name) => vec![PathBuf::from(name)],
            TargetSource::Background { mesh, data } => vec![mesh.clone(), PathBuf::from(data)],
            TargetSource::View(path) => vec![path.clone()],
        };
        files.into_iter().filter(|file| file.is_file()).collect()
    }
}

impl TargetSource {
    /// Parses SOURCE of `--target`. An existing file with a colon in its name takes precedence over
    /// BACKGROUND:DATA.
    fn of(text: &str) -> Self {
        let path = Path::new(text);
        if is_view(path) {
            return Self::View(path.to_owned());
        }
        let own = || Self::OfMesh(text.to_owned());
        let Some((mesh, data)) = text.rsplit_once(':') else { return own() };
        let is_file = path.exists() || data.is_empty();
        match !is_file && Path::new(mesh).exists() {
            true => Self::Background { mesh: mesh.into(), data: data.to_owned() },
            false => own(),
        }
    }
}

/// Whether a path is an existing `.pos` file, a view of gmsh.
fn is_view(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("pos")) && path.exists()
}

impl TargetArgs {
    /// Returns the metric of a run without `--scheme`.
    pub(crate) fn default_metric(&self) -> Metric {
        match self.target {
            Target::KeepSize => Metric::Tmop94,
            Target::Size { .. } => Metric::SoftSize,
            Target::Equilateral | Target::KeepShape | Target::Metric { .. } => Metric::Imr,
        }
    }

    /// Returns the number of rings of neighbors over which a kept property is averaged.
    fn rings_of(&self, what: ElementProperty) -> u32 {
        self.target_rings.unwrap_or(match what {
            ElementProperty::Size => 0,
            ElementProperty::Shape => 1,
        })
    }

    /// Returns whether the target has sizes but no shapes. A metric that sees no sizes would ignore such a
    /// target.
    pub(crate) fn is_of_sizes(&self) -> bool {
        matches!(self.target, Target::KeepSize | Target::Size { .. })
    }

    /// Returns the text after `size=` or `metric=`; `None` for other targets.
    pub(crate) fn source(&self) -> Option<&str> {
        match &self.target {
            Target::Size { source } | Target::Metric { source } => Some(source),
            Target::Equilateral | Target::KeepSize | Target::KeepShape => None,
        }
    }

    /// Returns whether the source is an existing view of gmsh.
    pub(crate) fn has_view(&self) -> bool {
        self.source().is_some_and(|source| is_view(Path::new(source)))
    }

    /// Returns whether targets belong to places instead of vertices. By default, targets on a background
    /// mesh or view do.
    pub(crate) fn is_of_places(&self) -> bool {
        let is_on_background = self
            .source()
            .is_some_and(|source| !matches!(TargetSource::of(source), TargetSource::OfMesh(_)));
        let default = if is_on_background { Owner::Place } else { Owner::Vertex };
        self.target != Target::Equilateral && self.target_of.unwrap_or(default) == Owner::Place
    }

    /// Returns whether the target keeps sizes or shapes of the mesh itself.
    pub(crate) fn keeps(&self) -> bool {
        matches!(self.target, Target::KeepSize | Target::KeepShape)
    }
}
