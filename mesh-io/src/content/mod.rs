//! Format-independent facts of a mesh in memory: groups, regions, constraints on vertices, remarks, and ids of nodes.

pub(crate) mod constraints;
pub(crate) mod curve_edges;
pub(crate) mod decoded;
pub(crate) mod faces;
pub(crate) mod group;
pub(crate) mod group_ends;
pub(crate) mod group_keys;
pub(crate) mod group_label;
pub(crate) mod id_index;
pub(crate) mod numbering;
pub(crate) mod regions;
pub(crate) mod remark;
