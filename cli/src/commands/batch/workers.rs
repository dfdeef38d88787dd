//! Distributes meshes over threads: large ones one after the other on all cores, small ones side by side, each on one
//! thread.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use crate::commands::batch::entry::Told;
use crate::commands::batch::listing::Listed;
use crate::terminal::interrupt;

/// Files of more bytes than this are large, some 100,000 vertices as text. Smaller meshes do not keep all cores busy.
const LARGE: u64 = 10 << 20;

/// Small meshes under way for each core. While one waits for the disk, another takes the core.
const PER_CORE: usize = 2;

/// How often an interrupt is looked for.
const INTERVAL: Duration = Duration::from_millis(50);

/// Is told how the work on many meshes goes.
pub(crate) trait Watch {
    /// Is told that a mesh of the list is done, by its index.
    fn done(&mut self, mesh: usize, told: Told);
    /// Is told that nothing has happened for a while.
    fn waits(&mut self);
    /// Is told that the user ends the call. No mesh is begun after that.
    fn interrupted(&mut self);
}

/// Calls `work` for each of the `open` meshes of a list (indices), and tells `watch` of each on this thread.
pub(crate) fn run(
    list: &[Listed],
    open: &[usize],
    work: &(dyn Fn(&Listed) -> Told + Sync),
    watch: &mut dyn Watch,
) {
    let mut sized: Vec<(u64, usize)> = open.iter().map(|&i| (list[i].bytes(), i)).collect();
    // The largest meshes come first, so that no core is left with a large one at the end.
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
                Ok((i, told)) => watch.done(i, told),
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

/// Calls `work` for some meshes (indices) on threads of their own, which share the cores. `work` returns whether to go
/// on.
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
                // A run that uses all threads uses those of this pool.
                let threads = (cores / workers).max(1);
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let _pool = pool.use_current_thread().build();
                take_and_work();
            });
        }
    });
}
