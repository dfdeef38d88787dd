//! Blocking calls, where a thread can block.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

use crate::error::GpuError;

/// The result of a future, for which the thread is blocked if need be. What a browser would have to wait for is refused.
pub(crate) fn blocking<T, E: From<GpuError>>(
    future: impl Future<Output = Result<T, E>>,
) -> Result<T, E> {
    if cfg!(target_arch = "wasm32") {
        let mut context = Context::from_waker(Waker::noop());
        return match pin!(future).poll(&mut context) {
            Poll::Ready(result) => result,
            Poll::Pending => Err(GpuError::WouldBlock.into()),
        };
    }
    pollster::block_on(future)
}
