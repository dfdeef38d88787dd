//! Pauses in futures that do long work on the CPU.

use std::future::poll_fn;
use std::task::Poll;

/// Lets the executor run other tasks before the future continues. A caller that blocks on the future sees no pause.
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
