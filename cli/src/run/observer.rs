//! A trait to be told of each step in the life of a mesh, from reading to writing.

use crate::error::CliError;
use crate::load::LoadedMesh;
use gpu_smooth::Progress;

use crate::terminal::progress::Stage;

/// Is told how far a mesh is on its way from file to file.
pub(crate) trait Follow: Send {
    /// Is told that a stage begins.
    fn stage(&mut self, stage: Stage);
    /// Is told that the mesh has been read. An error ends the run before any work is done.
    fn has_read(&mut self, file: &LoadedMesh) -> Result<(), CliError>;
    /// Takes a remark on the mesh for the user.
    fn remark(&mut self, text: &str);
    /// Is told that sweeps were done.
    fn sweep(&mut self, progress: &Progress);
    /// Is told that the sweeps are over. An error keeps the mesh from being written.
    fn has_smoothed(&mut self) -> Result<(), CliError>;
}
