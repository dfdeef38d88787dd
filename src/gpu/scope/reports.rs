//! Errors of calls that a browser reports after the calls have returned.

use std::future::poll_fn;
use std::mem::take;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Wake, Waker};

use crate::error::GpuError;

/// The outcome of a call: an error, or `None` if the call has succeeded.
type Report = Pin<Box<dyn Future<Output = Option<GpuError>> + Send>>;

/// The outcomes of calls on one device. Clones share the outcomes.
#[derive(Clone, Default)]
pub(crate) struct Reports {
    expected: Arc<Mutex<Expected>>,
    waiting: Arc<Waiting>,
}

#[derive(Default)]
struct Expected {
    /// Outcomes that have not arrived, in the order of the calls.
    pending: Vec<Report>,
    /// The first error that has arrived and was not returned.
    first: Option<GpuError>,
}

/// The tasks that wait for outcomes. An outcome wakes all of them, because a future keeps only the waker of its last
/// poll, and several tasks poll each outcome.
#[derive(Default)]
struct Waiting(Mutex<Vec<Waker>>);

impl Wake for Waiting {
    fn wake(self: Arc<Self>) {
        let tasks = take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner));
        tasks.into_iter().for_each(Waker::wake);
    }
}

impl Reports {
    /// Adds the outcome of a call. Earlier outcomes that have arrived are taken, so that an application that never
    /// waits does not collect them.
    pub(crate) fn expect(&self, report: impl Future<Output = Option<GpuError>> + Send + 'static) {
        let mut expected = self.collected();
        expected.pending.push(Box::pin(report));
    }

    /// Returns the first error that has arrived since the last one was returned. Never waits.
    pub(crate) fn arrived(&self) -> Result<(), GpuError> {
        self.collected().first.take().map_or(Ok(()), Err)
    }

    /// Waits for all outcomes, and returns the first error.
    pub(crate) async fn all(&self) -> Result<(), GpuError> {
        poll_fn(|context| {
            let waker = context.waker().clone();
            self.waiting.0.lock().unwrap_or_else(PoisonError::into_inner).push(waker);
            let mut expected = self.collected();
            match expected.pending.is_empty() {
                true => Poll::Ready(expected.first.take().map_or(Ok(()), Err)),
                false => Poll::Pending,
            }
        })
        .await
    }

    /// Takes the outcomes that have arrived.
    fn collected(&self) -> MutexGuard<'_, Expected> {
        let mut guard = self.expected.lock().unwrap_or_else(PoisonError::into_inner);
        let expected = &mut *guard;
        let waker = Waker::from(Arc::clone(&self.waiting));
        let mut context = Context::from_waker(&waker);
        let first = &mut expected.first;
        expected.pending.retain_mut(|report| match report.as_mut().poll(&mut context) {
            Poll::Ready(error) => {
                *first = first.take().or(error);
                false
            }
            Poll::Pending => true,
        });
        guard
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use futures_intrusive::channel::shared::{OneshotSender, oneshot_channel};

    use super::*;

    #[derive(Default)]
    struct Counter(AtomicUsize);

    impl Wake for Counter {
        fn wake(self: Arc<Self>) {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
    }

    fn expected(reports: &Reports) -> OneshotSender<Option<GpuError>> {
        let (sender, receiver) = oneshot_channel();
        reports.expect(async move { receiver.receive().await.flatten() });
        sender
    }

    fn refused(text: &str) -> Option<GpuError> {
        Some(GpuError::Refused(text.to_owned()))
    }

    #[test]
    fn an_error_that_arrives_later_is_returned_once_and_the_first_call_comes_first() {
        let reports = Reports::default();
        let (first, second) = (expected(&reports), expected(&reports));
        assert!(reports.arrived().is_ok());
        first.send(refused("first")).unwrap();
        second.send(refused("second")).unwrap();
        assert!(matches!(reports.arrived(), Err(GpuError::Refused(text)) if text == "first"));
        assert!(reports.arrived().is_ok());
        expected(&reports).send(refused("third")).unwrap();
        assert!(matches!(reports.arrived(), Err(GpuError::Refused(text)) if text == "third"));
    }

    #[test]
    fn a_task_that_waits_is_woken_though_another_has_polled_since() {
        let reports = Reports::default();
        let sender = expected(&reports);
        let counter = Arc::new(Counter::default());
        let waker = Waker::from(Arc::clone(&counter));
        let mut context = Context::from_waker(&waker);
        let mut all = std::pin::pin!(reports.all());
        assert!(all.as_mut().poll(&mut context).is_pending());
        assert!(reports.arrived().is_ok());
        assert_eq!(counter.0.load(Ordering::Relaxed), 0);
        sender.send(refused("late")).unwrap();
        assert_eq!(counter.0.load(Ordering::Relaxed), 1);
        let end = all.as_mut().poll(&mut context);
        assert!(matches!(end, Poll::Ready(Err(GpuError::Refused(text))) if text == "late"));
    }

    #[test]
    fn outcomes_without_an_error_do_not_accumulate() {
        let reports = Reports::default();
        for _ in 0..100 {
            expected(&reports).send(None).unwrap();
        }
        assert!(reports.expected.lock().unwrap().pending.len() <= 1);
        assert!(pollster::block_on(reports.all()).is_ok());
    }
}
