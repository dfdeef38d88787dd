//! Requests for the movement of vertices: selection, sliding, and interpolated data.

use std::path::PathBuf;

use gpu_smooth::layers::KeepLayers;
use gpu_smooth_job::SlideBy;
use gpu_smooth_job::options::Settings;

use crate::args::{FieldArgs, MoveArgs, SideArgs};
use crate::kept_layers::KeptLayers;

/// The selection of vertices that may move. By default, vertices on constraints and between regions are fixed.
pub(crate) struct MovableRequest {
    /// Whether vertices between regions may move.
    pub(crate) free_interfaces: bool,
    /// Whether vertices on lines inside of the mesh may move.
    pub(crate) free_lines: bool,
    /// Names or tags of groups whose vertices stay, several with commas between them.
    pub(crate) fix: Vec<String>,
    /// Files that list vertices which stay.
    pub(crate) fix_vertices: Vec<PathBuf>,
    /// Names of point data; vertices stay where a value is not 0.
    pub(crate) fix_array: Vec<String>,
    /// Opposite corners of boxes whose vertices stay.
    pub(crate) fix_box: Vec<[[f64; 2]; 2]>,
    /// Names or tags of groups; only vertices whose triangles all belong to them may move. Empty for no such limit.
    pub(crate) only: Vec<String>,
    /// Only vertices near bad triangles may move; `None` for no such limit.
    pub(crate) near_bad: Option<NearBad>,
    /// Boundary layers that stay; `None` for no layer.
    pub(crate) keep_layers: Option<KeptLayers>,
}

/// The neighborhood of bad triangles.
#[derive(Clone, Copy)]
pub(crate) struct NearBad {
    /// Triangles with an inverse mean ratio above this are bad.
    pub(crate) above: f64,
    /// Number of rings of triangles, around a bad triangle, that count as near.
    pub(crate) rings: u32,
}

impl MovableRequest {
    /// Returns the request of the options.
    pub(crate) fn of(args: MoveArgs, settings: &Settings) -> Self {
        let rings = settings.rings_of_bad();
        let free_lines = settings.frees_lines;
        let near_bad = settings.only_bad.map(|above| NearBad { above, rings });
        let MoveArgs { free_interfaces, fix, fix_vertices, fix_array, fix_box, .. } = args;
        let MoveArgs { only, keep_layers, .. } = args;
        Self {
            free_interfaces,
            free_lines,
            fix,
            fix_vertices,
            fix_array,
            fix_box,
            only,
            near_bad,
            keep_layers,
        }
    }

    /// Keeps boundary layers that are found, unless an option says otherwise.
    pub(crate) fn keeping_layers(self) -> Self {
        let found = || KeptLayers { keep: KeepLayers::Auto, groups: None };
        Self { keep_layers: self.keep_layers.or_else(|| Some(found())), ..self }
    }
}

/// Options of vertices that slide along lines.
pub(crate) struct SlideRequest {
    /// The smallest turn of a line, in degrees, at a corner. Vertices at corners are fixed.
    pub(crate) corner_angle: f64,
    /// Largest distance of lines from those of the mesh before the run, in the unit of the mesh. `None` stands for
    /// a tenth of the local edge length.
    pub(crate) hausdorff: Option<f64>,
    /// Pairs of groups whose vertices slide together.
    pub(crate) periodic: Vec<[String; 2]>,
}

impl SlideRequest {
    /// Returns the request of the options; `None` without `--slide`.
    pub(crate) fn of(args: SideArgs, settings: &Settings) -> Option<Self> {
        let corner_angle = settings.corner_angle.unwrap_or(SlideBy::default().corner_angle);
        let hausdorff = settings.hausdorff;
        settings.slides.then_some(Self { corner_angle, hausdorff, periodic: args.periodic })
    }
}

/// The data of vertices to interpolate at the new positions.
pub(crate) struct FieldsRequest {
    /// Names of data, several with commas between them, or `all`. Empty for none.
    pub(crate) names: Vec<String>,
}

impl From<FieldArgs> for FieldsRequest {
    fn from(args: FieldArgs) -> Self {
        Self { names: args.interpolate }
    }
}
