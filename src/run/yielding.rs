//! Pauses between pieces of work that the host does inside a future.

use std::future::poll_fn;
use std::task::Poll;

/// Lets the executor do something else before it goes on. Where the caller blocks, it goes on at once.
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
