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

/// Time after which a poll of an awaited run ends at the next pause, if the caller polls now and then, as once in a frame.
/// Pauses are at most some milliseconds of work apart.
const RARE: Duration = Duration::from_millis(4);
/// Time after which a poll ends that soon follows the last one. An executor polls a future that wakes its task at once
/// dozens of times before it looks at timers and sockets: tokio 61 times by default.
const FREQUENT: Duration = Duration::from_micros(250);
/// Time between two polls of a future, exclusive of the polls, from which on polls count as rare. A display with 144 frames
/// a second polls every 7 ms, and an executor with 20 frequently polled futures polls each every 5 ms.
const RARE_GAP: Duration = Duration::from_millis(5);

/// Returns the budget of a poll, given the time since the end of the last poll; `None` for the first poll.
pub(crate) fn budget_after(gap: Option<Duration>) -> Duration {
    match gap {
        Some(gap) if gap >= RARE_GAP => RARE,
        _ => FREQUENT,
    }
}

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

/// Returns a future that computes in each poll about as long as `budget` returns for the time since the end of the last
/// poll, `None` for the first poll.
pub(crate) async fn paced<F: Future + ?Sized>(
    budget: impl Fn(Option<Duration>) -> Duration,
    mut future: Pin<Box<F>>,
) -> F::Output {
    let mut ended: Option<Instant> = None;
    poll_fn(|context| {
        let start = Instant::now();
        let gap = ended.map(|ended| start.saturating_duration_since(ended));
        let _restored = Restored::after(Some(start + budget(gap)));
        let polled = future.as_mut().poll(context);
        ended = Some(Instant::now());
        polled
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
    let mut future = pin!(paced(|_| budget, Box::pin(future)));
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

    /// A former defect: three runs on one thread of tokio, each with 4 ms in each of 61 polls, stopped timers for 370 ms.
    #[test]
    fn frequent_polls_are_short_and_rare_ones_long() {
        let polls = |futures: u32| {
            let mut gap = None;
            for _ in 0..100 {
                gap = Some(budget_after(gap) * (futures - 1));
            }
            61 * budget_after(gap)
        };
        assert!([1, 2, 3, 20].map(polls).into_iter().all(|time| time < Duration::from_millis(16)));
        let frame = Duration::from_secs(1) / 144 - Duration::from_millis(1);
        assert_eq!(budget_after(Some(frame)), RARE);
        // A future knows the time since its last poll.
        let seen = std::cell::RefCell::new(Vec::new());
        let budget = |gap: Option<Duration>| {
            seen.borrow_mut().push(gap);
            Duration::ZERO
        };
        let mut future = pin!(paced(budget, Box::pin(async { pause().await })));
        let mut context = Context::from_waker(Waker::noop());
        assert!(future.as_mut().poll(&mut context).is_pending());
        std::thread::sleep(RARE_GAP);
        assert!(future.as_mut().poll(&mut context).is_ready());
        let [None, Some(gap)] = seen.borrow()[..] else { panic!("two polls") };
        assert!(gap >= RARE_GAP);
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
