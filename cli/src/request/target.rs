//! Requests for the targets of elements, and for the surface on which coordinates lie.

use std::path::{Path, PathBuf};

use gpu_smooth::targets::Surface;
use gpu_smooth_job::TargetKind;
use gpu_smooth_job::options::Settings;

use crate::args::{Target, TargetArgs};

/// Whether third coordinates that differ are coordinates or data.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ThirdCoordinate {
    /// A mesh must lie in a plane, in which it is smoothed.
    Coordinate,
    /// A mesh is smoothed in x and y.
    Data,
    /// Data, unless the file has other data with the name z.
    NamedData,
}

impl ThirdCoordinate {
    /// Returns the meaning of z: data by `--z data` and on a sphere, and data with the name z if `--interpolate` names z.
    pub(crate) fn of(settings: &Settings, interpolated: &[String]) -> Self {
        let mut names = interpolated.iter().flat_map(|names| names.split(','));
        let is_interpolated = names.any(|name| name.trim() == "z");
        match settings.z_is_data || settings.surface == Surface::Sphere {
            true => Self::Data,
            false if is_interpolated => Self::NamedData,
            false => Self::Coordinate,
        }
    }
}

/// The desired shape and size of elements.
pub(crate) struct TargetRequest {
    pub(crate) kind: TargetKind,
    /// The number of rings of neighbors over which kept sizes and shapes are averaged; `None` for the usual number.
    pub(crate) rings: Option<u32>,
    /// Whether targets belong to places; `None` for the usual owner.
    pub(crate) of_places: Option<bool>,
    /// The source of sizes or tensors; `None` for other targets.
    pub(crate) given: Option<GivenTargets>,
}

/// The source of given sizes or tensors.
pub(crate) struct GivenTargets {
    /// The text after `size=` or `metric=` on the command line.
    pub(crate) text: String,
    pub(crate) source: TargetSource,
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

impl TargetRequest {
    /// Returns the request of the options.
    pub(crate) fn of(args: &TargetArgs, settings: &Settings) -> Self {
        let given = args.source();
        let given = given
            .map(|text| GivenTargets { text: text.to_owned(), source: TargetSource::of(text) });
        let (rings, of_places) = (settings.target_rings, settings.of_places);
        Self { kind: args.kind(), rings, of_places, given }
    }

    /// Returns whether targets belong to places, and are evaluated again at the new positions of vertices. By default, targets
    /// on a background mesh or view do.
    pub(crate) fn is_of_places(&self) -> bool {
        let is_of_mesh = |given: &GivenTargets| matches!(given.source, TargetSource::OfMesh(_));
        let is_on_background = self.given.as_ref().is_some_and(|given| !is_of_mesh(given));
        self.kind != TargetKind::Equilateral && self.of_places.unwrap_or(is_on_background)
    }

    /// Returns the number of rings of neighbors over which sizes or shapes are averaged; `None` if the target keeps neither.
    pub(crate) fn rings(&self) -> Option<u32> {
        self.kind.keeps().then(|| self.rings.unwrap_or(self.kind.default_rings()))
    }

    /// Returns the value of `--target` on the command line.
    pub(crate) fn name(&self) -> String {
        match &self.given {
            Some(GivenTargets { text, .. }) => format!("{}={text}", self.kind.name()),
            None => self.kind.name().to_owned(),
        }
    }

    /// Returns the existing files from which targets are read.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let Some(GivenTargets { source, .. }) = &self.given else { return Vec::new() };
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
    /// Returns the kind of the target.
    pub(crate) fn kind(&self) -> TargetKind {
        match self.target {
            Target::Equilateral => TargetKind::Equilateral,
            Target::KeepSize => TargetKind::KeepSize,
            Target::KeepShape => TargetKind::KeepShape,
            Target::Size { .. } => TargetKind::Sizes,
            Target::Metric { .. } => TargetKind::Tensors,
        }
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
}
