//! Parts of a mesh in memory, of no format: groups, regions, constraints on vertices, and numbers of nodes.

pub(crate) mod constraints;
pub(crate) mod group;
pub(crate) mod group_keys;
pub(crate) mod group_label;
pub(crate) mod id_index;
pub(crate) mod regions;
pub(crate) mod remark;
