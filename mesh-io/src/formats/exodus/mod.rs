//! Exodus II, in netCDF's classic formats and in netCDF-4.
//!
//! The format: Sandia's report SAND92-2137, "Exodus: a finite element data model". Elements form blocks of one type
//! each; element numbers start at 1 and continue from block to block. A side set lists sides of elements, a node set
//! lists nodes.

mod blocks;
mod data;
mod sets;
pub(crate) mod write;

use crate::content::group_label::GroupLabel;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::format::Format;
use crate::formats::axes::{Axes, BinaryReals};
use crate::formats::netcdf_axes::axes;
use crate::hdf5::Hdf5;
use crate::netcdf::{self, Header, NumberType, Variable};
use crate::text::cursor::Cursor;
use crate::visit::items::RegionAttribute;
use crate::visit::reader::FormatReader;
use crate::visit::storage::CoordinateStorage;
use crate::visit::visitor::MeshVisitor;

pub(crate) struct Exodus;

/// An Exodus file with its header.
struct File<'a> {
    source: &'a Source,
    header: Header<'a>,
    /// Number of nodes.
    nodes: usize,
}

/// Region number of elements outside of all blocks: the lines of side sets.
const NO_BLOCK: i64 = i64::MIN;

impl FormatReader for Exodus {
    const VERTICES: &'static str = "the list of coordinates";

    fn visit(
        source: &Source,
        visitor: &mut dyn MeshVisitor,
    ) -> Result<CoordinateStorage, ReadError> {
        let header = netcdf::open(source)?;
        let start = Cursor::at_byte_offset(source, 0);
        let Some(nodes) = header.dimension("num_nodes") else {
            if header.hdf5.is_some() {
                let problem = "HDF5 that holds no mesh of Exodus II, UGRID, MED or CGNS";
                let remedy = "If it has the numbers of an XDMF, name the .xdmf";
                return Err(start.error(problem, remedy));
            }
            let problem = "netCDF that holds no mesh of Exodus II (it has no dimension num_nodes) or UGRID (no variable with the cf_role mesh_topology)";
            return Err(start.error(
                problem,
                "Save the mesh in one of these formats or in another supported format",
            ));
        };
        start.check_vertex_count(nodes)?;
        if let Some(error) =
            header.unread(|name| name.starts_with(b"coord") || name.starts_with(b"connect"))
        {
            return Err(error);
        }
        let file = File { source, header, nodes: nodes as usize };
        let layout = file.axes()?.send(Format::Exodus, file.nodes, 1, visitor)?;
        let label = |block| (block != NO_BLOCK).then_some(GroupLabel::Tag(block));
        visitor.region_attributes(vec![RegionAttribute {
            kind: "block".into(),
            from_dimension: 0,
            label,
        }]);
        let blocks = file.blocks(visitor)?;
        file.side_sets(&blocks, visitor)?;
        if visitor.asks_for_groups() {
            file.node_sets(visitor)?;
        }
        file.data(&blocks, visitor);
        file.header.hdf5.as_ref().map_or(Ok(()), Hdf5::check_no_overlaps)?;
        Ok(layout)
    }
}

impl<'a> File<'a> {
    /// Locates the coordinates: the variables `coordx`, `coordy` and `coordz`, or else the table `coord`.
    ///
    /// # Errors
    /// If the coordinates do not have two or three axes of one number type, or cannot be read.
    fn axes(&self) -> Result<Axes<'a>, ReadError> {
        let header = &self.header;
        let nodes = self.nodes as u64;
        let each: Vec<_> =
            ["coordx", "coordy", "coordz"].into_iter().map_while(|n| header.variable(n)).collect();
        let all = header.variable("coord").filter(|_| each.is_empty());
        let fits = |variable: &&Variable| match &variable.shape[..] {
            &[own] => own == nodes && !variable.is_record,
            _ => false,
        };
        // Newer files have a variable per axis, older files a table of all axes.
        let (count, variables) = match all.map(|all| (all, &all.shape[..], all.is_record)) {
            Some((all, &[count, own], false)) if own == nodes => (count as usize, vec![all]),
            _ => {
                let each: Vec<_> = each.into_iter().filter(fits).collect();
                (each.len(), each)
            }
        };
        let first = variables.first().map(|first| (first.number, first.order));
        let is_same = |other: &&Variable| Some((other.number, other.order)) == first;
        let (Some((NumberType::Real(precision), order)), 2..=3, true) =
            (first, count, variables.iter().all(is_same))
        else {
            let problem =
                format!("it has no coordinates in two or three axes of {} nodes", self.nodes);
            let start = Cursor::at_byte_offset(self.source, 0);
            return Err(start.error(problem, "Save a mesh of the plane, with coordx and coordy"));
        };
        axes(header, &variables, BinaryReals { order, precision }, count, self.nodes)
    }
}
