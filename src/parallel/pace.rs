//! Pauses in futures that compute for long.
//!
//! A future inside [`paced`] has a budget of time for each poll. Loops of [`paced`](super::paced) and calls of [`pause`]
//! end the poll once the budget is spent. Outside of [`paced`] no call pauses, so one function serves awaited and
//! blocking callers.

use std::cell::Cell;
use std::future::poll_fn;
use std::pin::{Pin, pin};
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use web_time::Instant;

/// Time after which a poll of an awaited run ends at the next pause. Pauses are at most some milliseconds of work apart.
pub(crate) const BUDGET: Duration = Duration::from_millis(4);

thread_local! {
    /// Time at which the present poll on this thread ends; `None` outside of a paced future.
    static DEADLINE: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// Restores the deadline of the enclosing future when a poll ends.
struct Restored(Option<Instant>);

impl Restored {
    fn after(deadline: Option<Instant>) -> Self {
        Self(DEADLINE.replace(deadline))
    }
}

impl Drop for Restored {
    fn drop(&mut self) {
        DEADLINE.set(self.0);
    }
}

/// Returns a future that computes about `budget` in each poll.
pub(crate) async fn paced<F: Future + ?Sized>(
    budget: Duration,
    mut future: Pin<Box<F>>,
) -> F::Output {
    poll_fn(|context| {
        let _restored = Restored::after(Some(Instant::now() + budget));
        future.as_mut().poll(context)
    })
    .await
}

/// Polls a future once, with the given end of the poll. `None` if the future is not done.
pub(super) fn poll_until<F: Future>(
    until: Option<Instant>,
    future: Pin<&mut F>,
) -> Option<F::Output> {
    let _restored = Restored::after(until);
    match future.poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(output) => Some(output),
        Poll::Pending => None,
    }
}

/// Computes a future that waits for nothing but its own pauses, without any pause.
pub(crate) fn now<F: Future>(future: F) -> F::Output {
    let mut future = pin!(future);
    loop {
        if let Some(output) = poll_until(None, future.as_mut()) {
            return output;
        }
    }
}

/// Returns the time at which the present poll ends; `None` outside of a paced future.
pub(super) fn deadline() -> Option<Instant> {
    DEADLINE.get()
}

/// Ends the present poll if its budget is spent, so that the executor can run other tasks.
pub(crate) async fn pause() {
    let mut is_due = deadline().is_some_and(|deadline| Instant::now() >= deadline);
    poll_fn(|context| match std::mem::take(&mut is_due) {
        true => {
            context.waker().wake_by_ref();
            Poll::Pending
        }
        false => Poll::Ready(()),
    })
    .await;
}

/// Computes a future with the given budget for each poll. Returns the output of the future and the number of polls.
#[cfg(test)]
pub(crate) fn polled<F: Future>(budget: Duration, future: F) -> (F::Output, usize) {
    let mut future = pin!(paced(budget, Box::pin(future)));
    let mut polls = 0;
    loop {
        polls += 1;
        let mut context = Context::from_waker(Waker::noop());
        if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
            return (output, polls);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOUR: Duration = Duration::from_secs(3600);

    #[test]
    fn only_a_spent_budget_ends_a_poll() {
        let pauses = async || {
            for _ in 0..5 {
                pause().await;
            }
        };
        assert_eq!(polled(Duration::ZERO, pauses()).1, 6);
        assert_eq!(polled(HOUR, pauses()).1, 1);
        // Neither a blocking call within a poll nor a call after the poll pauses.
        assert_eq!(polled(Duration::ZERO, async { now(pauses()) }).1, 1);
        assert!(deadline().is_none());
    }

    #[test]
    fn a_future_within_a_future_has_its_own_budget() {
        let within = async {
            let inner = polled(HOUR, async { pause().await }).1;
            pause().await;
            inner
        };
        assert_eq!(polled(Duration::ZERO, within), (1, 2));
    }
}
