//! By what measure the worst triangles are improved after a run.

/// The measure of the worst triangles, of which [`Options::improve_worst`](crate::Options::improve_worst) makes the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WorstBy {
    /// The largest inverse mean ratio, as targets show the triangles: as small as can be.
    Imr,
    /// The least angle, as targets show the triangles: as large as can be.
    MinAngle,
    /// The least altitude, in coordinates: as large as can be. It bounds the time step of explicit solvers.
    Altitude,
}

impl WorstBy {
    /// All measures.
    pub const ALL: [Self; 3] = [Self::Imr, Self::MinAngle, Self::Altitude];

    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Imr => "imr",
            Self::MinAngle => "min-angle",
            Self::Altitude => "altitude",
        }
    }
}
