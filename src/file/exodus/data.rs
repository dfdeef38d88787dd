//! The results in an Exodus file: numbers of nodes and elements in each time step.

use super::File;
use super::blocks::Block;
use super::netcdf::{Number, Variable};
use crate::file::binary::Order;
use crate::file::numbers::{Form, Places};
use crate::file::sink::{PointNumbers, Sink, Stored};
use std::ops::Range;

impl File<'_> {
    /// Hands on data of nodes and elements, and tells what is not handed on. The mesh does not depend on them: what has not
    /// the lengths it should have is passed over.
    pub(super) fn data(&self, blocks: &[Block], sink: &mut dyn Sink) {
        self.of_nodes(sink);
        if sink.asks_for_data() {
            self.of_elements(blocks, sink);
            self.left_out(sink);
        }
    }

    fn names(&self, table: &str) -> Vec<&[u8]> {
        let table = self.header.variable(table);
        table.map(|names| names.texts(self.source)).unwrap_or_default()
    }

    fn of_nodes(&self, sink: &mut dyn Sink) {
        let names = self.names("name_nod_var");
        let nodes = self.nodes as u64;
        let each = self.header.numbered("vals_nod_var");
        for (place, name) in names.iter().enumerate() {
            if !sink.asks_for_data() {
                sink.point_array(name, 1, true);
                continue;
            }
            let own = each
                .iter()
                .find(|(number, variable)| *number == place + 1 && variable.shape == [nodes]);
            // In older files one variable has the numbers of all of these.
            let all = self.header.variable("vals_nod_var");
            let all = all.filter(|all| all.shape == [names.len() as u64, nodes]);
            let Some((variable, part)) =
                own.map(|&(_, own)| (own, 0)).or_else(|| Some((all?, place)))
            else {
                continue;
            };
            for range in self.steps(variable) {
                let size = range.len() / if own.is_some() { 1 } else { names.len() };
                let start = range.start + part * size;
                self.point_array(name, variable.number, start..start + size, sink);
            }
        }
    }

    fn point_array(&self, name: &[u8], number: Number, range: Range<usize>, sink: &mut dyn Sink) {
        let Number::Real(precision) = number else { return };
        if sink.point_array(name, 1, true) {
            let size = precision.bytes();
            let places = Places::Regular { start: range.start, stride: size };
            let stored = Stored::in_place(places, Form::Binary(Order::Big, precision));
            let numbers = self.reals(number, range);
            sink.point_numbers(PointNumbers { numbers, nodes: None, stored });
        }
    }

    fn of_elements(&self, blocks: &[Block], sink: &mut dyn Sink) {
        for (place, name) in self.names("name_elem_var").iter().enumerate() {
            let of = |block: &Block| {
                let name = format!("vals_elem_var{}eb{}", place + 1, block.number);
                let found = self.header.variable(&name);
                found.filter(|variable| variable.shape == [block.count])
            };
            let parts: Vec<_> =
                blocks.iter().filter_map(|block| Some((block, of(block)?))).collect();
            let Some((_, first)) = parts.first() else { continue };
            for step in 0..self.steps(first).len() {
                if !sink.cell_array(name, 1, true) {
                    continue;
                }
                let (mut numbers, mut tags) = (Vec::new(), Vec::new());
                for (block, variable) in &parts {
                    let Some(range) = self.steps(variable).nth(step) else { continue };
                    numbers.extend(self.reals(variable.number, range));
                    tags.extend(block.before + 1..=block.before + block.count);
                }
                sink.cell_numbers(numbers, Some(tags));
            }
        }
    }

    /// The ranges of a variable in each time step.
    fn steps(&self, variable: &Variable) -> impl ExactSizeIterator<Item = Range<usize>> {
        let steps = if variable.is_record { self.header.records } else { 1 };
        let ranges: Vec<_> = (0..steps).map(|step| variable.range(&self.header, step)).collect();
        ranges.into_iter()
    }

    /// The real numbers of a range; none if they are others.
    fn reals(&self, number: Number, range: Range<usize>) -> Vec<f64> {
        let Number::Real(precision) = number else { return Vec::new() };
        let numbers = self.source.bytes[range].chunks_exact(precision.bytes());
        numbers.map(|number| Order::Big.real(precision, number)).collect()
    }

    fn left_out(&self, sink: &mut dyn Sink) {
        let starts_so =
            |name: &str| self.header.variables.iter().any(|v| v.name.starts_with(name.as_bytes()));
        for (name, what) in [
            ("vals_glo_var", "global variables"),
            ("vals_sset_var", "variables of side sets"),
            ("vals_nset_var", "variables of node sets"),
            ("attrib", "attributes of elements"),
            ("qa_records", "records of quality assurance"),
            ("info_records", "information records"),
        ] {
            if starts_so(name) {
                sink.leaves_out(what);
            }
        }
        // A single step at the time zero is what data without a time stand in.
        let has_times = self.header.variable("time_whole").is_some_and(|times| {
            let mut steps = self.steps(times);
            steps.len() > 1
                || steps.any(|step| self.reals(times.number, step).iter().any(|&t| t != 0.0))
        });
        if has_times {
            sink.leaves_out("times of time steps");
        }
        let numbered = |name: &str| {
            let map = self.ids(name);
            !map.iter().copied().eq(1..=map.len() as i64)
        };
        if numbered("node_num_map") || numbered("elem_num_map") {
            sink.leaves_out("numbers of nodes and elements in their maps");
        }
        let is_weighted = |(_, factors): &(usize, &Variable)| {
            let reals = self.reals(factors.number, factors.range(&self.header, 0));
            !factors.is_record && reals.iter().any(|&factor| factor != 1.0)
        };
        if ["dist_fact_ss", "dist_fact_ns"]
            .iter()
            .any(|name| self.header.numbered(name).iter().any(is_weighted))
        {
            sink.leaves_out("distribution factors of sets");
        }
    }
}
