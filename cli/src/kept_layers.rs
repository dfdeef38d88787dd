//! The value of `--keep-layers`.

use gpu_smooth::layers::KeepLayers;

/// Boundary layers that stay, as `--keep-layers` names them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KeptLayers {
    pub(crate) keep: KeepLayers,
    /// Names or tags of the groups of walls, with commas between them; `None` for all walls.
    pub(crate) groups: Option<String>,
}
