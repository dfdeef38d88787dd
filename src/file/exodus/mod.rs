//! Exodus II, in netCDF's classic formats and in netCDF-4.
//!
//! The format: Sandia's report SAND92-2137, "Exodus: a finite element data model". Elements stand in blocks, each of one type, and
//! are numbered through all of them from one. A side set lists sides of elements, a node set nodes.

mod blocks;
mod classic;
mod data;
mod netcdf;
mod netcdf4;
mod sets;

use crate::error::ReadError;
use crate::file::binary::Order;
use crate::file::format::Format;
use crate::file::hdf5::{Encoding, Hdf5, SIGNATURE};
use crate::file::heights::Heights;
use crate::file::label::Label;
use crate::file::numbers::{Encoded, Form, Numbers};
use crate::file::records::{Field, NodeRecords, Tags};
use crate::file::sink::{Column, Home, Layout, Sink, Walk};
use crate::file::source::Source;
use crate::file::text::Cursor;
use crate::mesh::Precision;
use netcdf::{Header, Items, Number, Variable};
use std::ops::Range;

pub(crate) struct Exodus;

/// A file with its header.
struct File<'a> {
    source: &'a Source,
    header: Header<'a>,
    /// How many nodes there are.
    nodes: usize,
}

/// Stands for the block of what is in no block.
const NO_BLOCK: i64 = i64::MIN;

impl Walk for Exodus {
    const VERTICES: &'static str = "the list of coordinates";

    fn walk(source: &Source, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        let header = match source.bytes.starts_with(SIGNATURE) {
            true => netcdf4::read(source)?,
            false => classic::read(source)?,
        };
        let start = Cursor::at_byte_of(source, 0);
        let Some(nodes) = header.dimension("num_nodes") else {
            let problem = "netCDF without the dimension num_nodes, so it is no Exodus";
            return Err(start.error(problem, "Convert it to Exodus or another format that is read"));
        };
        start.check_vertex_count(nodes)?;
        let file = File { source, header, nodes: nodes as usize };
        let layout = file.points(sink)?;
        let label = |block| (block != NO_BLOCK).then_some(Label::Tag(block));
        sink.columns(vec![Column { what: "block".into(), from_dimension: 0, label }]);
        let blocks = file.blocks(sink)?;
        file.side_sets(&blocks, sink)?;
        if sink.asks_for_groups() {
            file.node_sets(sink)?;
        }
        file.data(&blocks, sink);
        file.header.hdf5.as_ref().map_or(Ok(()), Hdf5::check_apart)?;
        Ok(layout)
    }
}

/// Where the coordinates of the nodes stand.
struct Axes {
    precision: Precision,
    order: Order,
    /// Where those of each axis are, in the file or among those that are encoded.
    ranges: Vec<Range<usize>>,
    encoded: Option<Encoding>,
}

impl File<'_> {
    /// Hands on the nodes. Returns how their coordinates stand.
    fn points(&self, sink: &mut dyn Sink) -> Result<Layout, ReadError> {
        let Axes { precision, order, ranges, encoded } = self.axes()?;
        let [x, y] = [0, 1].map(|axis| ranges.get(axis).cloned().unwrap_or_default());
        let size = precision.bytes();
        let bytes = encoded.as_ref().map_or(&self.source.bytes[..], Encoding::bytes);
        let number = |at: usize| order.real(precision, &bytes[at..at + size]);
        // Numbers that are encoded have no place of their own.
        let place = |at: usize| match &encoded {
            None => Cursor::at_byte_of(self.source, at),
            Some(encoding) => Cursor::at_byte_of(self.source, encoding.byte_of(at)),
        };
        let Some(y_after) = y.start.checked_sub(x.start).filter(|_| y.len() == x.len()) else {
            let problem = "the y of the nodes stand before their x";
            return Err(place(y.start).error(problem, "Write the mesh again"));
        };
        sink.expect_nodes(self.nodes);
        let field = |axis: &Range<usize>| Field::new(bytes.get(axis.clone()), (size, size), order);
        let (count, x_at, tags) = (self.nodes, x.start, Tags::From(1));
        let records = NodeRecords { count, x: field(&x), y: field(&y), x_at, tags };
        for index in sink.node_records(&records)..self.nodes {
            let x_at = x.start + index * size;
            let (tag, at) = (index as u64 + 1, [number(x_at), number(x_at + y_after)]);
            if !at.iter().all(|x| x.is_finite()) {
                let problem = format!("a coordinate of node {tag} is not a finite number");
                return Err(place(x_at).error(problem, "Write the mesh again"));
            }
            sink.node(&place(x_at), tag, 2, x_at, at);
        }
        sink.end_nodes(&place(x.start))?;
        if let Some(z) = ranges.get(2) {
            let mut heights = Heights::new(sink);
            heights.see_all(field(z), z.len() / size, z.start);
            let home = if encoded.is_some() { Home::Points } else { Home::File };
            heights.send_from("z", Form::Binary(order, precision), (home, 0), sink);
        }
        let numbers = Numbers::Binary { order, precision, y_after };
        let encoded = encoded.map(|encoding| Box::new(encoding) as Box<dyn Encoded>);
        Ok(Layout { encoded, ..Layout::in_place(Format::Exodus, numbers) })
    }

    /// How the coordinates stand, of each axis by itself.
    fn axes(&self) -> Result<Axes, ReadError> {
        let header = &self.header;
        let nodes = self.nodes as u64;
        let each: Vec<_> =
            ["coordx", "coordy", "coordz"].into_iter().map_while(|n| header.variable(n)).collect();
        let all = header.variable("coord").filter(|_| each.is_empty());
        let fits = |variable: &&Variable| match &variable.shape[..] {
            &[own] => own == nodes && !variable.is_record,
            _ => false,
        };
        // The coordinates of all axes in one table, or each in one of its own.
        let (count, variables) = match all.map(|all| (all, &all.shape[..], all.is_record)) {
            Some((all, &[count, own], false)) if own == nodes => (count as usize, vec![all]),
            _ => {
                let each: Vec<_> = each.into_iter().filter(fits).collect();
                (each.len(), each)
            }
        };
        let first = variables.first().map(|first| (first.number, first.order));
        let is_same = |other: &&Variable| Some((other.number, other.order)) == first;
        let (Some((Number::Real(precision), order)), 2..=3, true) =
            (first, count, variables.iter().all(is_same))
        else {
            let problem =
                format!("it has no coordinates in two or three axes of {} nodes", self.nodes);
            let start = Cursor::at_byte_of(self.source, 0);
            return Err(start.error(problem, "Save a mesh of the plane, with coordx and coordy"));
        };
        let mut items =
            variables.iter().map(|own| header.items(own)).collect::<Result<Vec<_>, _>>()?;
        let length = self.nodes * precision.bytes();
        let split = |start: usize, axes: usize| {
            (0..axes).map(move |axis| start + axis * length..start + (axis + 1) * length)
        };
        let of_each = count / variables.len();
        // In the file itself, if they stand there one after another; else as what is written anew.
        let places: Option<Vec<usize>> = items.iter().map(Items::place).collect();
        if let Some(places) = places.filter(|places| places.is_sorted()) {
            let ranges = places.into_iter().flat_map(|start| split(start, of_each)).collect();
            return Ok(Axes { precision, order, ranges, encoded: None });
        }
        let arrays = items.iter_mut().filter_map(Items::take_array).collect();
        let encoded = header.hdf5.as_ref().map(|file| Encoding::new(file, arrays));
        Ok(Axes { precision, order, ranges: split(0, count).collect(), encoded })
    }
}
