//! Who follows a mesh through its run.

use gpu_smooth::{MeshFile, Progress};

use crate::progress::Stage;

/// Who follows a mesh through its run.
pub(crate) trait Follow {
    /// A stage of the run begins.
    fn stage(&mut self, stage: Stage);
    /// The mesh has been read. An error ends the run before any work is done.
    fn has_read(&mut self, file: &MeshFile) -> Result<(), String>;
    /// Something about the mesh is worth telling.
    fn remark(&mut self, text: &str);
    /// Some sweeps were done.
    fn sweep(&mut self, progress: &Progress);
    /// The sweeps are over. An error leaves the mesh as it was.
    fn has_smoothed(&mut self) -> Result<(), String>;
}
