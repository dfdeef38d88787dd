//! Visitor that builds the format-independent content of a mesh file.

use super::capabilities::PERIODIC;
use super::content::{Content, ContentGroup, DataArray, unpacked};
use crate::content::decoded::decoded;
use crate::content::group_keys::GroupKeys;
use crate::content::group_label::GroupLabel;
use crate::content::id_index::IdIndexBuilder;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::cursor::Cursor;
use crate::visit::field::{has_room, scatter};
use crate::visit::items::{
    CellKind, Element, GroupScope, PeriodicNodes, PointNumbers, RegionAttribute,
};
use crate::visit::reader::ReaderFunctions;
use crate::visit::visitor::MeshVisitor;
use std::collections::HashMap;

/// Reads a file again, and returns its format-independent content. `region_array` names the cell data that number the
/// regions.
pub(crate) fn content(
    reader: &ReaderFunctions,
    source: &Source,
    region_array: Option<&str>,
) -> Result<Content, ReadError> {
    let mut collector = ContentBuilder::default();
    (reader.visit)(source, &mut collector)?;
    Ok(collector.finish(region_array))
}

/// Visitor that builds a [`Content`].
#[derive(Default)]
struct ContentBuilder {
    content: Content,
    ids: IdIndexBuilder,
    columns: Vec<RegionAttribute>,
    /// Current group scopes: kind, label, and dimension; `None` means that each element sets the dimension.
    within: Vec<Scope>,
    keys: GroupKeys,
    vertex_keys: GroupKeys,
    sets: HashMap<Vec<u32>, u32>,
    /// The set of groups for each pair of dimension and region under the current group scopes.
    last: HashMap<(u8, [i64; 2]), u32>,
    /// The array that was announced last.
    announced: Option<PendingArray>,
    /// Number of time steps so far, for each name of vertex data with several time steps.
    steps: HashMap<String, usize>,
    /// Cell data, with the element id of each tuple; `None` for the ids 0, 1, 2 and so on.
    by_tag: Vec<(DataArray, Option<Vec<u64>>)>,
}

/// A group scope: kind, label and dimension.
type Scope = (String, GroupLabel, Option<u8>);

/// Name of arrays that lack a name in the file.
const UNNAMED: &str = "unnamed";

/// Array that the reader has announced, and whose numbers come next.
struct PendingArray {
    name: String,
    components: usize,
    is_real: bool,
    is_height: bool,
    /// Factor and offset of packed numbers.
    packing: Option<[f64; 2]>,
}

/// Returns the name of the next array called `name` behind `arrays`. The time steps of a result have equal names, and later
/// steps get a number. `steps` has the number of time steps so far, for each name with several time steps.
fn step_name(arrays: &[DataArray], steps: &mut HashMap<String, usize>, name: String) -> String {
    if !arrays.iter().any(|data| data.name == name) {
        return name;
    }
    let step = steps.entry(name.clone()).or_insert(1);
    *step += 1;
    format!("{name} {step}")
}

/// Returns the common word for kinds of groups that formats name differently.
pub(crate) fn common_kind(kind: &str) -> String {
    let small = kind.to_ascii_lowercase();
    let common = match small.as_str() {
        "gmsh:physical" => "physical",
        "gmsh:geometrical" => "entity",
        "medit:ref" => "reference",
        "materialids" | "material_id" | "materials" => "material",
        _ => kind,
    };
    common.to_owned()
}

impl ContentBuilder {
    /// Sets the array whose numbers come next. Numbers of an earlier array that did not come are listed as lost.
    fn announce(&mut self, next: Option<PendingArray>) {
        if let Some(PendingArray { name, .. }) = std::mem::replace(&mut self.announced, next) {
            self.unsupported(&format!("{name}, whose numbers cannot be read"));
        }
    }

    /// Completes the content after the last item of the file.
    fn finish(mut self, region_array: Option<&str>) -> Content {
        self.announce(None);
        self.add_cell_data();
        if let Some(array) = region_array {
            self.add_regions(array);
        }
        let Self { mut content, keys, vertex_keys, .. } = self;
        for (kind, dimension, tag, name) in keys.names_of_dimensions() {
            let label = GroupLabel::Tag(tag);
            if ![&keys, &vertex_keys].iter().any(|keys| keys.contains(kind, dimension, &label)) {
                let (kind, name) = (kind.to_owned(), Some(name.to_owned()));
                content.empty_groups.push(ContentGroup { kind, dimension, label, name });
            }
        }
        let of_vertices = content.vertex_groups.iter_mut().map(|(group, _)| group);
        for group in content.groups.iter_mut().chain(of_vertices) {
            group.name = keys.name_of(&group.kind, group.dimension, &group.label);
        }
        // Data that `region_array` names stay data. No format but gmsh's has a use for the numbers of entities.
        let counters = content.remove_counters();
        let is_lost = |kind: &String| {
            let is_data = |data: &DataArray| common_kind(&data.name) == *kind;
            kind != "entity" && !content.cell_data.iter().any(is_data)
        };
        let mut lost: Vec<String> = counters.into_iter().filter(is_lost).collect();
        lost.sort_unstable();
        let lost =
            lost.iter().map(|kind| format!("numbers that differ for nearly every element: {kind}"));
        content.unsupported.extend(lost);
        let first = content.z_values.first().copied();
        if content.z_values.iter().all(|&z| Some(z) == first) {
            content.common_z = first.unwrap_or(0.0);
            content.z_values.clear();
        }
        let (count, left_out) = (content.points.len(), &mut content.unsupported);
        content.point_data.retain(|data| {
            let fits = data.components > 0
                && Some(data.values.len()) == count.checked_mul(data.components);
            if !fits {
                left_out.push(format!(
                    "{}, whose number of values does not fit the number of vertices",
                    data.name
                ));
            }
            fits
        });
        let data = std::mem::take(&mut content.cell_data).into_iter();
        let is_group = |data: &DataArray| content.has_groups_of(&common_kind(&data.name), data);
        content.cell_data = data.filter(|data| !is_group(data)).collect();
        content
    }

    /// Adds the cell data that the reader has passed to the content.
    fn add_cell_data(&mut self) {
        let Self { content, by_tag, .. } = self;
        let steps = &mut HashMap::new();
        // An element may have become several cells, and data may be given for some cells only.
        for (data, tags) in by_tag.drain(..).filter(|(data, _)| data.components > 0) {
            let rows: HashMap<u64, usize> = match tags {
                Some(tags) => tags.into_iter().zip(0..).collect(),
                None => (0..).zip(0..data.values.len() / data.components.max(1)).collect(),
            };
            let each = data.components;
            if !has_room(data.values.len(), each, content.cells.len()) {
                let problem = "whose number of values does not fit the number of elements";
                content.unsupported.push(format!("{}, {problem}", data.name));
                continue;
            }
            let mut values = Vec::with_capacity(content.cells.len() * each);
            for tag in &content.cells.ids {
                match rows.get(tag).and_then(|row| data.values.get(row * each..(row + 1) * each)) {
                    Some(own) => values.extend_from_slice(own),
                    None => values.resize(values.len() + each, f64::NAN),
                }
            }
            let name = step_name(&content.cell_data, steps, data.name);
            content.cell_data.push(DataArray { name, values, ..data });
        }
    }

    /// Adds a group for each number of the cell data `array`. Cells without a number join no group. Does nothing if the
    /// file has no such data, as its regions are then groups already.
    fn add_regions(&mut self, array: &str) {
        self.content.region_kind = Some(common_kind(array));
        let is_own = |data: &&DataArray| data.name == array && data.components == 1;
        let Some(data) = self.content.cell_data.iter().find(is_own) else { return };
        let numbers = data.values.clone();
        self.add_region_name(array);
        for (cell, number) in numbers.into_iter().enumerate().filter(|(_, x)| !x.is_nan()) {
            let dimension = self.content.cells.kinds[cell].dimension();
            let group = self.group(array, dimension, GroupLabel::number(number));
            let mut groups = self.content.sets[self.content.cells.sets[cell] as usize].clone();
            if !groups.contains(&group) {
                groups.push(group);
            }
            self.content.cells.sets[cell] = self.number_of(groups);
        }
    }

    fn add_region_name(&mut self, name: &str) {
        if !self.content.region_names.iter().any(|known| known == name) {
            self.content.region_names.push(name.to_owned());
        }
    }

    fn group(&mut self, kind: &str, dimension: u8, label: GroupLabel) -> u32 {
        let kind = common_kind(kind);
        let (number, is_new) = self.keys.number(&kind, dimension, &label);
        if is_new {
            self.content.groups.push(ContentGroup { kind, dimension, label, name: None });
        }
        number as u32
    }

    /// Returns the index in [`Content::sets`] of an element's set of groups, and adds new sets.
    fn set(&mut self, dimension: u8, region: [i64; 2]) -> u32 {
        if let Some(&set) = self.last.get(&(dimension, region)) {
            return set;
        }
        let mut groups = Vec::new();
        let of_columns = self.columns.iter().zip(region).filter_map(|(column, number)| {
            let label = (column.label)(number).filter(|_| dimension >= column.from_dimension)?;
            Some((column.kind.clone(), dimension, label))
        });
        // Groups are separate for each dimension here, even in formats whose groups mix dimensions.
        let within = self.within.iter();
        let within = within.map(|(kind, label, _)| (kind.clone(), dimension, label.clone()));
        for (kind, dimension, label) in of_columns.chain(within).collect::<Vec<_>>() {
            let group = self.group(&kind, dimension, label);
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        let set = self.number_of(groups);
        self.last.insert((dimension, region), set);
        set
    }

    /// Returns the index in [`Content::sets`] of a set of groups, and adds new sets.
    fn number_of(&mut self, groups: Vec<u32>) -> u32 {
        let next = self.content.sets.len() as u32;
        let set = *self.sets.entry(groups.clone()).or_insert(next);
        if set == next {
            self.content.sets.push(groups);
        }
        set
    }

    fn vertices(&self, nodes: &[u64]) -> Vec<u32> {
        nodes.iter().filter_map(|&node| self.ids.index(node)).collect()
    }
}

impl MeshVisitor for ContentBuilder {
    fn allows_parallel(&self) -> bool {
        true
    }

    fn node(&mut self, _: &Cursor<'_>, id: u64, _: u64, _: usize, at: [f64; 2]) {
        self.ids.push(id);
        self.content.vertex_ids.push(id);
        self.content.points.push(at);
    }

    fn visit_element(&mut self, _: &Cursor<'_>, element: &Element) -> Result<(), ReadError> {
        let &Element { id, kind, region, nodes } = element;
        if kind == CellKind::Polygon {
            // Elements of this kind are corners of required elements, which the file lists a second time.
            return Ok(());
        }
        let set = self.set(kind.dimension(), region);
        let vertices = self.vertices(&nodes[..kind.nodes()]);
        self.content.cells.push(kind, &vertices, set, id);
        Ok(())
    }

    fn further_region(&mut self, kind: CellKind, region: [i64; 2]) {
        let further = self.set(kind.dimension(), region);
        let Some(&before) = self.content.cells.sets.last() else { return };
        let mut groups = self.content.sets[before as usize].clone();
        for &group in &self.content.sets[further as usize] {
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        let set = self.number_of(groups);
        self.content.cells.sets.pop();
        self.content.cells.sets.push(set);
    }

    fn polygon(
        &mut self,
        _: &Cursor<'_>,
        id: u64,
        region: [i64; 2],
        corners: &[u64],
    ) -> Result<(), ReadError> {
        let set = self.set(2, region);
        let vertices = self.vertices(corners);
        self.content.cells.push(CellKind::Polygon, &vertices, set, id);
        Ok(())
    }

    fn polyline(
        &mut self,
        _: &Cursor<'_>,
        id: u64,
        region: [i64; 2],
        nodes: &[u64],
    ) -> Result<(), ReadError> {
        let set = self.set(1, region);
        for ends in self.vertices(nodes).windows(2) {
            self.content.cells.push(CellKind::Line, ends, set, id);
        }
        Ok(())
    }

    fn asks_for_periodic_pairs(&self) -> bool {
        true
    }

    fn periodic_pairs(&mut self, pairs: Option<Vec<PeriodicNodes>>) {
        match pairs {
            Some(pairs) => self.content.periodic.extend(pairs),
            None => self.unsupported(PERIODIC),
        }
    }

    fn asks_for_groups(&self) -> bool {
        true
    }

    fn asks_for_data(&self) -> bool {
        true
    }

    fn region_attributes(&mut self, columns: Vec<RegionAttribute>) {
        columns.iter().for_each(|column| self.add_region_name(&column.kind));
        self.columns = columns;
        self.last.clear();
    }

    fn group_scopes(&mut self, groups: &[GroupScope<'_>]) {
        let owned =
            |group: &GroupScope<'_>| (group.kind.to_owned(), group.label.clone(), group.dimension);
        self.within = groups.iter().map(owned).collect();
        self.last.clear();
    }

    fn node_group(&mut self, node: u32, kind: &str, label: &GroupLabel) {
        let groups = &mut self.content.vertex_groups;
        let (number, is_new) = self.vertex_keys.number(kind, 0, label);
        if is_new {
            let (kind, label) = (common_kind(kind), label.clone());
            groups.push((ContentGroup { kind, dimension: 0, label, name: None }, Vec::new()));
        }
        groups[number].1.push(node);
    }

    fn group_name(&mut self, kind: &str, dimension: Option<u8>, tag: i64, name: &[u8]) {
        let name = decoded(name);
        self.keys.set_name(&common_kind(kind), dimension, tag, name);
    }

    fn point_array(&mut self, name: &[u8], components: u64, is_real: bool) -> bool {
        // Most formats take no data without a name.
        let name = match name.trim_ascii() {
            b"" => UNNAMED.to_owned(),
            _ => decoded(name),
        };
        let components = usize::try_from(components).unwrap_or(usize::MAX);
        self.announce(Some(PendingArray {
            name,
            components,
            is_real,
            is_height: false,
            packing: None,
        }));
        true
    }

    fn z_array(&mut self, name: &[u8]) -> bool {
        self.point_array(name, 1, true);
        // Depths are positive downwards, so they are not third coordinates.
        self.announced.iter_mut().for_each(|array| array.is_height = name == b"z");
        true
    }

    fn point_numbers(&mut self, numbers: PointNumbers) {
        let Some(PendingArray { name, components, is_real, is_height, packing }) =
            self.announced.take()
        else {
            return;
        };
        let PointNumbers { numbers, nodes, .. } = numbers;
        let (numbers, is_real) = (unpacked(numbers, packing), is_real || packing.is_some());
        let values = match nodes {
            None => numbers,
            Some(nodes) => {
                let index = |&node: &u64| self.ids.index(node).unwrap_or(u32::MAX);
                scatter(&numbers, components, self.content.points.len(), nodes.iter().map(index))
            }
        };
        if is_height {
            self.content.z_values = values;
            return;
        }
        // Parts of a mesh may list the values of their own vertices in separate arrays of equal name.
        let same = |data: &&mut DataArray| data.name == name && data.components == components;
        if let Some(data) = self.content.point_data.iter_mut().find(same)
            && data.values.len() == values.len()
            && data.values.iter().zip(&values).all(|(a, b)| a.is_nan() || b.is_nan())
        {
            for (own, value) in data.values.iter_mut().zip(&values) {
                *own = if own.is_nan() { *value } else { *own };
            }
            return;
        }
        let name = step_name(&self.content.point_data, &mut self.steps, name);
        self.content.point_data.push(DataArray { name, components, is_real, values, packing });
    }

    fn cell_array(&mut self, name: &[u8], components: u64, is_real: bool) -> bool {
        self.point_array(name, components, is_real)
    }

    fn cell_numbers(&mut self, values: Vec<f64>, tags: Option<Vec<u64>>) {
        if let Some(PendingArray { name, components, is_real, packing, .. }) = self.announced.take()
        {
            let (values, is_real) = (unpacked(values, packing), is_real || packing.is_some());
            // Parts of a mesh may list the values of their own cells in separate arrays of equal name.
            // Later time steps have the name of the first, and the parts of the last step go on.
            let before = self.by_tag.iter_mut().rfind(|(data, _)| data.name == name);
            if let (Some((data, Some(known))), Some(tags)) = (before, &tags)
                && data.components == components
                && known.last() < tags.first()
            {
                data.values.extend(values);
                known.extend(tags);
                return;
            }
            self.by_tag.push((DataArray { name, components, is_real, values, packing }, tags));
        }
    }

    fn packing(&mut self, packing: [f64; 2]) {
        self.announced.iter_mut().for_each(|array| array.packing = Some(packing));
    }

    fn projection(&mut self, projection: &[u8]) {
        self.content.projection = decoded(projection);
    }

    fn origin(&mut self, at: [i32; 2]) {
        self.content.origin = at;
    }

    fn unsupported(&mut self, what: &str) {
        if !self.content.unsupported.iter().any(|known| known == what) {
            self.content.unsupported.push(what.to_owned());
        }
    }
}
