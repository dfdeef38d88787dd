//! The protocol between readers and their listeners: what a reader hands on, and listeners that collect a mesh, groups or data.

pub(crate) mod assemble;
pub(crate) mod field;
pub(crate) mod gather;
pub(crate) mod group_table;
pub(crate) mod heights;
pub(crate) mod items;
pub(crate) mod locate;
pub(crate) mod parsed;
pub(crate) mod point_data;
pub(crate) mod reader;
pub(crate) mod records;
pub(crate) mod rows;
pub(crate) mod send;
pub(crate) mod sink;
pub(crate) mod storage;
