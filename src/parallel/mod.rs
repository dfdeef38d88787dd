//! Work on all cores that more than one room needs.

pub(crate) mod counting_sort;
