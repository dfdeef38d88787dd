//! A queue whose submissions and writes are counted.

use std::ops::Deref;
use std::sync::Arc;

use crate::gpu::scope::counts::{Count, Counters};

/// A queue whose submissions and writes by this library are counted. The application's own pass by the raw queue.
#[derive(Clone)]
pub(crate) struct CountedQueue {
    raw: wgpu::Queue,
    counters: Arc<Counters>,
}

impl CountedQueue {
    pub(crate) fn new(raw: wgpu::Queue, counters: Arc<Counters>) -> Self {
        Self { raw, counters }
    }

    /// Submits command buffers, like [`wgpu::Queue::submit`].
    pub(crate) fn submit(
        &self,
        buffers: impl IntoIterator<Item = wgpu::CommandBuffer>,
    ) -> wgpu::SubmissionIndex {
        self.counters.add(Count::Submissions, 1);
        self.raw.submit(buffers)
    }

    /// Writes to a buffer, like [`wgpu::Queue::write_buffer`].
    pub(crate) fn write_buffer(&self, buffer: &wgpu::Buffer, offset: u64, data: &[u8]) {
        self.counters.add(Count::Uploaded, data.len() as u64);
        self.raw.write_buffer(buffer, offset, data);
    }
}

impl Deref for CountedQueue {
    type Target = wgpu::Queue;

    fn deref(&self) -> &wgpu::Queue {
        &self.raw
    }
}
