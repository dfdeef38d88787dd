//! Blocking calls, for targets on which a thread can block.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

use crate::error::GpuError;

/// Returns the result of a future, blocking the thread if need be. In a browser, which cannot block, returns
/// [`GpuError::WouldBlock`] if the future is not ready at once.
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
