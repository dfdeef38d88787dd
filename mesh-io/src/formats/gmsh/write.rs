//! Writer of gmsh's `.msh`, versions 2.2 and 4.1, as text and in binary.

use super::periodic;
use crate::binary::byte_order::ByteOrder;
use crate::export::content::DataArray;
use crate::export::group_numbers::is_region_zero;
use crate::export::rows::Rows;
use crate::export::writer_input::WriterInput;
use crate::visit::items::{CellKind, PeriodicNodes};
use std::collections::{HashMap, HashSet};

/// Returns gmsh's type number for an element kind.
fn kind_of(kind: CellKind) -> i64 {
    match kind {
        CellKind::Point => 15,
        CellKind::Line => 1,
        CellKind::Triangle => 2,
        CellKind::Quadrilateral | CellKind::Polygon => 3,
    }
}

pub(crate) fn write_22(input: &WriterInput<'_>) -> String {
    version_22(input, None).into_text()
}

pub(crate) fn write_22_binary(input: &WriterInput<'_>) -> Vec<u8> {
    version_22(input, Some(ByteOrder::Little)).into_bytes()
}

pub(crate) fn write_41(input: &WriterInput<'_>) -> String {
    version_41(input, None).into_text()
}

pub(crate) fn write_41_binary(input: &WriterInput<'_>) -> Vec<u8> {
    version_41(input, Some(ByteOrder::Little)).into_bytes()
}

/// Starts a file with its section `$MeshFormat`.
fn start(version: &str, order: Option<ByteOrder>) -> Rows {
    let mut out = Rows::new(order);
    out.text(&format!("$MeshFormat\n{version} {} 8\n", u8::from(order.is_some())));
    if out.is_binary() {
        // Programs find the byte order by this number.
        out.int(1);
        out.end_list();
    }
    out.text("$EndMeshFormat\n");
    out
}

fn version_22(input: &WriterInput<'_>, order: Option<ByteOrder>) -> Rows {
    let mut out = start("2.2", order);
    let physicals = Physicals::new(input);
    physicals.write_names(input, &mut out);
    let points = input.content.points.len();
    out.text(&format!("$Nodes\n{points}\n"));
    for vertex in 0..points {
        out.int(input.vertex_id(vertex) as i64);
        coordinates(input, vertex, &mut out);
    }
    out.end_list();
    // An element of several physical groups has a row for each.
    let rows = |cell: usize| physicals.of(input, cell).len().max(1);
    let count: usize = input.cells().map(rows).sum();
    out.text(&format!("$EndNodes\n$Elements\n{count}\n"));
    let entities = Entities::new(input, &physicals);
    let cells: Vec<usize> = input.cells().collect();
    let kind = |cell: usize| kind_of(input.content.cells.kinds[cell]);
    let mut numbers = Vec::new();
    for cells in cells.chunk_by(|&a, &b| kind(a) == kind(b)) {
        let kind = kind(cells[0]);
        if out.is_binary() {
            let count: usize = cells.iter().map(|&cell| rows(cell)).sum();
            [kind, count as i64, 2].into_iter().for_each(|number| out.int(number));
        }
        for &cell in cells {
            let (tags, entity) = (physicals.of(input, cell), entities.of(input, cell));
            for &physical in if tags.is_empty() { &[0] } else { tags } {
                numbers.push((numbers.len() as u64 + 1, cell));
                out.int(numbers.len() as i64);
                if !out.is_binary() {
                    out.int(kind);
                    out.int(2);
                }
                out.int(physical);
                out.int(entity);
                let nodes = input.content.cells.of(cell).iter();
                nodes.for_each(|&v| out.int(input.vertex_id(v as usize) as i64));
                out.end_row();
            }
        }
    }
    out.end_list();
    out.text("$EndElements\n");
    entities.write_periodic(input, false, &mut out);
    data(input, &numbers, &mut out);
    out
}

fn version_41(input: &WriterInput<'_>, order: Option<ByteOrder>) -> Rows {
    let mut out = start("4.1", order);
    let physicals = Physicals::new(input);
    physicals.write_names(input, &mut out);
    let entities = Entities::new(input, &physicals);
    entities.write(input, &mut out);
    let content = input.content;
    let points = content.points.len();
    let numbers = || (0..points).map(|vertex| input.vertex_id(vertex));
    let (least, most) = (numbers().min().unwrap_or(0), numbers().max().unwrap_or(0));
    // All nodes are written as nodes of one surface. The line elements show which nodes are on curves.
    out.text("$Nodes\n");
    sizes(&[1, points as u64, least, most], &mut out);
    block([2, entities.first_surface(), 0], points, &mut out);
    for number in numbers() {
        sizes(&[number], &mut out);
    }
    (0..points).for_each(|vertex| coordinates(input, vertex, &mut out));
    out.end_list();
    out.text("$EndNodes\n$Elements\n");
    let cells: Vec<usize> = input.cells().collect();
    let of = |cell: usize| (content.cells.kinds[cell], entities.of(input, cell));
    let blocks: Vec<&[usize]> = cells.chunk_by(|&a, &b| of(a) == of(b)).collect();
    sizes(&[blocks.len() as u64, cells.len() as u64, 1, cells.len() as u64], &mut out);
    let mut element = 0;
    for cells in blocks {
        let (kind, entity) = of(cells[0]);
        block([i64::from(kind.dimension()), entity, kind_of(kind)], cells.len(), &mut out);
        for &cell in cells {
            element += 1;
            out.size(element);
            let nodes = content.cells.of(cell).iter();
            nodes.for_each(|&v| out.size(input.vertex_id(v as usize)));
            out.end_row();
        }
    }
    out.end_list();
    out.text("$EndElements\n");
    entities.write_periodic(input, true, &mut out);
    let numbers: Vec<(u64, usize)> = (1..).zip(cells).collect();
    data(input, &numbers, &mut out);
    out
}

fn coordinates(input: &WriterInput<'_>, vertex: usize, out: &mut Rows) {
    let [x, y] = input.content.points[vertex];
    [x, y, input.content.z(vertex)].into_iter().for_each(|x| out.real(x));
    out.end_row();
}

/// Writes a row of sizes.
fn sizes(numbers: &[u64], out: &mut Rows) {
    numbers.iter().for_each(|&number| out.size(number));
    out.end_row();
}

/// Writes the header of a block of nodes or elements.
fn block(numbers: [i64; 3], count: usize, out: &mut Rows) {
    numbers.into_iter().for_each(|number| out.int(number));
    sizes(&[count as u64], out);
}

/// For each dimension, a tag below which no tag is free. A search from 1 for each of many groups would take quadratic
/// time.
#[derive(Default)]
struct FreeTags([i64; 3]);

impl FreeTags {
    /// Returns the least positive tag of a dimension that `taken` lacks, and adds the tag to `taken`.
    fn take(&mut self, dimension: u8, taken: &mut HashSet<(u8, i64)>) -> i64 {
        let last = &mut self.0[usize::from(dimension)];
        *last += 1;
        while !taken.insert((dimension, *last)) {
            *last += 1;
        }
        *last
    }
}

/// Physical groups: all groups of the mesh except entities.
struct Physicals {
    /// The tag of each group of the content, 0 for a group that is no physical group.
    tags: Vec<i64>,
    /// The tags for each set of groups of the content.
    sets: Vec<Vec<i64>>,
}

impl Physicals {
    fn new(input: &WriterInput<'_>) -> Physicals {
        let content = input.content;
        let (mut tags, mut taken) = (vec![0; content.groups.len()], HashSet::new());
        // Groups of different kinds may have one number. The first kind keeps it.
        let mut others = Vec::new();
        for dimension in 0..3 {
            for kind in input.capabilities.stored_kinds(content, dimension) {
                for (group, own) in content.groups.iter().enumerate() {
                    let number = input.group_numbers.number(group as u32);
                    if own.dimension != dimension || own.kind != kind {
                        continue;
                    }
                    match number {
                        // Tag 0 stands for no physical group.
                        0 if is_region_zero(input.content, own) => others.push(group),
                        0 => {}
                        _ if taken.insert((dimension, number)) => tags[group] = number,
                        _ => others.push(group),
                    }
                }
            }
        }
        let mut free = FreeTags::default();
        for group in others {
            tags[group] = free.take(content.groups[group].dimension, &mut taken);
        }
        let of_set = |set: &Vec<u32>| {
            let mut set: Vec<i64> = set.iter().map(|&group| tags[group as usize]).collect();
            set.retain(|&tag| tag != 0);
            set
        };
        Physicals { sets: content.sets.iter().map(of_set).collect(), tags }
    }

    /// Returns dimension and tag of each physical group.
    fn taken(&self, input: &WriterInput<'_>) -> HashSet<(u8, i64)> {
        let groups = input.content.groups.iter().zip(&self.tags);
        groups.map(|(group, &tag)| (group.dimension, tag)).collect()
    }

    /// Returns the tags of a cell's physical groups.
    fn of(&self, input: &WriterInput<'_>, cell: usize) -> &[i64] {
        &self.sets[input.content.cells.sets[cell] as usize]
    }

    /// Writes the names of the groups of written cells, and of the groups without cells.
    fn write_names(&self, input: &WriterInput<'_>, out: &mut Rows) {
        let used: HashSet<u32> = input.cells().map(|cell| input.content.cells.sets[cell]).collect();
        let used: HashSet<u32> =
            used.iter().flat_map(|&set| &input.content.sets[set as usize]).copied().collect();
        let row = |group: u32| {
            let (own, tag) = (&input.content.groups[group as usize], self.tags[group as usize]);
            (tag != 0).then_some((own.dimension, tag, own.name()?))
        };
        let mut rows: Vec<(u8, i64, &str)> = used.into_iter().filter_map(row).collect();
        let mut taken: HashSet<(u8, i64)> = self.taken(input);
        let mut free = FreeTags::default();
        for group in &input.content.empty_groups {
            // A group of another kind may have the number.
            let (dimension, wanted) = (group.dimension, group.tag().filter(|&tag| tag > 0));
            let number = match wanted.filter(|&tag| taken.insert((dimension, tag))) {
                Some(tag) => tag,
                None => free.take(dimension, &mut taken),
            };
            rows.extend(group.name().map(|name| (dimension, number, name)));
        }
        rows.sort_unstable();
        if !rows.is_empty() {
            out.text(&format!("$PhysicalNames\n{}\n", rows.len()));
            for (dimension, tag, name) in rows {
                out.text(&format!("{dimension} {tag} \"{name}\"\n"));
            }
            out.text("$EndPhysicalNames\n");
        }
    }
}

/// Entities of the model, to which the cells belong. Cells of equal dimension, entity in the mesh and physical groups
/// share an entity.
struct Entities<'p> {
    physicals: &'p Physicals,
    /// For each cell, the index of its group of the kind `entity` in the content.
    column: Vec<Option<u32>>,
    /// Tag of each written entity, by dimension, entity of the mesh, and physical groups.
    numbers: HashMap<(u8, Option<u32>, &'p [i64]), i64>,
}

impl<'p> Entities<'p> {
    fn new(input: &WriterInput<'_>, physicals: &'p Physicals) -> Entities<'p> {
        let column = input.content.column("entity");
        let key = |cell: usize| {
            let dimension = input.content.cells.kinds[cell].dimension();
            (dimension, column[cell], physicals.of(input, cell))
        };
        let mut numbers = HashMap::new();
        let mut taken: HashSet<(u8, i64)> = HashSet::new();
        let mut left = Vec::new();
        for cell in input.cells() {
            let (dimension, entity, physical) = key(cell);
            if numbers.contains_key(&(dimension, entity, physical)) {
                continue;
            }
            // An entity keeps its tag, or gets the tag of its first physical group. If an earlier entity has that tag, or if
            // it is below 1, the entity gets an unused tag after the loop.
            let first = physical.first().copied().unwrap_or(0);
            let wanted = entity.map_or(first, |entity| input.group_numbers.number(entity));
            let number = if wanted > 0 && taken.insert((dimension, wanted)) { wanted } else { 0 };
            numbers.insert((dimension, entity, physical), number);
            if number == 0 {
                left.push((dimension, entity, physical));
            }
        }
        let mut next = 1;
        for key in left {
            while !taken.insert((key.0, next)) {
                next += 1;
            }
            numbers.insert(key, next);
        }
        Entities { physicals, column, numbers }
    }

    fn of(&self, input: &WriterInput<'_>, cell: usize) -> i64 {
        let dimension = input.content.cells.kinds[cell].dimension();
        let key = (dimension, self.column[cell], self.physicals.of(input, cell));
        self.numbers.get(&key).copied().unwrap_or(1)
    }

    /// Writes pairs of periodic nodes on curves, in the layout of version 4.1 or 2.2.
    fn write_periodic(&self, input: &WriterInput<'_>, is_41: bool, out: &mut Rows) {
        let number = |tag: i64| {
            let is_own = |group: u32| input.content.groups[group as usize].tag() == Some(tag);
            let own = self.numbers.iter().filter(|((dimension, entity, _), _)| {
                *dimension == 1 && entity.is_some_and(is_own)
            });
            own.map(|(_, number)| *number).min()
        };
        let written = |pairs: &'_ PeriodicNodes| match pairs.entities {
            Some((1, [image, of])) => Some([number(image)?, number(of)?]),
            _ => None,
        };
        let links: Vec<([i64; 2], &PeriodicNodes)> = input
            .content
            .periodic
            .iter()
            .filter_map(|pairs| Some((written(pairs)?, pairs)))
            .collect();
        if links.is_empty() {
            return;
        }
        let ids: HashMap<u64, usize> = input.content.vertex_ids.iter().copied().zip(0..).collect();
        let id = |node: u64| ids.get(&node).map(|&vertex| input.vertex_id(vertex));
        out.text("$Periodic\n");
        // Binary files of version 2.2 have this section as text.
        let mut rows = Rows::new(out.order().filter(|_| is_41));
        sizes(&[links.len() as u64], &mut rows);
        for ([image, of], PeriodicNodes { motion, nodes, .. }) in links {
            [1, image, of].into_iter().for_each(|number| rows.int(number));
            rows.end_row();
            let motion = motion.map(periodic::matrix);
            match (&motion, is_41) {
                (Some(matrix), true) => rows.size(matrix.len() as u64),
                (None, true) => rows.size(0),
                (Some(_), false) => rows.word("Affine"),
                (None, false) => {}
            }
            motion.into_iter().flatten().for_each(|number| rows.real(number));
            if motion.is_some() || is_41 {
                rows.end_row();
            }
            let pairs: Vec<[u64; 2]> =
                nodes.iter().filter_map(|&[of, image]| Some([id(image)?, id(of)?])).collect();
            sizes(&[pairs.len() as u64], &mut rows);
            pairs.iter().for_each(|pair| sizes(pair, &mut rows));
        }
        rows.end_list();
        out.append(rows);
        out.text("$EndPeriodic\n");
    }

    fn first_surface(&self) -> i64 {
        let surfaces = self.numbers.iter().filter(|((dimension, ..), _)| *dimension == 2);
        surfaces.map(|(_, &number)| number).min().unwrap_or(1)
    }

    fn write(&self, input: &WriterInput<'_>, out: &mut Rows) {
        let mut rows: Vec<(u8, i64, &[i64])> = self
            .numbers
            .iter()
            .map(|(&(dimension, _, physical), &number)| (dimension, number, physical))
            .collect();
        rows.sort_unstable();
        let count = |of: u8| rows.iter().filter(|(dimension, ..)| *dimension == of).count() as u64;
        out.text("$Entities\n");
        sizes(&[count(0), count(1), count(2), 0], out);
        let bounds = |axis: usize| {
            let along = |v: usize| match axis {
                2 => input.content.z(v),
                axis => input.content.points[v][axis],
            };
            let all = (0..input.content.points.len()).map(along);
            all.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
        };
        let [x, y, z] = [bounds(0), bounds(1), bounds(2)];
        for (dimension, number, physical) in rows {
            out.int(number);
            // A point has coordinates, other entities have a box.
            for end in if dimension > 0 { 0..2 } else { 0..1 } {
                [x, y, z].into_iter().for_each(|bounds| out.real(bounds[end]));
            }
            out.size(physical.len() as u64);
            physical.iter().for_each(|&tag| out.int(tag));
            if dimension > 0 {
                // The bounding entities are unknown.
                out.size(0);
            }
            out.end_row();
        }
        out.end_list();
        out.text("$EndEntities\n");
    }
}

/// Writes `$NodeData` and `$ElementData`. `elements` are the numbers of the written elements and their cells.
fn data(input: &WriterInput<'_>, elements: &[(u64, usize)], out: &mut Rows) {
    for data in input.point_data() {
        let nodes = (0..input.content.points.len()).map(|vertex| (input.vertex_id(vertex), vertex));
        section(data, "NodeData", nodes, out);
    }
    for data in input.cell_data() {
        section(data, "ElementData", elements.iter().copied(), out);
    }
}

/// Writes a section with the data of vertices or cells: their numbers in the file and in the content. Items with only
/// NaN are left out.
fn section(
    data: &DataArray,
    name: &str,
    items: impl Iterator<Item = (u64, usize)>,
    out: &mut Rows,
) {
    let (each, padded) = (data.components, data.padded_components());
    let of = |place: usize| data.values.get(place * each..(place + 1) * each).unwrap_or_default();
    let is_given = |place: &usize| !of(*place).iter().all(|value| value.is_nan());
    let rows: Vec<(u64, usize)> = items.filter(|(_, place)| is_given(place)).collect();
    let title = &data.name;
    out.text(&format!("${name}\n1\n\"{title}\"\n1\n0.0\n3\n0\n{padded}\n{}\n", rows.len()));
    for (number, place) in rows {
        out.int(number as i64);
        for index in 0..padded {
            out.real(of(place).get(index).copied().unwrap_or(0.0));
        }
        out.end_row();
    }
    out.end_list();
    out.text(&format!("$End{name}\n"));
}
