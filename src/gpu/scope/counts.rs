//! Counts of the work that this library gives to a device.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::Duration;

/// The quantities that are counted. Exactly one place of the code counts each quantity.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Count {
    /// Dispatches of kernels.
    Dispatches,
    /// Submissions to the queue, those of uploads included.
    Submissions,
    /// Waits of the host for results or, during large uploads, for the memory of earlier pieces.
    Waits,
    /// Nanoseconds of these waits. An awaited run counts what its application does meanwhile.
    Waiting,
    /// Kernels compiled.
    Kernels,
    /// Nanoseconds of compilation.
    Compiling,
    /// Kernels compiled after the first sweep.
    LateKernels,
    /// Bytes copied to the device.
    Uploaded,
    /// Bytes copied back.
    ReadBack,
    /// Bytes of the buffers created on the device. Buffers that are dropped stay counted.
    Allocated,
}

/// The counters of one device, which grow as long as the device is open.
#[derive(Debug, Default)]
pub(crate) struct Counters {
    counts: [AtomicU64; Count::Allocated as usize + 1],
    has_swept: AtomicBool,
}

impl Counters {
    pub(crate) fn add(&self, count: Count, number: u64) {
        self.counts[count as usize].fetch_add(number, Relaxed);
    }

    /// Counts the dispatch of a kernel.
    pub(crate) fn add_dispatch(&self, is_sweep: bool) {
        self.add(Count::Dispatches, 1);
        if is_sweep {
            self.has_swept.store(true, Relaxed);
        }
    }

    /// Counts a compiled kernel and the time of its compilation.
    pub(crate) fn add_kernel(&self, time: Duration) {
        self.add(Count::Kernels, 1);
        self.add(Count::Compiling, time.as_nanos() as u64);
        self.add(Count::LateKernels, self.has_swept.load(Relaxed).into());
    }

    /// Counts a wait of the host and its time.
    pub(crate) fn add_wait(&self, time: Duration) {
        self.add(Count::Waits, 1);
        self.add(Count::Waiting, time.as_nanos() as u64);
    }

    /// Returns the counts so far.
    pub(crate) fn counts(&self) -> DeviceCounts {
        let of = |count: Count| self.counts[count as usize].load(Relaxed);
        DeviceCounts {
            dispatches: of(Count::Dispatches),
            submissions: of(Count::Submissions),
            waits: of(Count::Waits),
            waiting: Duration::from_nanos(of(Count::Waiting)),
            kernels: of(Count::Kernels),
            compiling: Duration::from_nanos(of(Count::Compiling)),
            late_kernels: of(Count::LateKernels),
            uploaded: of(Count::Uploaded),
            read_back: of(Count::ReadBack),
            allocated: of(Count::Allocated),
        }
    }
}

/// The work that this library gave to a device since the device was opened, counted where the work is encoded. Work that
/// an application submits itself counts as dispatches alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceCounts {
    /// Dispatches of kernels.
    pub dispatches: u64,
    /// Submissions to the queue, those of uploads included.
    pub submissions: u64,
    /// Waits of the host for results or, during large uploads, for the memory of earlier pieces.
    pub waits: u64,
    /// Time of these waits. An awaited run counts what its application does meanwhile.
    pub waiting: Duration,
    /// Kernels compiled.
    pub kernels: u64,
    /// Time of compilation, the sum over all threads. Some drivers compile later, at the first dispatch.
    pub compiling: Duration,
    /// Kernels compiled after the first sweep on the device.
    pub late_kernels: u64,
    /// Bytes copied to the device.
    pub uploaded: u64,
    /// Bytes copied back.
    pub read_back: u64,
    /// Bytes of the buffers created on the device, without those of readbacks. Buffers that are dropped stay counted.
    pub allocated: u64,
}

impl DeviceCounts {
    /// Returns the counts of the work after `earlier`, counts of the same device.
    pub fn since(&self, earlier: &DeviceCounts) -> DeviceCounts {
        DeviceCounts {
            dispatches: self.dispatches - earlier.dispatches,
            submissions: self.submissions - earlier.submissions,
            waits: self.waits - earlier.waits,
            waiting: self.waiting - earlier.waiting,
            kernels: self.kernels - earlier.kernels,
            compiling: self.compiling - earlier.compiling,
            late_kernels: self.late_kernels - earlier.late_kernels,
            uploaded: self.uploaded - earlier.uploaded,
            read_back: self.read_back - earlier.read_back,
            allocated: self.allocated - earlier.allocated,
        }
    }
}
