//! Calls that wait for a device: blocking on targets on which a thread can block, or awaited.

use std::future::IntoFuture;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use crate::error::GpuError;
use crate::parallel::BoxedFuture;
use crate::parallel::pace::{budget_after, paced};

/// The party that polls the device while a readback is in flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Waiting {
    /// This library, blocking the thread until the device is done.
    Block,
    /// The application, which polls the device anyway. The future completes after a poll that finds the copy done.
    Await,
}

/// A call that will wait for a device. [`block`](Self::block) makes the call and blocks the thread until
/// the device is done; `.await` makes it without blocking. Every call of this crate that waits for a device is of this
/// type, or a [`Run`](crate::Run), which has the same two methods.
///
/// ```no_run
/// # use gpu_smooth::{Gpu, GpuError};
/// # fn blocks() -> Result<(), GpuError> {
/// let gpu = Gpu::open(None).block()?;
/// # Ok(())
/// # }
/// # async fn awaits() -> Result<(), GpuError> {
/// let gpu = Gpu::open(None).await?;
/// # Ok(())
/// # }
/// ```
#[must_use = "the call begins by `block` or `.await`"]
pub struct Pending<'a, T, E = GpuError> {
    begin: Box<dyn FnOnce(Waiting) -> BoxedFuture<'a, Result<T, E>> + Send + 'a>,
}

impl<'a, T, E> Pending<'a, T, E> {
    pub(crate) fn new(
        begin: impl FnOnce(Waiting) -> BoxedFuture<'a, Result<T, E>> + Send + 'a,
    ) -> Self {
        Self { begin: Box::new(begin) }
    }
}

impl<T, E: From<GpuError>> Pending<'_, T, E> {
    /// Makes the call, polls the device and blocks the thread until the device is done.
    ///
    /// # Errors
    /// The errors of the call, and [`GpuError::WouldBlock`] in a browser, where no thread may block.
    pub fn block(self) -> Result<T, E> {
        blocking((self.begin)(Waiting::Block))
    }
}

/// A call that is awaited does not block the thread while the device works. The future completes only if the application
/// polls the device meanwhile, as an application that draws frames does (`Device::poll` with `PollType::Poll` is enough; a
/// browser polls by itself). While the call itself computes, as the levels of corrected sweeps, polls end at pauses like those
/// of a [`Run`](crate::Run). The future is `Send`, except in a browser.
impl<'a, T: 'a, E: 'a> IntoFuture for Pending<'a, T, E> {
    type Output = Result<T, E>;
    type IntoFuture = BoxedFuture<'a, Result<T, E>>;

    fn into_future(self) -> Self::IntoFuture {
        Box::pin(paced(budget_after, (self.begin)(Waiting::Await)))
    }
}

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

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::parallel::pace::pause;

    #[test]
    fn an_awaited_call_pauses_while_it_computes_and_a_blocking_call_does_not() {
        let call = || -> Pending<'_, Waiting> {
            Pending::new(|waiting| {
                Box::pin(async move {
                    let start = Instant::now();
                    while start.elapsed() < Duration::from_millis(20) {
                        pause().await;
                    }
                    Ok(waiting)
                })
            })
        };
        let mut context = Context::from_waker(Waker::noop());
        let (mut polls, mut awaited) = (1, call().into_future());
        let waiting = loop {
            match awaited.as_mut().poll(&mut context) {
                Poll::Ready(result) => break result.unwrap(),
                Poll::Pending => polls += 1,
            }
        };
        assert!(waiting == Waiting::Await && polls > 2, "{waiting:?}, {polls} polls");
        let mut blocking = (call().begin)(Waiting::Block);
        assert!(matches!(blocking.as_mut().poll(&mut context), Poll::Ready(Ok(Waiting::Block))));
    }
}
