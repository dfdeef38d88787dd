//! Observation of a mesh's pipeline from reading to writing.

use crate::error::CliError;
use crate::load::LoadedMesh;
use gpu_smooth::Progress;
use mesh_io::Conversion;

use crate::terminal::progress::Stage;

/// Observer of the pipeline of one mesh. An error from `has_read` or `has_smoothed` stops the
/// pipeline before the next stage.
pub(crate) trait PipelineObserver: Send {
    /// Called at the start of each stage.
    fn stage(&mut self, stage: Stage);
    /// Called after the mesh has been read. `conversion` is the conversion by which the mesh will be written; `None` for a
    /// rewrite of its file. An error stops the pipeline before any work.
    fn has_read(
        &mut self,
        file: &LoadedMesh,
        conversion: Option<&Conversion>,
    ) -> Result<(), CliError>;
    /// Receives a remark on the mesh, to be shown to the user.
    fn remark(&mut self, text: &str);
    /// Receives the progress after each sweep or batch of sweeps.
    fn sweep(&mut self, progress: &Progress);
    /// Called after the last sweep. An error prevents the mesh from being written.
    fn has_smoothed(&mut self) -> Result<(), CliError>;
}
