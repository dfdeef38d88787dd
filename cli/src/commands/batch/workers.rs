//! Distribution of meshes over threads: large meshes are smoothed one after another on all cores, small ones
//! concurrently with one thread each.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use crate::commands::batch::entry::BatchStatus;
use crate::commands::batch::listing::BatchItem;
use crate::terminal::interrupt;

/// Size in bytes above which a mesh counts as large, some 100,000 vertices as text. Smaller meshes do not occupy all
/// cores.
const LARGE: u64 = 10 << 20;

/// Small meshes per core under way. While one worker waits for the disk, another uses the core.
const PER_CORE: usize = 2;

/// Interval between two checks for signals.
const INTERVAL: Duration = Duration::from_millis(50);

/// Observer of the work on many meshes.
pub(crate) trait Watch {
    /// Receives the result of a finished mesh, by its index in the list.
    fn done(&mut self, mesh: usize, status: BatchStatus);
    /// Called at intervals without results.
    fn waits(&mut self);
    /// Called once after a signal, which keeps further meshes from being started.
    fn interrupted(&mut self);
}

/// Calls `work` for the meshes of a list at the indices `open`. Reports each result to `watch` on the calling thread.
pub(crate) fn run(
    list: &[BatchItem],
    open: &[usize],
    work: &(dyn Fn(&BatchItem) -> BatchStatus + Sync),
    watch: &mut dyn Watch,
) {
    let mut sized: Vec<(u64, usize)> = open.iter().map(|&i| (list[i].bytes(), i)).collect();
    // Large meshes come first, so that the last cores do not wait for one large mesh.
    sized.sort_by_key(|&(bytes, i)| (std::cmp::Reverse(bytes), i));
    let large = sized.partition_point(|&(bytes, _)| bytes > LARGE);
    let order: Vec<usize> = sized.into_iter().map(|(_, i)| i).collect();
    let (large, small) = order.split_at(large);
    let (sender, receiver) = mpsc::channel();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            let send = |i: usize| sender.send((i, work(&list[i]))).is_ok();
            large.iter().take_while(|_| !interrupt::is_requested()).all(|&i| send(i));
            side_by_side(small, &|i| sender.send((i, work(&list[i]))).is_ok());
        });
        let mut is_told = false;
        loop {
            match receiver.recv_timeout(INTERVAL) {
                Ok((i, status)) => watch.done(i, status),
                Err(mpsc::RecvTimeoutError::Disconnected) => break,
                Err(mpsc::RecvTimeoutError::Timeout) => watch.waits(),
            }
            if interrupt::is_requested() && !is_told {
                is_told = true;
                watch.interrupted();
            }
        }
    });
}

/// Calls `work` for the meshes at some indices on worker threads that share the cores. A worker stops if `work`
/// returns false.
fn side_by_side(meshes: &[usize], work: &(dyn Fn(usize) -> bool + Sync)) {
    let cores = rayon::current_num_threads();
    let workers = (PER_CORE * cores).min(meshes.len());
    let next = AtomicUsize::new(0);
    let take_and_work = || {
        while let Some(&i) = meshes.get(next.fetch_add(1, Ordering::Relaxed))
            && !interrupt::is_requested()
            && work(i)
        {}
    };
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                // A run uses the rayon pool of its worker, which bounds the run's threads.
                let threads = (cores / workers).max(1);
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let _pool = pool.use_current_thread().build();
                take_and_work();
            });
        }
    });
}
