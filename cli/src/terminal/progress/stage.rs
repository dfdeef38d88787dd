//! The stages of a run.

/// A stage of a run, as it is named to the user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stage {
    /// A file of so many bytes is read; 0 if that is not known.
    Reading { bytes: u64 },
    /// A mesh of so many vertices is made ready.
    Preparing { vertices: usize },
    /// Inverted triangles are turned back.
    Untangling,
    /// Sweeps are done.
    Smoothing,
    /// A file of about so many bytes is written.
    Writing { bytes: u64 },
}

impl Stage {
    /// Returns the name in one word.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Reading { .. } => "reading",
            Self::Preparing { .. } => "preparing",
            Self::Untangling => "untangling",
            Self::Smoothing => "smoothing",
            Self::Writing { .. } => "writing",
        }
    }

    /// Returns the name with the size of the file or mesh.
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
