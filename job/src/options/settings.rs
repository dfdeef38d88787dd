//! The values of the options in the table.

use std::time::Duration;

use gpu_smooth::targets::Surface;

use crate::run::{EngineRequest, RunRequest};

/// The values of the options in the table. `None` stands for an option that the user left out, if the option has no value then.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Settings {
    /// The options of a run.
    pub run: RunRequest,
    /// The processor on which the run computes.
    pub engine: EngineRequest,
    /// Text in the name of a GPU adapter.
    pub adapter: Option<String>,
    /// The time after which the run ends.
    pub time_limit: Option<Duration>,
    /// The time between two checkpoints.
    pub checkpoint_every: Option<Duration>,
    /// Whether vertices slide along lines.
    pub slides: bool,
    /// Turn of a line, in degrees, above which a vertex is a corner.
    pub corner_angle: Option<f64>,
    /// Largest distance of the lines from the given lines, in the unit of the mesh.
    pub hausdorff: Option<f64>,
    /// Whether vertices on lines inside of the mesh move freely.
    pub frees_lines: bool,
    /// Inverse mean ratio of bad triangles. Only vertices near bad triangles move.
    pub only_bad: Option<f64>,
    /// Number of rings of triangles around a bad triangle that count as near.
    pub rings: Option<u32>,
    /// Number of rings over which sizes and shapes to keep are averaged.
    pub target_rings: Option<u32>,
    /// Whether targets belong to places, not to vertices.
    pub of_places: Option<bool>,
    /// The surface of the coordinates.
    pub surface: Surface,
    /// Whether third coordinates that differ are data.
    pub z_is_data: bool,
    /// Whether inverted and flat triangles are untangled before the run.
    pub untangles: bool,
}

impl Settings {
    /// Returns the engine. The name of an adapter selects the GPU.
    pub fn engine(&self) -> EngineRequest {
        self.engine.clone().with_adapter(self.adapter.clone())
    }

    /// Returns the number of rings of triangles around a bad triangle that count as near.
    pub fn rings_of_bad(&self) -> u32 {
        self.rings.unwrap_or(2)
    }
}
