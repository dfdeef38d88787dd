//! Drives sweeps from some positions to the end, on whichever engine.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use glam::DVec2;

use crate::cpu::{CpuEngine, CpuFine};
use crate::error::SmoothError;
use crate::gpu::{Gpu, GpuEngine, GpuError, GpuFine, Waiting};
use crate::layout::Problem;
use crate::run::Stop;
use crate::run::multilevel::MultilevelEngine;
use crate::run::opening::{self, Opened};
use crate::run::{Engine, Objectives};
use crate::run::{Method, Options};

/// Hears how far a run is, and may end it: any `FnMut(&Progress) -> ControlFlow<()>`.
pub trait Observer: FnMut(&Progress) -> ControlFlow<()> {}

impl<F: FnMut(&Progress) -> ControlFlow<()> + ?Sized> Observer for F {}

/// How far a run is, for a progress display.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// What the sweeps are for.
    pub phase: Phase,
    /// Sweeps done in this phase.
    pub sweep: u32,
    /// The base objective.
    pub f: f64,
}

/// The part of a run that is under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The optimum is sought that [`Desired::Auto`](crate::Desired::Auto) measures by.
    Reference,
    /// The mesh is smoothed.
    Smoothing,
}

/// Where a run computes, and who waits for it.
#[derive(Clone, Copy)]
pub(crate) enum Place<'g> {
    Cpu,
    Gpu(&'g Gpu, Waiting),
}

/// The engine of a run.
enum AnyEngine<'e> {
    Cpu(Box<CpuEngine<'e>>),
    Gpu(Box<GpuEngine<'e>>),
    CpuMultilevel(Box<MultilevelEngine<'e, CpuFine<'e>>>),
    GpuMultilevel(Box<MultilevelEngine<'e, GpuFine<'e>>>),
}

impl AnyEngine<'_> {
    async fn advance(&mut self, sweeps: u32) -> Result<Vec<Objectives>, GpuError> {
        match self {
            AnyEngine::Cpu(engine) => engine.advance(sweeps),
            AnyEngine::Gpu(engine) => GpuEngine::advance(engine, sweeps).await,
            AnyEngine::CpuMultilevel(engine) => engine.advance(sweeps).await,
            AnyEngine::GpuMultilevel(engine) => engine.advance(sweeps).await,
        }
    }

    fn stop(&self) -> Option<Stop> {
        match self {
            AnyEngine::Cpu(engine) => engine.stop(),
            AnyEngine::Gpu(engine) => engine.stop(),
            AnyEngine::CpuMultilevel(engine) => engine.stop(),
            AnyEngine::GpuMultilevel(engine) => engine.stop(),
        }
    }

    async fn best_positions(&mut self) -> Result<Vec<DVec2>, GpuError> {
        match self {
            AnyEngine::Cpu(engine) => engine.best_positions(),
            AnyEngine::Gpu(engine) => GpuEngine::best_positions(engine).await,
            AnyEngine::CpuMultilevel(engine) => engine.best_positions().await,
            AnyEngine::GpuMultilevel(engine) => engine.best_positions().await,
        }
    }

    fn corrections(&self) -> u32 {
        match self {
            AnyEngine::Cpu(_) | AnyEngine::Gpu(_) => 0,
            AnyEngine::CpuMultilevel(engine) => engine.corrections(),
            AnyEngine::GpuMultilevel(engine) => engine.corrections(),
        }
    }

    /// Why there are no corrections, if there was to be some.
    fn left_out(&self) -> Option<&GpuError> {
        match self {
            AnyEngine::Cpu(_) | AnyEngine::Gpu(_) => None,
            AnyEngine::CpuMultilevel(engine) => engine.left_out(),
            AnyEngine::GpuMultilevel(engine) => engine.left_out(),
        }
    }
}

/// Sweeps from some positions to the end.
pub(crate) struct Run<'s> {
    pub(crate) problem: &'s Problem,
    pub(crate) place: Place<'s>,
    pub(crate) phase: Phase,
}

/// What a run leaves.
pub(crate) struct End {
    pub(crate) history: Vec<Objectives>,
    pub(crate) positions: Vec<DVec2>,
    pub(crate) corrections: u32,
    pub(crate) opening_sweeps: u32,
    pub(crate) levels_left_out: bool,
    pub(crate) stop: Stop,
}

impl Run<'_> {
    pub(crate) async fn sweep(
        &self,
        options: &Options,
        target: Option<f64>,
        from: &[DVec2],
        observe: &mut (impl Observer + ?Sized),
    ) -> Result<End, SmoothError> {
        let base = options.scheme.base();
        let (place, opened) = self.opened(options, target, from);
        let done = opened.as_ref().map_or(0, Opened::sweeps);
        let options = &Options { max_sweeps: options.max_sweeps - done, ..options.clone() };
        let from = opened.as_ref().map_or(from, |opened| &opened.positions);
        let mut engine = self.engine(place, options, target, from)?;
        let mut history = Vec::new();
        let mut batch = 4;
        let stop = loop {
            let start = Instant::now();
            let log = engine.advance(batch).await?;
            batch = next_batch(batch, start.elapsed());
            history.extend_from_slice(&log);
            if let (Method::Multilevel, Some(error)) = (options.method, engine.left_out()) {
                return Err(error.clone().into());
            }
            if let Some(stop) = engine.stop() {
                break stop;
            }
            let progress = Progress {
                phase: self.phase,
                sweep: done + history.len() as u32 - 1,
                f: history.last().and_then(|o| o.of(base)).unwrap_or(f64::NAN),
            };
            if observe(&progress).is_break() {
                break Stop::Cancelled;
            }
        };
        let corrections = engine.corrections();
        let levels_left_out = engine.left_out().is_some();
        let positions = engine.best_positions().await?;
        let (history, positions) = match opened {
            Some(opened) => opened.followed_by(base, history, positions),
            None => (history, positions),
        };
        let opening_sweeps = match (self.place, place) {
            (Place::Gpu(..), Place::Cpu) => history.len() as u32 - 1,
            _ => done,
        };
        Ok(End { history, positions, corrections, opening_sweeps, levels_left_out, stop })
    }

    /// Where to compute, and what came before it: where a triangle is too flat for a device's single precision, sweeps on
    /// the CPU that open it; or all of the run, if they cannot.
    fn opened(
        &self,
        options: &Options,
        target: Option<f64>,
        from: &[DVec2],
    ) -> (Place<'_>, Option<Opened>) {
        match self.place {
            Place::Gpu(..) if opening::is_needed(self.problem, from) => {
                match opening::open(self.problem, from, options.plan_to(target)) {
                    Some(opened) => (self.place, Some(opened)),
                    None => (Place::Cpu, None),
                }
            }
            _ => (self.place, None),
        }
    }

    fn engine<'e>(
        &'e self,
        place: Place<'e>,
        options: &Options,
        target: Option<f64>,
        from: &'e [DVec2],
    ) -> Result<AnyEngine<'e>, GpuError> {
        let problem = self.problem;
        let plan = options.plan_to(target);
        let multilevel = options.is_multilevel();
        Ok(match place {
            Place::Cpu if multilevel => {
                let fine = CpuFine::new(problem, from.to_vec(), &plan);
                AnyEngine::CpuMultilevel(Box::new(MultilevelEngine::new(problem, fine, &plan)))
            }
            Place::Cpu => AnyEngine::Cpu(Box::new(CpuEngine::new(problem, from.to_vec(), plan))),
            Place::Gpu(gpu, waiting) if multilevel => {
                let fine = GpuFine::new(gpu, problem, from, &plan, waiting)?;
                AnyEngine::GpuMultilevel(Box::new(MultilevelEngine::new(problem, fine, &plan)))
            }
            Place::Gpu(gpu, waiting) => {
                let engine = GpuEngine::new(gpu, problem, from, plan)?.waiting(waiting);
                AnyEngine::Gpu(Box::new(engine))
            }
        })
    }
}

/// How many sweeps to ask for next, so that the caller hears something about ten times a second.
/// Results do not depend on it.
fn next_batch(batch: u32, took: Duration) -> u32 {
    let fits = 0.1 * f64::from(batch) / took.as_secs_f64().max(1e-6);
    (fits as u32).clamp(1, 4 * batch).min(100)
}
