//! The loop of a whole run: sweeps on the engine, and stages on the host between sweeps.

use crate::error::SmoothError;
use crate::resume;
use crate::run::records::{Reader, Writer};
use crate::run::{Checkpointer, Observer, PeriodState, Stop};
use crate::whole::host::{Host, objectives};
use crate::whole::live::{Live, Moved, RunEnd};
use crate::whole::stage::{Judgment, Period, Stage};

/// Sweeps until the run ends. After each period, all stages work, in order. The last stage decides whether the run
/// ends.
pub(crate) async fn drive(
    mut live: Live<'_>,
    stages: &mut [&mut dyn Stage],
    checkpointer: &mut Checkpointer<'_>,
    observe: &mut dyn Observer,
    resumed: Option<&PeriodState>,
) -> Result<RunEnd, SmoothError> {
    let max_sweeps = live.plan.stop.max_sweeps;
    if stages.is_empty() || max_sweeps == 0 {
        // Without stages, the engine ends the run. With stages, the host does.
        let until = if stages.is_empty() { u32::MAX } else { 0 };
        let (positions, stop) = live.sweep(until, None, checkpointer, observe).await?;
        return Ok(live.end(positions, stop.unwrap_or(Stop::MaxSweeps)).await);
    }
    let plan = live.plan.clone();
    let mut host = Host::new(live.problem.clone(), &plan, live.start()).await;
    let mut began = 0;
    if let Some(period) = resumed {
        restore(period, &mut host, stages).ok_or_else(resume::foreign)?;
        began = period.began;
        live.problem = host.problem.clone();
    }
    loop {
        let period = stages.iter().map(|stage| stage.period()).min().unwrap_or(u32::MAX);
        let until = began.saturating_add(period).min(max_sweeps);
        let state = || saved(&host, stages, began);
        let (swept_to, swept) = live.sweep(until, Some(&state), checkpointer, observe).await?;
        if let Some(stop) = swept.filter(|stop| *stop == Stop::NotFinite) {
            return Ok(live.end(swept_to, stop).await);
        }
        host.positions.clone_from(&swept_to);
        for stage in stages.iter_mut() {
            stage.work(&mut host)?;
        }
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
        let judged = stages.last_mut().map(|stage| stage.judge(&period));
        let Judgment { stop, remaining } =
            judged.unwrap_or(Judgment { stop: None, remaining: None });
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

/// Returns the state of the host and the stages for a checkpoint, in a period that began after `began` sweeps.
fn saved(host: &Host<'_>, stages: &[&mut dyn Stage], began: u32) -> PeriodState {
    let state = |stage: &&mut dyn Stage| {
        let mut out = Writer::default();
        stage.save(&mut out);
        (stage.name().to_owned(), out.0)
    };
    let Host { before, f_before, .. } = host;
    PeriodState {
        began,
        before: before.clone(),
        f_before: *f_before,
        stages: stages.iter().map(state).collect(),
    }
}

/// Restores the host and the stages from a saved state. `None` if the state belongs to another mesh or to other stages.
fn restore(period: &PeriodState, host: &mut Host<'_>, stages: &mut [&mut dyn Stage]) -> Option<()> {
    if period.stages.len() != stages.len() {
        return None;
    }
    host.before.clone_from(&period.before);
    host.positions.clone_from(&period.before);
    host.f_before = period.f_before;
    for (stage, (name, state)) in stages.iter_mut().zip(&period.stages) {
        let mut from = Reader(state);
        if stage.name() != name {
            return None;
        }
        stage.restore(host, &mut from)?;
        from.is_empty().then_some(())?;
    }
    host.has_new_targets = false;
    Some(())
}
