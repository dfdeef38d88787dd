//! Work on all cores that more than one room needs.

pub(crate) mod counting_sort;
mod tasks;

pub(crate) use tasks::{collect, for_each_chunk, for_each_part, map_parts, map_ranges};
