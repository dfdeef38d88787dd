//! The input of the stages of a run.

use crate::load::{Choice, LoadedMesh};
use crate::report::Task;
use crate::request::SmoothRequest;
use std::time::Instant;

/// A mesh as its stages see it, with the task that it comes from.
#[derive(Clone, Copy)]
pub(super) struct Input<'a> {
    pub(super) task: &'a Task<'a>,
    pub(super) file: &'a LoadedMesh,
    pub(super) choice: &'a Choice,
    /// The size of the input file, or 0 if the input is no file.
    pub(super) bytes: u64,
    /// The time at which the run began, from which its time limit counts.
    pub(super) began: Instant,
}

impl<'a> Input<'a> {
    pub(super) fn request(&self) -> &'a SmoothRequest {
        self.task.request
    }
}
