//! The course of a run: in one attempt, or in rounds between which vertices slide, are held, or get targets at their
//! new positions.

use glam::DVec2;

use crate::error::{MeshError, SmoothError};
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::outcome::Slid;
use crate::run::{Checkpoint, Keeper, Keeping, Observer, Options};
use crate::topology::Topology;
use crate::whole::altitude::{self, Floor};
use crate::whole::{Attempt, Bound, Ended, Limit, Places, Rounds, in_rounds};

use super::prepared::Smoother;

/// The work that a run does between its sweeps, and its state.
pub(super) struct Ways<'s> {
    mesh: &'s Mesh,
    topology: &'s Topology<'s>,
    start: &'s Problem,
    rounds: Option<Rounds<'s>>,
    places: Option<Places<'s>>,
    limit: Option<Limit<'s>>,
}

impl<'s> Ways<'s> {
    /// Checks that the requested work between sweeps is possible with these options.
    pub(super) fn check(
        smoother: &Smoother<'_>,
        options: &Options,
        is_continued: bool,
    ) -> Result<(), SmoothError> {
        let refuse = |option, value: &str, remedy| {
            Err(SmoothError::Option { option, value: value.to_owned(), remedy })
        };
        let (slides, has_field) = (smoother.sliding.is_some(), smoother.field.is_some());
        if slides {
            in_rounds::check("slide", options, is_continued)?;
        }
        if options.max_move.is_some() {
            Limit::check(options, is_continued)?;
        }
        if has_field {
            Places::check(options, is_continued)?;
        }
        if options.keep_altitude {
            altitude::check(options, is_continued)?;
        }
        if has_field && slides {
            let remedy = "leave out one of the two, or set targets of vertices";
            return refuse("target field", "with sliding vertices", remedy);
        }
        if has_field && options.keep_altitude {
            return refuse(
                "keep altitude",
                "on",
                "it cannot be combined with a target field: leave out one of the two",
            );
        }
        Ok(())
    }

    pub(super) fn new(smoother: &'s Smoother<'_>, options: &Options) -> Self {
        let Smoother { mesh, topology, problem, sliding, field, .. } = smoother;
        let limit = |most| Limit::new(mesh, topology, problem, most, options.stored);
        Self {
            mesh,
            topology,
            start: problem,
            rounds: sliding.as_ref().map(Rounds::new),
            places: field.as_ref().map(|field| Places::new(mesh, field, problem)),
            limit: options.max_move.map(limit),
        }
    }

    /// Sweeps until the run ends, or reaches the objective `target`. Only a run in one attempt can continue from a
    /// checkpoint and take checkpoints.
    pub(super) async fn sweep<K: Keeper + ?Sized>(
        &mut self,
        run: Attempt<'_>,
        options: &Options,
        target: Option<f64>,
        resumed: Option<&Checkpoint>,
        keeping: &mut Keeping<'_, K>,
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<Ended, SmoothError> {
        let Self { mesh, start, rounds, places, limit, .. } = self;
        if rounds.is_some() || places.is_some() || limit.is_some() || options.keep_altitude {
            // A checkpoint does not hold the state of the work between sweeps, so none is taken.
            keeping.about = None;
        }
        if let Some(places) = places {
            places.run(run, options, keeping, observe).await
        } else if let Some(rounds) = rounds {
            let mut floor = options.keep_altitude.then(|| Floor::new(mesh, start));
            let bound = match (limit, &mut floor) {
                (Some(limit), _) => Bound::Moves(limit),
                (None, Some(floor)) => Bound::Altitudes(floor),
                (None, None) => Bound::None,
            };
            rounds.run(run, options, target, bound, keeping, observe).await
        } else if let Some(limit) = limit {
            limit.run(run, options, target, keeping, observe).await
        } else if options.keep_altitude {
            altitude::run(mesh, start, run, options, target, keeping, observe).await
        } else {
            run.sweep(options, target, start.positions(), resumed, keeping, observe).await
        }
    }

    /// Returns the problem with the final targets of the vertices.
    pub(super) fn problem(&self) -> &Problem {
        self.places.as_ref().map_or(self.start, |places| &places.problem)
    }

    /// Returns how far each free vertex may be from its start, normalized, if there is a bound.
    pub(super) fn bounds(&self) -> Option<&[f64]> {
        self.limit.as_ref().map(Limit::bounds)
    }

    /// Writes the positions of vertices that slid. The normalized positions do not hold all of their digits.
    pub(super) fn slide_into(&self, points: &mut [[f64; 2]]) {
        let moved = self.rounds.iter().flat_map(|rounds| rounds.sliding.moved(&rounds.params));
        for (v, point) in moved {
            points[v as usize] = point;
        }
    }

    /// Evaluates a field of targets again, with the vertices at these normalized positions.
    pub(super) fn follow(&mut self, positions: &[DVec2]) -> Result<(), MeshError> {
        self.places.as_mut().map_or(Ok(()), |places| places.follow(positions))
    }

    /// Returns the result of sliding with the vertices at `points`. Nothing slid if the run gained nothing.
    pub(super) fn slid(&self, gains: bool, points: &[[f64; 2]]) -> Option<Slid> {
        let rounds = self.rounds.as_ref()?;
        Some(rounds.slid(self.mesh, self.topology, gains, points))
    }
}
