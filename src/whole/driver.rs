//! The loop of a whole run: sweeps, and between periods of sweeps the stage of a target field.

use crate::error::SmoothError;
use crate::run::{Observer, Stop};
use crate::whole::end::RunEnd;
use crate::whole::session::Session;
use crate::whole::target_field::{Judgment, TargetFieldStage};

/// Sweeps until the run ends. With a target field, its stage works after each period, and decides whether the run ends. A run of
/// no sweeps has no period.
pub(crate) async fn drive(
    mut run: Session<'_>,
    observe: &mut dyn Observer,
) -> Result<RunEnd, SmoothError> {
    let max_sweeps = run.plan.stop.max_sweeps;
    loop {
        let until = run.field.as_ref().map_or(max_sweeps, TargetFieldStage::until).min(max_sweeps);
        let (swept, stop) = run.sweep(until, observe).await?;
        let followed = match stop {
            Some(Stop::NotFinite) => None,
            _ if max_sweeps == 0 => None,
            _ => run.follow_field(&swept).await?,
        };
        let Some((positions, Judgment { stop: judged, remaining })) = followed else {
            return Ok(RunEnd::of(run, swept, stop.unwrap_or(Stop::MaxSweeps)).await);
        };
        if let Some(stop) = stop.filter(|stop| *stop == Stop::Canceled).or(judged) {
            return Ok(RunEnd { remaining, ..RunEnd::of(run, positions, stop).await });
        }
    }
}
