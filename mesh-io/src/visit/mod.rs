//! The protocol between readers and their listeners: what a reader hands on, and listeners that collect a mesh, groups or data.

pub(crate) mod assemble;
pub(crate) mod field;
pub(crate) mod gather;
pub(crate) mod group_table;
pub(crate) mod heights;
pub(crate) mod parsed;
pub(crate) mod point_data;
pub(crate) mod records;
pub(crate) mod send;
pub(crate) mod sink;
