//! Measures by which a run improves the worst triangles.

/// Measure of the worst triangles that [`Options::improve_worst`](crate::Options::improve_worst) improves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WorstBy {
    /// Largest inverse mean ratio, after target maps are applied; minimized.
    Imr,
    /// Least angle, after target maps are applied; maximized. Angles above 90 degrees become more, so the measure is not
    /// for solvers that need orthogonal meshes.
    MinAngle,
    /// Least altitude, in coordinates; maximized. The least altitude bounds the time step of explicit solvers.
    Altitude,
}

impl WorstBy {
    /// All measures, in the order of the variants.
    pub const ALL: [Self; 3] = [Self::Imr, Self::MinAngle, Self::Altitude];

    /// Returns the name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Imr => "imr",
            Self::MinAngle => "min-angle",
            Self::Altitude => "altitude",
        }
    }
}
