//! The measure by which the worst triangles are improved after a run.

/// The measure of the worst triangles that [`Options::improve_worst`](crate::Options::improve_worst) improves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WorstBy {
    /// The largest inverse mean ratio, after target maps are applied; it is made as small as possible.
    Imr,
    /// The least angle, after target maps are applied; it is made as large as possible.
    MinAngle,
    /// The least altitude, in coordinates; it is made as large as possible. It bounds the time step of explicit
    /// solvers.
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
