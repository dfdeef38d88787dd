//! Parallel loops and sorting, shared by several modules.

pub(crate) mod counting_sort;
pub(crate) mod pace;
pub(crate) mod paced;
mod tasks;

pub(crate) use tasks::{collect, for_each_chunk, for_each_part, map_parts, map_ranges};
