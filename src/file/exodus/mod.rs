//! Exodus II, in netCDF's classic formats.
//!
//! The format: Sandia's report SAND92-2137, "Exodus: a finite element data model". Elements stand in blocks, each of one type, and
//! are numbered through all of them from one. A side set lists sides of elements, a node set nodes.

mod blocks;
mod data;
mod netcdf;
mod sets;

use crate::error::ReadError;
use crate::file::binary::Order;
use crate::file::format::Format;
use crate::file::heights::Heights;
use crate::file::label::Label;
use crate::file::numbers::{Form, Numbers};
use crate::file::records::{Field, NodeRecords, Tags};
use crate::file::sink::{Column, Layout, Sink, Walk};
use crate::file::source::Source;
use crate::file::text::Cursor;
use crate::mesh::Precision;
use netcdf::{Header, Number};
use std::ops::Range;

pub(crate) struct Exodus;

/// A file with its header.
struct File<'a> {
    source: &'a Source,
    header: Header,
    /// How many nodes there are.
    nodes: usize,
}

/// Stands for the block of what is in no block.
const NO_BLOCK: i64 = i64::MIN;

impl Walk for Exodus {
    const VERTICES: &'static str = "the list of coordinates";

    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        let header = Header::read(source)?;
        let start = Cursor::at_byte_of(source, 0);
        let Some(nodes) = header.dimension("num_nodes") else {
            let problem = "netCDF without the dimension num_nodes, so it is no Exodus";
            return Err(start.error(problem, "Convert it to Exodus or another format that is read"));
        };
        start.check_vertex_count(nodes)?;
        let file = File { source, header, nodes: nodes as usize };
        let numbers = file.points(sink)?;
        let label = |block| (block != NO_BLOCK).then_some(Label::Tag(block));
        sink.columns(vec![Column { what: "block".into(), from_dimension: 0, label }]);
        let blocks = file.blocks(sink)?;
        file.side_sets(&blocks, sink)?;
        if sink.asks_for_groups() {
            file.node_sets(sink)?;
        }
        file.data(&blocks, sink);
        Ok(Layout::in_place(Format::Exodus, numbers))
    }
}

impl File<'_> {
    /// Hands on the nodes. Returns how their coordinates stand.
    fn points(&self, sink: &mut dyn Sink) -> Result<Numbers, ReadError> {
        let (precision, axes) = self.axes()?;
        let [x, y] = [0, 1].map(|axis| axes.get(axis).cloned().unwrap_or_default());
        let (order, size) = (Order::Big, precision.bytes());
        let bytes = &self.source.bytes;
        let number = |at: usize| order.real(precision, &bytes[at..at + size]);
        let Some(y_after) = y.start.checked_sub(x.start).filter(|_| y.len() == x.len()) else {
            let problem = "the y of the nodes stand before their x";
            let start = Cursor::at_byte_of(self.source, y.start);
            return Err(start.error(problem, "Write the mesh again"));
        };
        sink.expect_nodes(self.nodes);
        let field = |axis: &Range<usize>| Field::new(bytes.get(axis.clone()), (size, size), order);
        let (count, x_at, tags) = (self.nodes, x.start, Tags::From(1));
        let records = NodeRecords { count, x: field(&x), y: field(&y), x_at, tags };
        for index in sink.node_records(&records)..self.nodes {
            let x_at = x.start + index * size;
            let place = &Cursor::at_byte_of(self.source, x_at);
            let (tag, at) = (index as u64 + 1, [number(x_at), number(x_at + y_after)]);
            if !at.iter().all(|x| x.is_finite()) {
                let problem = format!("a coordinate of node {tag} is not a finite number");
                return Err(place.error(problem, "Write the mesh again"));
            }
            sink.node(place, tag, 2, x_at, at);
        }
        sink.end_nodes(&Cursor::at_byte_of(self.source, x.start))?;
        if let Some(z) = axes.get(2) {
            let mut heights = Heights::new(sink);
            heights.see_all(field(z), z.len() / size, z.start);
            heights.send("z", Form::Binary(order, precision), sink);
        }
        Ok(Numbers::Binary { order, precision, y_after })
    }

    /// How many digits coordinates have, and where those of each axis stand.
    fn axes(&self) -> Result<(Precision, Vec<Range<usize>>), ReadError> {
        let header = &self.header;
        let mut axes = Vec::new();
        let mut numbers = Vec::new();
        let each: Vec<_> =
            ["coordx", "coordy", "coordz"].into_iter().map_while(|n| header.variable(n)).collect();
        if let (true, Some(all)) = (each.is_empty(), header.variable("coord")) {
            // The coordinates of all axes in one table.
            if let &[count, nodes] = &all.shape[..]
                && nodes == self.nodes as u64
                && !all.is_record
            {
                let range = all.range(header, 0);
                let length = range.len() / (count as usize).max(1);
                axes.extend((0..count as usize).map(|axis| {
                    let start = range.start + axis * length;
                    start..start + length
                }));
                numbers.push(all.number);
            }
        }
        for variable in each {
            if variable.shape == [self.nodes as u64] && !variable.is_record {
                axes.push(variable.range(header, 0));
                numbers.push(variable.number);
            }
        }
        let start = Cursor::at_byte_of(self.source, 0);
        match (&numbers[..], axes.len()) {
            ([Number::Real(first), rest @ ..], 2..=3)
                if rest.iter().all(|other| *other == Number::Real(*first)) =>
            {
                Ok((*first, axes))
            }
            _ => {
                let problem =
                    format!("it has no coordinates in two or three axes of {} nodes", self.nodes);
                Err(start.error(problem, "Save a mesh of the plane, with coordx and coordy"))
            }
        }
    }
}
