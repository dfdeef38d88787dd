//! The stages of a run, as progress displays name them.

/// A stage of a run, as progress displays name it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stage {
    /// Reading a file of `bytes` bytes; 0 if the size is unknown.
    Reading { bytes: u64 },
    /// Preparing a mesh of `vertices` vertices for sweeps.
    Preparing { vertices: usize },
    /// Untangling: turning inverted triangles back.
    Untangling,
    /// Sweeps.
    Smoothing,
    /// Writing a file of approximately `bytes` bytes.
    Writing { bytes: u64 },
    /// Drawing pictures and pages of a mesh. `triangles` counts each triangle once for each drawing.
    Drawing { triangles: usize },
}

impl Stage {
    /// Returns the name of the stage, one word.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Reading { .. } => "reading",
            Self::Preparing { .. } => "preparing",
            Self::Untangling => "untangling",
            Self::Smoothing => "smoothing",
            Self::Writing { .. } => "writing",
            Self::Drawing { .. } => "drawing",
        }
    }

    /// Returns the name of the stage with the size of the file or mesh.
    pub(crate) fn text(self) -> String {
        match self {
            Self::Reading { bytes } | Self::Writing { bytes } if bytes >= 1 << 20 => {
                format!("{} {} MB", self.name(), bytes >> 20)
            }
            Self::Preparing { vertices } => format!("preparing {vertices} vertices"),
            _ => self.name().to_owned(),
        }
    }
}
