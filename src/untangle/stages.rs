//! What untangling tries, in which order, and for how long.

use crate::untangle::cuts::Short;
use crate::untangle::state::Assessment;

/// What is done in turn until the mesh is untangled. Cuts by each rule untangle some meshes that the other rules do not.
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

/// Sweeps from one start.
pub(super) struct Stage {
    pub(super) start: Start,
    /// The number of sweeps; see [`Stage::patience`].
    sweeps: u32,
}

/// Where vertices are when a stage begins, and which of them move.
pub(super) enum Start {
    /// Those move that are within so many edges of bad triangles, from where they are.
    Near(u32),
    /// All move, from the means of their neighbors.
    Means,
    /// All move, from their means within the pieces into which the mesh is [cut](super::cuts).
    Cut(Short),
    /// All move, from the positions at the end of a stage after a cut: that which came nearest to the goal, each once.
    Nearest,
}

/// How long a stage goes on.
pub(super) struct Patience {
    /// The number of sweeps from which on the stage ends when sweeps have gained too little.
    pub(super) fewest: u32,
    /// The number of sweeps at which the stage ends.
    pub(super) most: u32,
    /// The gain is judged each time so many sweeps are done.
    pub(super) often: u32,
    /// It is enough if the most inverted triangle has at most this share of the inverted area that it had,
    area: f64,
    /// or if at most this share of the bad triangles is left.
    bad: f64,
}

impl Stage {
    /// After a cut, sweeps go on beyond their number while the mesh gets nearer quickly. From the nearest state they go on
    /// while it gets nearer at all, up to their number: large meshes take hundreds of sweeps.
    pub(super) fn patience(&self) -> Patience {
        let sweeps = self.sweeps;
        match self.start {
            Start::Near(_) | Start::Means => {
                Patience { fewest: sweeps, most: sweeps, often: sweeps, area: 0.0, bad: 0.0 }
            }
            Start::Cut(_) => {
                Patience { fewest: sweeps, most: 4 * sweeps, often: 50, area: 0.5, bad: 0.0 }
            }
            Start::Nearest => {
                Patience { fewest: 0, most: sweeps, often: 100, area: 0.75, bad: 0.9 }
            }
        }
    }
}

impl Patience {
    /// Whether sweeps have gained enough to go on. Where no triangle is inverted, but some wind twice around a vertex, there is
    /// nothing to gain.
    pub(super) fn goes_on(&self, before: Assessment, now: Assessment) -> bool {
        let nearer = now.least >= self.area * before.least;
        now.bad > 0 && (nearer || now.bad as f64 <= self.bad * before.bad as f64)
    }
}
