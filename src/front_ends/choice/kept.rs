//! The best adapter of the machine and its device, kept for later choices.

use std::sync::{Mutex, PoisonError};

use crate::adapter::AdapterSummary;
use crate::error::GpuError;
use crate::gpu::{Adapter, Gpu, ranked_adapters};

/// The best adapter of the machine, from the first search on. `None` before the search. The lock is held while drivers
/// start.
#[derive(Default)]
pub(super) struct Kept(Mutex<Option<Found>>);

/// The result of a search for adapters: the first in order of preference. The error is kept too, as the trial of a driver
/// that hangs takes seconds.
type Found = Result<KeptAdapter, GpuError>;

/// An adapter, and its device once the device is open.
pub(super) struct KeptAdapter {
    adapter: Adapter,
    gpu: Option<Gpu>,
}

impl Kept {
    pub(super) const fn new() -> Self {
        Self(Mutex::new(None))
    }

    /// Calls `choose` with the best adapter. Searches the machine for adapters in the first call, and again after the loss
    /// of the device. `try_drivers` is called before each search.
    ///
    /// # Errors
    /// The error of `try_drivers`, or [`GpuError::NoAdapter`].
    pub(super) fn best<T>(
        &self,
        try_drivers: impl FnOnce() -> Result<(), GpuError>,
        choose: impl FnOnce(&mut KeptAdapter) -> T,
    ) -> Result<T, GpuError> {
        let mut found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if matches!(&*found, Some(Ok(adapter)) if adapter.is_lost())
            && let Some(Ok(KeptAdapter { gpu: Some(gpu), .. })) = found.take()
        {
            gpu.discard();
        }
        let found = found.get_or_insert_with(|| {
            try_drivers()?;
            let none = GpuError::NoAdapter { wanted: None, available: String::new() };
            let best = ranked_adapters().into_iter().next().ok_or(none)?;
            Ok(KeptAdapter { adapter: best, gpu: None })
        });
        found.as_mut().map(choose).map_err(|error| error.clone())
    }
}

impl KeptAdapter {
    pub(super) fn summary(&self) -> AdapterSummary {
        AdapterSummary::new(&self.adapter.get_info())
    }

    /// Returns the device of the adapter. The first call opens and checks the device.
    pub(super) fn gpu(&mut self) -> Result<Gpu, GpuError> {
        if let Some(gpu) = &self.gpu {
            return Ok(gpu.clone());
        }
        let gpu = Gpu::start(&self.adapter)?;
        Ok(self.gpu.insert(gpu).clone())
    }

    fn is_lost(&self) -> bool {
        self.gpu.as_ref().is_some_and(Gpu::is_lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_trial_of_the_drivers_is_not_repeated() {
        let (kept, mut trials) = (Kept::new(), 0);
        for _ in 0..3 {
            let mut fail = || {
                trials += 1;
                Err(GpuError::Crashed("in a trial".to_owned()))
            };
            let chosen = kept.best(&mut fail, |_| panic!("there is no adapter"));
            assert!(matches!(chosen, Err(GpuError::Crashed(_))));
        }
        assert_eq!(trials, 1);
    }
}
