//! The state of a run between two sweeps, from which it can continue.

use bytemuck::Pod;
use glam::DVec2;

use crate::run::objectives::Objectives;

/// The name of the CPU engine in [`EngineState::engine`].
pub(crate) const CPU: &str = "cpu";

/// The state of a run between two sweeps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Saved {
    /// The objectives before the first sweep and after each.
    pub(crate) log: Vec<Objectives>,
    /// The share of f that is estimated to be left to gain.
    pub(crate) remaining: Option<f64>,
    /// The state of the corrections, if the run has any.
    pub(crate) corrections: Option<Vec<u64>>,
    pub(crate) engine: EngineState,
}

impl Saved {
    /// Number of sweeps done.
    pub(crate) fn sweeps(&self) -> u32 {
        (self.log.len() as u32).saturating_sub(1)
    }
}

/// The state of the host and of the stages in a period: what they were when the period began.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PeriodState {
    /// The number of sweeps before the period.
    pub(crate) began: u32,
    /// The positions before the period, normalized and in the order of the problem.
    pub(crate) before: Vec<DVec2>,
    /// f by the base metric before the period.
    pub(crate) f_before: f64,
    /// For each free vertex, whether sweeps are not to move it.
    pub(crate) held: Vec<bool>,
    /// The last sweep on the device, after which the CPU continued; `None` if the CPU did not take over.
    pub(crate) on_cpu_from: Option<u32>,
    /// The name and the state of each stage, in the order in which the stages work.
    pub(crate) stages: Vec<(String, Vec<u8>)>,
}

/// The state of an engine between two sweeps.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct EngineState {
    /// [`CPU`], or the name of the adapter.
    pub(crate) engine: String,
    /// The positions of all vertices, normalized and in the order of the problem.
    pub(crate) positions: Vec<DVec2>,
    /// The positions in the best state, if that may differ from the last one.
    pub(crate) best: Option<Vec<DVec2>>,
    /// The roots that the coarser levels were built from, and then those that they were fitted to, in order. Empty if
    /// there are no levels, or if the state is not whole.
    pub(crate) roots: Vec<Vec<f32>>,
    /// Named data that only an engine of the same kind can read.
    pub(crate) own: Vec<(String, Vec<u8>)>,
}

impl EngineState {
    /// Adds named data that only an engine of the same kind can read.
    pub(crate) fn add<T: Pod>(&mut self, name: &str, values: &[T]) {
        self.own.push((name.to_owned(), bytemuck::cast_slice(values).to_vec()));
    }

    /// Returns the data with this name, if they consist of `count` values.
    pub(crate) fn own<T: Pod>(&self, name: &str, count: usize) -> Option<Vec<T>> {
        let (_, bytes) = self.own.iter().find(|(known, _)| known == name)?;
        let is_whole = bytes.len() == count.checked_mul(size_of::<T>())?;
        is_whole.then(|| bytemuck::pod_collect_to_vec(bytes))
    }
}
