//! The loop of a whole run: sweeps on the engine, and the evaluation of a field of targets on the host between sweeps.

use crate::error::SmoothError;
use crate::resume;
use crate::run::{Checkpointer, Observer, PeriodState, Stop};
use crate::whole::host::{Host, objectives};
use crate::whole::live::{Live, Moved, RunEnd};
use crate::whole::target_field::{Judgment, Period, TargetFieldStage};

/// Sweeps until the run ends. With a field of targets, its stage works after each period, and decides whether the run ends.
pub(crate) async fn drive(
    mut live: Live<'_>,
    stage: Option<&mut TargetFieldStage<'_>>,
    checkpointer: &mut Checkpointer<'_>,
    observe: &mut dyn Observer,
    resumed: Option<&PeriodState>,
) -> Result<RunEnd, SmoothError> {
    let max_sweeps = live.plan.stop.max_sweeps;
    let Some(stage) = stage.filter(|_| max_sweeps > 0) else {
        let (positions, stop) = live.sweep(max_sweeps, None, checkpointer, observe).await?;
        return Ok(live.end(positions, stop.unwrap_or(Stop::MaxSweeps)).await);
    };
    let plan = live.plan.clone();
    let mut host = Host::new(live.problem.clone(), &plan, live.start()).await;
    let mut began = 0;
    if let Some(period) = resumed {
        restore(period, &mut host, stage).ok_or_else(resume::foreign)?;
        began = period.began;
        live.problem = host.problem.clone();
    }
    loop {
        let until = began.saturating_add(TargetFieldStage::SWEEPS).min(max_sweeps);
        let state = || saved(&host, stage, began);
        let (swept_to, swept) = live.sweep(until, Some(&state), checkpointer, observe).await?;
        if let Some(stop) = swept.filter(|stop| *stop == Stop::NotFinite) {
            return Ok(live.end(swept_to, stop).await);
        }
        host.positions.clone_from(&swept_to);
        stage.work(&mut host)?;
        let now = objectives(&host.problem, &plan, &host.positions).await;
        let f = now.of(plan.scheme.base()).unwrap_or(f64::NAN);
        let moved = Moved {
            positions: &host.positions,
            swept_to: &swept_to,
            targets: std::mem::take(&mut host.has_new_targets).then_some(&host.problem),
            now,
        };
        live.write_back(began, moved, checkpointer).await?;
        let period = Period { f: [host.f_before, f], is_last: live.sweeps() >= max_sweeps };
        let Judgment { stop, remaining } = stage.judge(&period);
        let stop = if swept == Some(Stop::Canceled) { swept } else { stop };
        if let Some(stop) = stop {
            // An extrapolation cannot show less than the tolerance: slow modes may remain.
            let least = if stop == Stop::Converged { plan.stop.tolerance } else { 0.0 };
            let remaining = remaining.map(|left| left.max(least));
            let ended = live.end(host.positions, stop).await;
            return Ok(RunEnd { remaining, ..ended });
        }
        host.begin_period(f);
        began = live.sweeps();
    }
}

/// Returns the state of the host and the stage for a checkpoint, in a period that began after `began` sweeps.
fn saved(host: &Host<'_>, stage: &TargetFieldStage<'_>, began: u32) -> PeriodState {
    let Host { before, f_before, .. } = host;
    PeriodState { began, before: before.clone(), f_before: *f_before, stage: stage.save() }
}

/// Restores the host and the stage from a saved state. `None` if the state is invalid.
fn restore(
    period: &PeriodState,
    host: &mut Host<'_>,
    stage: &mut TargetFieldStage<'_>,
) -> Option<()> {
    host.before.clone_from(&period.before);
    host.positions.clone_from(&period.before);
    host.f_before = period.f_before;
    stage.restore(host, &period.stage)?;
    host.has_new_targets = false;
    Some(())
}
