//! Writer of gmsh's `.msh`, as text of versions 2.2 and 4.1.

use super::periodic;
use crate::export::content::DataArray;
use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::visit::items::{CellKind, PeriodicNodes};
use std::collections::{HashMap, HashSet};
use std::fmt::Write;

/// Returns gmsh's type number for an element kind.
fn kind_of(kind: CellKind) -> u32 {
    match kind {
        CellKind::Point => 15,
        CellKind::Line => 1,
        CellKind::Triangle => 2,
        CellKind::Quadrilateral | CellKind::Polygon => 3,
    }
}

pub(crate) fn write_22(input: &WriterInput<'_>) -> String {
    let mut out = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n".to_owned();
    let physicals = Physicals::new(input);
    physicals.write_names(input, &mut out);
    let points = input.content.points.len();
    put!(out, "$Nodes\n{points}\n");
    for vertex in 0..points {
        put!(out, "{} {}\n", input.vertex_id(vertex), input.xyz(vertex));
    }
    // An element of several physical groups has a row for each.
    let rows = |cell: usize| physicals.of(input, cell).len().max(1);
    put!(out, "$EndNodes\n$Elements\n{}\n", input.cells().map(rows).sum::<usize>());
    let entities = Entities::new(input, &physicals);
    let mut numbers = Vec::new();
    for cell in input.cells() {
        let kind = kind_of(input.content.cells.kinds[cell]);
        let (tags, entity) = (physicals.of(input, cell), entities.of(input, cell));
        for physical in if tags.is_empty() { &[0] } else { tags } {
            numbers.push((numbers.len() as u64 + 1, cell));
            let element = numbers.len();
            put!(out, "{element} {kind} 2 {physical} {entity} {}\n", input.vertex_ids(cell));
        }
    }
    out.push_str("$EndElements\n");
    entities.write_periodic(input, "Affine", &mut out);
    data(input, &numbers, &mut out);
    out
}

pub(crate) fn write_41(input: &WriterInput<'_>) -> String {
    let mut out = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n".to_owned();
    let physicals = Physicals::new(input);
    physicals.write_names(input, &mut out);
    let entities = Entities::new(input, &physicals);
    entities.write(input, &mut out);
    let content = input.content;
    let points = content.points.len();
    let numbers = || (0..points).map(|vertex| input.vertex_id(vertex));
    let (least, most) = (numbers().min().unwrap_or(0), numbers().max().unwrap_or(0));
    // All nodes are written as nodes of one surface. The line elements show which nodes are on curves.
    let surface = entities.first_surface();
    put!(out, "$Nodes\n1 {points} {least} {most}\n2 {surface} 0 {points}\n");
    numbers().for_each(|number| put!(out, "{number}\n"));
    (0..points).for_each(|vertex| put!(out, "{}\n", input.xyz(vertex)));
    let cells: Vec<usize> = input.cells().collect();
    let block = |cell: usize| (content.cells.kinds[cell], entities.of(input, cell));
    let blocks: Vec<&[usize]> = cells.chunk_by(|&a, &b| block(a) == block(b)).collect();
    put!(out, "$EndNodes\n$Elements\n{} {} 1 {}\n", blocks.len(), cells.len(), cells.len());
    let mut element = 0;
    for cells in blocks {
        let (kind, entity) = block(cells[0]);
        put!(out, "{} {entity} {} {}\n", kind.dimension(), kind_of(kind), cells.len());
        for &cell in cells {
            element += 1;
            put!(out, "{element} {}\n", input.vertex_ids(cell));
        }
    }
    out.push_str("$EndElements\n");
    entities.write_periodic(input, "16", &mut out);
    let numbers: Vec<(u64, usize)> = (1..).zip(cells).collect();
    data(input, &numbers, &mut out);
    out
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
                    if own.dimension != dimension || own.kind != kind || number == 0 {
                        continue;
                    }
                    match taken.insert((dimension, number)) {
                        true => tags[group] = number,
                        false => others.push(group),
                    }
                }
            }
        }
        for group in others {
            let dimension = content.groups[group].dimension;
            let free = (1..).find(|&number| taken.insert((dimension, number)));
            tags[group] = free.unwrap_or(0);
        }
        let of_set = |set: &Vec<u32>| {
            let mut set: Vec<i64> = set.iter().map(|&group| tags[group as usize]).collect();
            set.retain(|&tag| tag != 0);
            set
        };
        Physicals { sets: content.sets.iter().map(of_set).collect(), tags }
    }

    /// Returns the tags of a cell's physical groups.
    fn of(&self, input: &WriterInput<'_>, cell: usize) -> &[i64] {
        &self.sets[input.content.cells.sets[cell] as usize]
    }

    /// Writes the names of the groups of written cells.
    fn write_names(&self, input: &WriterInput<'_>, out: &mut String) {
        let used: HashSet<u32> = input.cells().map(|cell| input.content.cells.sets[cell]).collect();
        let used: HashSet<u32> =
            used.iter().flat_map(|&set| &input.content.sets[set as usize]).copied().collect();
        let row = |group: u32| {
            let (own, tag) = (&input.content.groups[group as usize], self.tags[group as usize]);
            (tag != 0).then_some((own.dimension, tag, own.name()?))
        };
        let mut rows: Vec<(u8, i64, &str)> = used.into_iter().filter_map(row).collect();
        rows.sort_unstable();
        if !rows.is_empty() {
            put!(out, "$PhysicalNames\n{}\n", rows.len());
            for (dimension, tag, name) in rows {
                put!(out, "{dimension} {tag} \"{name}\"\n");
            }
            out.push_str("$EndPhysicalNames\n");
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

    /// Writes pairs of periodic nodes on curves. `keyword` is the word in front of a motion.
    fn write_periodic(&self, input: &WriterInput<'_>, keyword: &str, out: &mut String) {
        let number = |tag: i64| {
            let is_own = |group: u32| input.content.groups[group as usize].tag() == Some(tag);
            let own = self.numbers.iter().filter(|((dimension, entity, _), _)| {
                *dimension == 1 && entity.is_some_and(is_own)
            });
            own.map(|(_, number)| *number).min()
        };
        let mut links = String::new();
        let mut count = 0;
        let ids: HashMap<u64, usize> = input.content.vertex_ids.iter().copied().zip(0..).collect();
        for PeriodicNodes { entities, motion, nodes } in &input.content.periodic {
            let &Some((1, [image, of])) = entities else { continue };
            let (Some(image), Some(of)) = (number(image), number(of)) else { continue };
            count += 1;
            put!(links, "1 {image} {of}\n");
            match motion {
                Some(motion) => put!(links, "{keyword} {}\n", periodic::matrix(*motion)),
                None if keyword == "16" => links.push_str("0\n"),
                None => {}
            }
            let id = |node: &u64| ids.get(node).map(|&vertex| input.vertex_id(vertex));
            let pairs: Vec<_> =
                nodes.iter().filter_map(|[of, image]| Some((id(image)?, id(of)?))).collect();
            put!(links, "{}\n", pairs.len());
            pairs.iter().for_each(|(image, of)| put!(links, "{image} {of}\n"));
        }
        if count > 0 {
            put!(out, "$Periodic\n{count}\n{links}$EndPeriodic\n");
        }
    }

    fn first_surface(&self) -> i64 {
        let surfaces = self.numbers.iter().filter(|((dimension, ..), _)| *dimension == 2);
        surfaces.map(|(_, &number)| number).min().unwrap_or(1)
    }

    fn write(&self, input: &WriterInput<'_>, out: &mut String) {
        let mut rows: Vec<(u8, i64, &[i64])> = self
            .numbers
            .iter()
            .map(|(&(dimension, _, physical), &number)| (dimension, number, physical))
            .collect();
        rows.sort_unstable();
        let count = |of: u8| rows.iter().filter(|(dimension, ..)| *dimension == of).count();
        put!(out, "$Entities\n{} {} {} 0\n", count(0), count(1), count(2));
        let bounds = |axis: usize| {
            let along = |v: usize| match axis {
                2 => input.content.z(v),
                axis => input.content.points[v][axis],
            };
            let all = (0..input.content.points.len()).map(along);
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
        };
        let [x, y, z] = [bounds(0), bounds(1), bounds(2)];
        for (dimension, number, physical) in rows {
            put!(out, "{number} {:?} {:?} {:?} ", x.0, y.0, z.0);
            if dimension > 0 {
                put!(out, "{:?} {:?} {:?} ", x.1, y.1, z.1);
            }
            put!(out, "{}", physical.len());
            physical.iter().for_each(|tag| put!(out, " {tag}"));
            // The bounding entities are unknown.
            out.push_str(if dimension > 0 { " 0\n" } else { "\n" });
        }
        out.push_str("$EndEntities\n");
    }
}

/// Writes `$NodeData` and `$ElementData`. `elements` are the numbers of the written elements and their cells.
fn data(input: &WriterInput<'_>, elements: &[(u64, usize)], out: &mut String) {
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
    out: &mut String,
) {
    // gmsh displays data of 1, 3 or 9 components, so others are padded with zeros.
    let each = data.components;
    let padded = [1, 3, 9].into_iter().find(|&size| size >= each).unwrap_or(each);
    let of = |place: usize| data.values.get(place * each..(place + 1) * each).unwrap_or_default();
    let is_given = |place: &usize| !of(*place).iter().all(|value| value.is_nan());
    let rows: Vec<(u64, usize)> = items.filter(|(_, place)| is_given(place)).collect();
    let title = &data.name;
    put!(out, "${name}\n1\n\"{title}\"\n1\n0.0\n3\n0\n{padded}\n{}\n", rows.len());
    for (number, place) in rows {
        put!(out, "{number}");
        for index in 0..padded {
            put!(out, " {:?}", of(place).get(index).copied().unwrap_or(0.0));
        }
        out.push('\n');
    }
    put!(out, "$End{name}\n");
}
