//! The sequence of starts of untangling: positions, moving vertices, and number of sweeps.

use crate::untangle::cuts::Short;
use crate::untangle::state::Assessment;

/// Starts in the order of trials, until the mesh is untangled. Cuts by each rule untangle some meshes that cuts by the
/// other rules leave tangled.
pub(super) const STAGES: [Stage; 19] = [
    Stage { start: Start::Near(2), sweeps: 10 },
    Stage { start: Start::Near(6), sweeps: 20 },
    Stage { start: Start::Means, sweeps: 10 },
    Stage { start: Start::Cut(Short::Line), sweeps: 50 },
    Stage { start: Start::Cut(Short::Both), sweeps: 100 },
    Stage { start: Start::Cut(Short::Path), sweeps: 150 },
    Stage { start: Start::Nearest, sweeps: 1000 },
    Stage { start: Start::Cut(Short::ByChance(1)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(2)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(3)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(4)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(5)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(6)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(7)), sweeps: 100 },
    Stage { start: Start::Cut(Short::ByChance(8)), sweeps: 100 },
    Stage { start: Start::Nearest, sweeps: 1000 },
    Stage { start: Start::Nearest, sweeps: 1000 },
    Stage { start: Start::Nearest, sweeps: 1000 },
    Stage { start: Start::Means, sweeps: 100 },
];

/// Runs of [Newton](super::newton) steps, which follow the last stage. Each run begins at the positions of the given mesh.
/// Equal target areas lead to other states than areas of triangles, many of which are inverted. Another residual leads to
/// other states too.
pub(super) const DESCENTS: [Descent; 3] = [
    Descent { has_equal_targets: false, residual: 0.5 },
    Descent { has_equal_targets: true, residual: 0.1 },
    Descent { has_equal_targets: false, residual: 0.3 },
];

/// The settings of a run of Newton steps.
pub(super) struct Descent {
    /// Whether all target areas are equal.
    pub(super) has_equal_targets: bool,
    /// Share of the residual (0 to 1) at which conjugate gradients end.
    pub(super) residual: f64,
}

/// The budget of each run of Newton steps.
pub(super) const NEWTON: StageBudget =
    StageBudget { fewest: 0, most: 5000, often: 1000, area: 0.75, bad: 0.9 };

/// Sweeps from one start.
pub(super) struct Stage {
    pub(super) start: Start,
    /// Number of sweeps of the stage; see [`Stage::patience`].
    sweeps: u32,
}

/// The positions of the vertices when a stage begins, and the vertices that the stage moves.
pub(super) enum Start {
    /// Present positions. Only free vertices within the given number of edges of bad triangles move.
    Near(u32),
    /// Means of neighbors. All free vertices move.
    Means,
    /// Means of neighbors within the pieces into which the mesh is [cut](super::cuts). All free vertices move.
    Cut(Short),
    /// The result of an earlier stage after a cut, with the smallest inverted area. All free vertices move. Each result
    /// is a start only once.
    Nearest,
}

/// The conditions that end the sweeps of a stage.
pub(super) struct StageBudget {
    /// Number of sweeps from which on an insufficient gain ends the stage.
    pub(super) fewest: u32,
    /// Largest number of sweeps of the stage.
    pub(super) most: u32,
    /// Number of sweeps between two judgments of the gain.
    pub(super) often: u32,
    /// Share of the former inverted area (0 to 1) to which the most inverted triangle must shrink for a sufficient
    /// gain.
    area: f64,
    /// Share of the former bad triangles (0 to 1) that may be left for a sufficient gain, as an alternative to `area`.
    bad: f64,
}

impl Stage {
    /// Returns the conditions that end the stage. After a cut, sweeps continue up to fourfold, while 50 sweeps halve
    /// the inverted area of the most inverted triangle. From the nearest result, up to 1,000 sweeps follow, while 100
    /// sweeps lower the inverted area by a quarter or the bad triangles by a tenth. Large meshes take hundreds of
    /// sweeps.
    pub(super) fn patience(&self) -> StageBudget {
        let sweeps = self.sweeps;
        match self.start {
            Start::Near(_) | Start::Means => {
                StageBudget { fewest: sweeps, most: sweeps, often: sweeps, area: 0.0, bad: 0.0 }
            }
            Start::Cut(_) => {
                StageBudget { fewest: sweeps, most: 4 * sweeps, often: 50, area: 0.5, bad: 0.0 }
            }
            Start::Nearest => {
                StageBudget { fewest: 0, most: sweeps, often: 100, area: 0.75, bad: 0.9 }
            }
        }
    }
}

impl StageBudget {
    /// Returns whether sweeps have gained enough to continue. Sweeps cannot improve a mesh in which no triangle is
    /// inverted but some triangles wind twice around a vertex.
    pub(super) fn goes_on(&self, before: Assessment, now: Assessment) -> bool {
        let nearer = now.least >= self.area * before.least;
        now.bad > 0 && (nearer || now.bad as f64 <= self.bad * before.bad as f64)
    }
}
