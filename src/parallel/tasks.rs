//! Tasks on all threads, all run by the same rayon loop.
//!
//! Rayon compiles its machinery for every loop and every type in it: about forty loops made two thirds of this
//! library's compile time. Here only small functions are generic; the loop over tasks is compiled once.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

/// Calls `task` in parallel for the numbers below `count`, in any order.
pub(crate) fn for_each(count: usize, task: &(dyn Fn(usize) + Sync)) {
    if count <= 1 {
        // Handing a task to another thread and waiting for it takes longer than most tasks.
        return (0..count).for_each(task);
    }
    if rayon::current_thread_index().is_some() {
        // Each thread goes through successive tasks, which share memory, and leaves the rest of its range to others. Without the
        // limit, a range that is not divided further keeps one thread busy at the end, for up to a quarter of the loop.
        return (0..count).into_par_iter().with_max_len(1).for_each(task);
    }
    share(&AtomicUsize::new(0), count, task, &|| false);
}

/// Calls `task` in parallel for the numbers from `next` to `count`, on rayon's threads and on the calling thread. Each
/// thread stops once `is_over` is true after a task. Another call with the same `next` does the rest.
pub(super) fn share(
    next: &AtomicUsize,
    count: usize,
    task: &(dyn Fn(usize) + Sync),
    is_over: &(dyn Fn() -> bool + Sync),
) {
    // Rayon would do all tasks on its own threads while the calling thread waits. The calling thread does tasks too, so
    // it need not be woken when the other threads are done first.
    let work = || {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                break;
            }
            task(i);
            if is_over() {
                break;
            }
        }
    };
    rayon::in_place_scope(|scope| {
        for _ in 1..rayon::current_num_threads().min(count) {
            scope.spawn(|_| work());
        }
        work();
    });
}

/// Calls `task(index, part)` for the parts in parallel. Parts may be owned values or mutable borrows.
pub(crate) fn for_each_part<P: Send>(
    parts: impl IntoIterator<Item = P>,
    task: impl Fn(usize, P) + Sync,
) {
    for_each_of(parts.into_iter().collect(), &task);
}

/// Does the work of [`for_each_part`], compiled once for each type of part.
fn for_each_of<P: Send>(parts: Vec<P>, task: &(dyn Fn(usize, P) + Sync)) {
    let parts: Vec<Mutex<Option<P>>> = parts.into_iter().map(|p| Mutex::new(Some(p))).collect();
    for_each(parts.len(), &|i| {
        // No other task takes this part.
        let part = parts[i].lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(part) = part {
            task(i, part);
        }
    });
}

/// Calls `task` as [`for_each_part`] does. Results keep the order of the parts.
pub(crate) fn map_parts<P: Send, T: Send>(
    parts: impl IntoIterator<Item = P>,
    task: impl Fn(usize, P) -> T + Sync,
) -> Vec<T> {
    let mut made: Vec<Option<T>> = Vec::new();
    let parts: Vec<P> = parts.into_iter().collect();
    made.resize_with(parts.len(), || None);
    for_each_part(parts.into_iter().zip(&mut made), |i, (part, made)| *made = Some(task(i, part)));
    made.into_iter().flatten().collect()
}

/// Splits the numbers below `count` into ranges of `size` numbers each; the last may be shorter.
pub(crate) fn ranges(count: usize, size: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count).step_by(size.max(1)).map(move |start| start..count.min(start + size))
}

/// Calls `task` with ranges of `size` numbers below `count`; the last may be shorter. Returns the results in the order
/// of the ranges.
pub(crate) fn map_ranges<T: Send>(
    count: usize,
    size: usize,
    task: impl Fn(Range<usize>) -> T + Sync,
) -> Vec<T> {
    map_parts(ranges(count, size), |_, range| task(range))
}

/// Calls `task(first, chunk)` for each chunk of `size` items, with the index of the chunk's first item. The last chunk
/// may be shorter.
pub(crate) fn for_each_chunk<T: Send>(
    items: &mut [T],
    size: usize,
    task: impl Fn(usize, &mut [T]) + Sync,
) {
    for_each_part(items.chunks_mut(size), |i, chunk| task(i * size, chunk));
}

/// Returns `make(i)` for every number `i` below `count`, in order.
pub(crate) fn collect<T: Send + Copy + Default>(
    count: usize,
    make: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    const CHUNK: usize = 1 << 12;
    let mut made = vec![T::default(); count];
    for_each_chunk(&mut made, CHUNK, |first, made| {
        for (i, made) in made.iter_mut().enumerate() {
            *made = make(first + i);
        }
    });
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_is_visited_once_and_in_order() {
        for count in [0, 1, 7, 4096, 4097, 20_000] {
            assert_eq!(collect(count, |i| i), (0..count).collect::<Vec<_>>());
            let sums = map_ranges(count, 100, |range| range.sum::<usize>());
            assert_eq!(sums.len(), count.div_ceil(100));
            assert_eq!(sums.iter().sum::<usize>(), (0..count).sum());
            let mut items = vec![0; count];
            for_each_chunk(&mut items, 33, |first, chunk| {
                chunk.iter_mut().zip(first..).for_each(|(item, i)| *item = i + 1);
            });
            assert_eq!(items, (1..=count).collect::<Vec<_>>());
        }
        assert_eq!(map_parts(["a", "b", "c"], |i, part| format!("{i}{part}")), ["0a", "1b", "2c"]);
    }

    /// The calling thread does tasks too, whether the thread belongs to a pool or not.
    #[test]
    fn loops_within_loops_do_each_task_once() {
        let count = || {
            let done = AtomicUsize::new(0);
            for_each(7, &|i| for_each(i, &|j| _ = done.fetch_add(1 + j, Ordering::Relaxed)));
            done.into_inner()
        };
        let expected = (0..7).map(|i| (0..i).map(|j| 1 + j).sum::<usize>()).sum();
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(count), expected);
        }
        (0..200).for_each(|_| assert_eq!(count(), expected));
    }
}
