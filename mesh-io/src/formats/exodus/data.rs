//! Results in an Exodus file: variables of nodes and elements, with numbers for each time step.

use super::File;
use super::blocks::Block;
use crate::formats::netcdf_points::{PointData, RecordParts};
use crate::netcdf::{NumberType, Variable};
use crate::visit::visitor::MeshVisitor;

impl File<'_> {
    /// Visits data of nodes and elements, and reports content that a conversion loses. Variables of the wrong length
    /// are skipped, as the mesh does not depend on data.
    pub(super) fn data(&self, blocks: &[Block<'_>], visitor: &mut dyn MeshVisitor) {
        self.of_nodes(visitor);
        if visitor.asks_for_cell_arrays() {
            self.of_elements(blocks, visitor);
        }
        if visitor.asks_for_data() {
            self.left_out(visitor);
        }
    }

    fn names(&self, table: &str) -> Vec<Vec<u8>> {
        let table = self.header.variable(table);
        table.map(|names| self.header.texts(names)).unwrap_or_default()
    }

    fn of_nodes(&self, visitor: &mut dyn MeshVisitor) {
        let names = self.names("name_nod_var");
        let nodes = self.nodes as u64;
        let each = self.header.numbered("vals_nod_var");
        let mut data = PointData::new(&self.header);
        for (place, name) in names.iter().enumerate() {
            if !visitor.asks_for_data() {
                visitor.point_array(name, 1, true);
                continue;
            }
            let own = each
                .iter()
                .find(|(number, variable)| *number == place + 1 && variable.shape == [nodes]);
            // In older files, a single variable contains the numbers of all node variables.
            let all = self.header.variable("vals_nod_var");
            let all = all.filter(|all| all.shape == [names.len() as u64, nodes]);
            let found = match (own, all) {
                (Some(&(_, own)), _) => Some((own, RecordParts::WHOLE)),
                (None, Some(all)) => {
                    let parts = RecordParts {
                        wanted: place..place + 1,
                        all: names.len(),
                        ..RecordParts::WHOLE
                    };
                    Some((all, parts))
                }
                (None, None) => None,
            };
            match found {
                Some((variable, parts)) => data.send(name, variable, &parts, None, visitor),
                // An array without numbers is a loss.
                None => _ = visitor.point_array(name, 1, true),
            }
        }
    }

    fn of_elements(&self, blocks: &[Block<'_>], visitor: &mut dyn MeshVisitor) {
        for (place, name) in self.names("name_elem_var").iter().enumerate() {
            let of = |block: &Block<'_>| {
                let name = format!("vals_elem_var{}eb{}", place + 1, block.number);
                let found = self.header.variable(&name);
                found.filter(|variable| {
                    // Numbers of other types yield no time step, so their elements must have no entry either.
                    let is_real = matches!(variable.number, NumberType::Real(_));
                    is_real && variable.shape == [block.count]
                })
            };
            let parts: Vec<_> =
                blocks.iter().filter_map(|block| Some((block, of(block)?))).collect();
            let Some((_, first)) = parts.first() else {
                visitor.cell_array(name, 1, true);
                continue;
            };
            let mut read: Vec<Option<Vec<Vec<f64>>>> = parts.iter().map(|_| None).collect();
            for step in 0..self.header.steps(first) {
                if !visitor.cell_array(name, 1, true) {
                    continue;
                }
                let (mut numbers, mut ids) = (Vec::new(), Vec::new());
                for ((block, variable), read) in parts.iter().zip(&mut read) {
                    let steps = read.get_or_insert_with(|| self.steps(variable));
                    let Some(own) = steps.get_mut(step) else { continue };
                    numbers.append(own);
                    ids.extend(block.before + 1..=block.before + block.count);
                }
                visitor.cell_numbers(numbers, Some(ids));
            }
        }
    }

    /// Returns the real numbers of a variable, time step by time step. Whole numbers and text yield empty time steps,
    /// an unreadable variable no time step.
    fn steps(&self, variable: &Variable) -> Vec<Vec<f64>> {
        let Ok(items) = self.header.items(variable) else { return Vec::new() };
        let steps = 0..self.header.steps(variable);
        let own = |step| variable.reals(items.bytes.get(items.range(step)).unwrap_or_default());
        steps.map(own).collect()
    }

    fn left_out(&self, visitor: &mut dyn MeshVisitor) {
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
                visitor.unsupported(what);
            }
        }
        // The first property is the number of each block or set.
        let has_more =
            |name: &&str| self.header.numbered(name).iter().any(|&(number, _)| number > 1);
        if ["eb_prop", "ss_prop", "ns_prop"].iter().any(has_more) {
            visitor.unsupported("further properties of blocks and sets");
        }
        // Data without a time have a single time step at the time zero.
        let has_times = self.header.variable("time_whole").is_some_and(|times| {
            let steps = self.steps(times);
            steps.len() > 1 || steps.iter().flatten().any(|&time| time != 0.0)
        });
        if has_times {
            visitor.unsupported("times of time steps");
        }
        let numbered = |name: &str| {
            let map = self.ids(name);
            !map.iter().copied().eq(1..=map.len() as i64)
        };
        if numbered("node_num_map") || numbered("elem_num_map") {
            visitor.unsupported("numbers of nodes and elements in their maps");
        }
        let is_weighted = |(_, factors): &(usize, &Variable)| {
            !factors.is_record && self.steps(factors).iter().flatten().any(|&factor| factor != 1.0)
        };
        if ["dist_fact_ss", "dist_fact_ns"]
            .iter()
            .any(|name| self.header.numbered(name).iter().any(is_weighted))
        {
            visitor.unsupported("distribution factors of sets");
        }
    }
}
