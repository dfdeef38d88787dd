//! Protocol between readers and visitors: the items of a file, and visitors that build a mesh, groups or data from the
//! items.

pub(crate) mod cell_values;
pub(crate) mod element_regions;
pub(crate) mod field;
pub(crate) mod ghosts;
pub(crate) mod group_table;
pub(crate) mod group_visitor;
pub(crate) mod items;
pub(crate) mod locate;
pub(crate) mod mesh_builder;
pub(crate) mod parsed_mesh;
pub(crate) mod point_data;
pub(crate) mod reader;
pub(crate) mod records;
pub(crate) mod rows;
pub(crate) mod send;
pub(crate) mod shared;
pub(crate) mod storage;
pub(crate) mod visitor;
pub(crate) mod weld;
pub(crate) mod z_values;
