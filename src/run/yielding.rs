//! Pauses between pieces of work on the CPU inside a future.

use std::future::poll_fn;
use std::task::Poll;

/// Lets the executor run other tasks before this future continues. If the caller blocks on the future, it continues at
/// once.
pub(crate) async fn yield_now() {
    let mut yielded = false;
    poll_fn(|context| {
        if yielded {
            return Poll::Ready(());
        }
        yielded = true;
        context.waker().wake_by_ref();
        Poll::Pending
    })
    .await;
}
