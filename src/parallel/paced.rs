//! The loops of [`tasks`] for futures, which [pause](super::pace) between tasks.

use std::ops::Range;
use std::pin::Pin;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use web_time::Instant;

use super::pace::{deadline, pause, poll_until};
use super::tasks;

/// Calls `task` in parallel for the numbers below `count`, in any order.
async fn for_each(count: usize, task: &(dyn Fn(usize) + Sync)) {
    let next = AtomicUsize::new(0);
    loop {
        let Some(until) = deadline() else {
            // Without a deadline, all tasks are left to the loop of blocking callers.
            let first = next.into_inner().min(count);
            return tasks::for_each(count - first, &|i| task(first + i));
        };
        tasks::share(&next, count, task, &|| Instant::now() >= until);
        pause().await;
        if next.load(Ordering::Relaxed) >= count {
            return;
        }
    }
}

/// Calls `task(index, part)` for the parts in parallel. Parts may be owned values or mutable borrows.
pub(crate) async fn for_each_part<P: Send>(
    parts: impl IntoIterator<Item = P> + Send,
    task: impl Fn(usize, P) + Sync + Send,
) {
    let parts: Vec<Mutex<Option<P>>> = parts.into_iter().map(|p| Mutex::new(Some(p))).collect();
    for_each(parts.len(), &|i| {
        // No other task takes this part.
        let part = parts[i].lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(part) = part {
            task(i, part);
        }
    })
    .await;
}

/// Calls `task` as [`for_each_part`] does. Results keep the order of the parts.
pub(crate) async fn map_parts<P: Send, T: Send>(
    parts: impl IntoIterator<Item = P> + Send,
    task: impl Fn(usize, P) -> T + Sync + Send,
) -> Vec<T> {
    let parts: Vec<P> = parts.into_iter().collect();
    let mut made: Vec<Option<T>> = Vec::new();
    made.resize_with(parts.len(), || None);
    let pairs: Vec<_> = parts.into_iter().zip(&mut made).collect();
    for_each_part(pairs, |i, (part, made)| *made = Some(task(i, part))).await;
    made.into_iter().flatten().collect()
}

/// Calls `task` with ranges of `size` numbers below `count`; the last may be shorter. Returns the results in the order
/// of the ranges.
pub(crate) async fn map_ranges<T: Send>(
    count: usize,
    size: usize,
    task: impl Fn(Range<usize>) -> T + Sync + Send,
) -> Vec<T> {
    map_parts(tasks::ranges(count, size), |_, range| task(range)).await
}

/// Calls `task(first, chunk)` for each chunk of `size` items, with the index of the chunk's first item. The last chunk
/// may be shorter.
pub(crate) async fn for_each_chunk<T: Send>(
    items: &mut [T],
    size: usize,
    task: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    for_each_part(items.chunks_mut(size), |i, chunk| task(i * size, chunk)).await;
}

/// Returns `make(i)` for every number `i` below `count`, in order.
pub(crate) async fn collect<T: Send + Copy + Default>(
    count: usize,
    make: impl Fn(usize) -> T + Sync + Send,
) -> Vec<T> {
    const CHUNK: usize = 1 << 12;
    let mut made = vec![T::default(); count];
    for_each_chunk(&mut made, CHUNK, |first, made| {
        for (i, made) in made.iter_mut().enumerate() {
            *made = make(first + i);
        }
    })
    .await;
    made
}

/// Computes a future for each part in parallel. Results keep the order of the parts. The futures wait for nothing but
/// their own pauses.
pub(crate) async fn map_futures<P: Send, F: Future<Output: Send> + Send>(
    parts: impl IntoIterator<Item = P> + Send,
    make: impl Fn(P) -> F + Sync + Send,
) -> Vec<F::Output> {
    let made = parts.into_iter().map(|part| (Box::pin(make(part)), None));
    let mut futures: Vec<(Pin<Box<F>>, _)> = made.collect();
    loop {
        let until = deadline();
        for_each_part(futures.iter_mut().filter(|(_, output)| output.is_none()), |_, future| {
            let (future, output) = future;
            *output = poll_until(until, future.as_mut());
        })
        .await;
        if futures.iter().all(|(_, output)| output.is_some()) {
            return futures.into_iter().filter_map(|(_, output)| output).collect();
        }
        pause().await;
    }
}

/// Calls `task` with ranges of `size` numbers below `count` on one thread, in order.
pub(crate) async fn in_order(count: usize, size: usize, mut task: impl FnMut(Range<usize>) + Send) {
    for range in tasks::ranges(count, size) {
        task(range);
        pause().await;
    }
}

/// Returns a copy of a list.
pub(crate) async fn copied<T: Copy + Send + Sync>(items: &[T]) -> Vec<T> {
    const CHUNK: usize = 1 << 16;
    let mut copy = Vec::with_capacity(items.len());
    in_order(items.len(), CHUNK, |range| copy.extend_from_slice(&items[range])).await;
    copy
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::parallel::pace::{now, polled};

    /// With a budget of zero, each thread does one task between two pauses.
    #[test]
    fn a_poll_without_time_does_one_task_on_each_thread() {
        let threads = rayon::current_num_threads();
        let list = |count: usize| map_ranges(count, 10, |range| range.sum::<usize>());
        for count in [0, 1, 10, 11, 20_000] {
            let (sums, polls) = polled(Duration::ZERO, list(count));
            assert_eq!(sums, now(list(count)));
            assert!(polls >= count.div_ceil(10).div_ceil(threads), "{count}: {polls} polls");
            assert_eq!(polled(Duration::from_secs(3600), list(count)).1, 1);
        }
    }

    #[test]
    fn every_item_is_visited_once_and_in_order() {
        for count in [0, 1, 4096, 70_000] {
            let visited = async {
                let numbers = collect(count, |i| i).await;
                let mut items = vec![0; count];
                for_each_chunk(&mut items, 33, |first, chunk| {
                    chunk.iter_mut().zip(first..).for_each(|(item, i)| *item = i + 1);
                })
                .await;
                let mut in_turn = Vec::new();
                in_order(count, 100, |range| in_turn.extend(range)).await;
                (numbers, items, copied(&in_turn).await)
            };
            let ((numbers, items, in_turn), _) = polled(Duration::ZERO, visited);
            assert!(numbers.iter().copied().eq(0..count) && in_turn == numbers);
            assert!(items.into_iter().eq(1..=count));
        }
    }

    #[test]
    fn futures_pause_within_and_keep_their_order() {
        let futures = || {
            map_futures(0..7, |part: usize| async move {
                for _ in 0..part {
                    pause().await;
                }
                part * part
            })
        };
        let (squares, polls) = polled(Duration::ZERO, futures());
        assert_eq!(squares, [0, 1, 4, 9, 16, 25, 36]);
        assert!(polls > 6, "{polls} polls");
        assert_eq!(now(futures()), squares);
    }
}
