//! Tasks on all threads. Rayon's loop over tasks is compiled once; only small functions are generic.

use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Calls `task` with the index and the value of each part, distributed over all threads. Returns the results in part
/// order.
pub(crate) fn map_parts<P: Send, T: Send>(
    parts: impl IntoIterator<Item = P>,
    task: impl Fn(usize, P) -> T + Sync,
) -> Vec<T> {
    let parts: Vec<Mutex<(Option<P>, Option<T>)>> =
        parts.into_iter().map(|part| Mutex::new((Some(part), None))).collect();
    for_each(parts.len(), &|i| {
        // No other task locks this part.
        let mut slot = parts[i].lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(part) = slot.0.take() {
            slot.1 = Some(task(i, part));
        }
    });
    let results = parts.into_iter().filter_map(|slot| {
        let (_, result) = slot.into_inner().unwrap_or_else(PoisonError::into_inner);
        result
    });
    results.collect()
}

/// Calls `task` on all threads with ranges of `size` numbers below `count`; the last range may be shorter. Returns the
/// results in the order of the ranges.
pub(crate) fn map_ranges<T: Send>(
    count: usize,
    size: usize,
    task: impl Fn(Range<usize>) -> T + Sync,
) -> Vec<T> {
    let starts = (0..count).step_by(size.max(1));
    map_parts(starts.map(|start| start..count.min(start + size)), |_, range| task(range))
}

/// Runs `there` on another thread, if there is one, while `here` runs on the current thread.
pub(crate) fn run_both(there: &mut (dyn FnMut() + Send), here: &mut dyn FnMut()) {
    rayon::in_place_scope(|scope| {
        scope.spawn(|_| there());
        here();
    });
}

fn for_each(count: usize, task: &(dyn Fn(usize) + Sync)) {
    if count <= 1 {
        // Handing one task to another thread and waiting for its end takes longer than most tasks.
        return (0..count).for_each(task);
    }
    // Ranges are divided down to single tasks, so that no thread keeps a long range at the end.
    (0..count).into_par_iter().with_max_len(1).for_each(task);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_the_parts() {
        for count in [0, 1, 7, 4096, 4097] {
            let squares = map_parts(0..count, |i, part| i * part);
            assert_eq!(squares, (0..count).map(|i| i * i).collect::<Vec<_>>());
            let sums = map_ranges(count, 100, |range| range.sum::<usize>());
            assert_eq!(sums.len(), count.div_ceil(100));
            assert_eq!(sums.iter().sum::<usize>(), (0..count).sum());
        }
    }

    #[test]
    fn two_tasks_run_at_the_same_time() {
        let (sender, receiver) = std::sync::mpsc::channel();
        let mut received = 0;
        run_both(&mut || sender.send(7).unwrap(), &mut || received = receiver.recv().unwrap());
        assert_eq!(received, 7);
    }
}
