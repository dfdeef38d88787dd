//! The threads of the process.

use rayon::ThreadPoolBuilder;

/// Makes the calling thread one of the threads of rayon's global pool. Otherwise, there would be a thread more than the machine has
/// cores, which loops of all threads wake in vain: a run took 5 % more time on two cores.
///
/// Does nothing on a machine of one core, and if `RAYON_NUM_THREADS` asks for one thread: a pool without another thread would
/// wait for ever for tasks of threads outside the pool, such as that which opens a GPU, while the calling thread waits for these
/// threads.
pub(crate) fn join_pool() {
    // Rayon has a thread for each of these cores.
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.parse().ok());
    let threads: usize = asked.filter(|&threads| threads > 0).unwrap_or(cores);
    if threads > 1 {
        // An error means that the pool exists already, as in a process that has used rayon before. The loops then run as well.
        let _ = ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global();
    }
}
