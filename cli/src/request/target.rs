//! The meaning of the options on targets and surfaces.

use std::path::{Path, PathBuf};

use gpu_smooth::{Metric, Surface};

use crate::args::{OnSurface, Owner, SurfaceArgs, Target, TargetArgs};

impl SurfaceArgs {
    /// Returns what the coordinates are.
    pub(crate) fn surface(&self) -> Surface {
        match self.surface {
            OnSurface::Plane => Surface::Plane,
            OnSurface::Sphere => Surface::Sphere,
        }
    }

    /// Returns the name on the command line.
    pub(crate) fn name(&self) -> &'static str {
        match self.surface {
            OnSurface::Plane => "plane",
            OnSurface::Sphere => "sphere",
        }
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
    pub(crate) fn keeps(&self) -> bool {
        matches!(self.target, Target::KeepSize | Target::KeepShape)
    }

    pub(crate) fn rings(&self) -> u32 {
        self.target_rings.unwrap_or(2)
    }

    /// Whether targets belong to places, not to vertices.
    pub(crate) fn is_of_places(&self) -> bool {
        let is_uniform = matches!(self.target, Target::Equilateral);
        let default = if self.background().is_some() { Owner::Place } else { Owner::Vertex };
        !is_uniform && self.target_of.unwrap_or(default) == Owner::Place
    }

    /// Returns the source of sizes or tensors, if there is one.
    pub(crate) fn source(&self) -> Option<&str> {
        match &self.target {
            Target::Size { source } | Target::Metric { source } => Some(source),
            Target::Equilateral | Target::KeepSize | Target::KeepShape => None,
        }
    }

    /// Returns the files that targets are read from, as far as they exist.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let files = match (self.background(), self.source()) {
            (Some((mesh, data)), _) => vec![mesh, Path::new(data)],
            (None, Some(source)) => vec![Path::new(source)],
            (None, None) => Vec::new(),
        };
        files.into_iter().filter(|file| file.is_file()).map(Path::to_path_buf).collect()
    }

    /// Whether the source is a view of gmsh.
    pub(crate) fn has_view(&self) -> bool {
        self.source().is_some_and(is_view)
    }

    /// Returns the background mesh and the name of its data, if the target is given on one. The name is empty for a
    /// view of gmsh.
    pub(crate) fn background(&self) -> Option<(&Path, &str)> {
        let source = self.source()?;
        if is_view(source) {
            return Some((Path::new(source), ""));
        }
        let (mesh, data) = source.rsplit_once(':')?;
        let is_file = Path::new(source).exists() || data.is_empty();
        (!is_file && Path::new(mesh).exists()).then_some((Path::new(mesh), data))
    }
}

/// Whether a source is an existing `.pos` file, a view of gmsh.
fn is_view(source: &str) -> bool {
    let path = Path::new(source);
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("pos")) && path.exists()
}
