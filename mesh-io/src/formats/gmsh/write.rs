//! Writer of gmsh's `.msh`, as text of versions 2.2 and 4.1.

use crate::export::content::DataArray;
use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::visit::items::CellKind;
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
    names(input, &mut out);
    let points = input.content.points.len();
    put!(out, "$Nodes\n{points}\n");
    for vertex in 0..points {
        put!(out, "{} {}\n", input.vertex_id(vertex), input.xyz(vertex));
    }
    put!(out, "$EndNodes\n$Elements\n{}\n", input.cells().count());
    let entities = Entities::new(input);
    for (cell, element) in input.cells().zip(1..) {
        let kind = input.content.cells.kinds[cell];
        let (physical, entity) = (physical(input, cell), entities.of(input, cell));
        put!(out, "{element} {} 2 {physical} {entity} {}\n", kind_of(kind), input.vertex_ids(cell));
    }
    out.push_str("$EndElements\n");
    data(input, &mut out);
    out
}

pub(crate) fn write_41(input: &WriterInput<'_>) -> String {
    let mut out = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n".to_owned();
    names(input, &mut out);
    let entities = Entities::new(input);
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
    data(input, &mut out);
    out
}

/// Returns the tag of a cell's physical group; 0 if the most important group is an entity or missing.
fn physical(input: &WriterInput<'_>, cell: usize) -> i64 {
    match input.group(cell) {
        Some(group) if group.kind != "entity" => input.group_number(cell),
        _ => 0,
    }
}

fn names(input: &WriterInput<'_>, out: &mut String) {
    let mut named: HashMap<u32, i64> = HashMap::new();
    for cell in input.cells() {
        if let Some(group) = input.group_numbers.group(input.content, cell)
            && input.content.groups[group as usize].kind != "entity"
        {
            named.insert(group, input.group_numbers.number(group));
        }
    }
    let mut rows: Vec<(u8, i64, &str)> = named
        .into_iter()
        .filter_map(|(group, tag)| {
            let group = &input.content.groups[group as usize];
            Some((group.dimension, tag, group.name()?))
        })
        .collect();
    rows.sort_unstable();
    if !rows.is_empty() {
        put!(out, "$PhysicalNames\n{}\n", rows.len());
        for (dimension, tag, name) in rows {
            put!(out, "{dimension} {tag} \"{name}\"\n");
        }
        out.push_str("$EndPhysicalNames\n");
    }
}

/// Entities of the model, to which the cells belong. Cells of equal dimension, entity in the mesh and physical group
/// share an entity.
struct Entities {
    /// For each cell, the index of its group of the kind `entity` in the content.
    column: Vec<Option<u32>>,
    /// Tag of each written entity, by dimension, entity of the mesh, and physical group.
    numbers: HashMap<(u8, Option<u32>, i64), i64>,
}

impl Entities {
    fn new(input: &WriterInput<'_>) -> Entities {
        let column = input.content.column("entity");
        let key = |cell: usize| {
            let dimension = input.content.cells.kinds[cell].dimension();
            (dimension, column[cell], physical(input, cell))
        };
        let mut numbers = HashMap::new();
        let mut taken: HashSet<(u8, i64)> = HashSet::new();
        let mut left = Vec::new();
        for cell in input.cells() {
            let (dimension, entity, physical) = key(cell);
            if numbers.contains_key(&(dimension, entity, physical)) {
                continue;
            }
            // An entity keeps its tag, or gets the tag of its physical group. If an earlier entity has that tag, or if
            // it is below 1, the entity gets an unused tag after the loop.
            let wanted = entity.map_or(physical, |entity| input.group_numbers.number(entity));
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
        Entities { column, numbers }
    }

    fn of(&self, input: &WriterInput<'_>, cell: usize) -> i64 {
        let dimension = input.content.cells.kinds[cell].dimension();
        let key = (dimension, self.column[cell], physical(input, cell));
        self.numbers.get(&key).copied().unwrap_or(1)
    }

    fn first_surface(&self) -> i64 {
        let surfaces = self.numbers.iter().filter(|((dimension, ..), _)| *dimension == 2);
        surfaces.map(|(_, &number)| number).min().unwrap_or(1)
    }

    fn write(&self, input: &WriterInput<'_>, out: &mut String) {
        let mut rows: Vec<(u8, i64, i64)> = self
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
            match physical {
                0 => out.push('0'),
                physical => put!(out, "1 {physical}"),
            }
            // The bounding entities are unknown.
            out.push_str(if dimension > 0 { " 0\n" } else { "\n" });
        }
        out.push_str("$EndEntities\n");
    }
}

/// Writes `$NodeData` and `$ElementData`.
fn data(input: &WriterInput<'_>, out: &mut String) {
    for data in input.point_data() {
        let numbers = (0..input.content.points.len()).map(|vertex| input.vertex_id(vertex));
        section(data, "NodeData", numbers, (0..input.content.points.len()).collect(), out);
    }
    for data in input.cell_data() {
        section(data, "ElementData", 1.., input.cells().collect(), out);
    }
}

/// Writes a section with the data of the vertices or cells `places`. `numbers` are their numbers in the file. Items
/// with only NaN are left out.
fn section(
    data: &DataArray,
    name: &str,
    numbers: impl Iterator<Item = u64>,
    places: Vec<usize>,
    out: &mut String,
) {
    // gmsh displays data of 1, 3 or 9 components, so others are padded with zeros.
    let each = data.components;
    let padded = [1, 3, 9].into_iter().find(|&size| size >= each).unwrap_or(each);
    let of = |place: usize| data.values.get(place * each..(place + 1) * each).unwrap_or_default();
    let is_given = |place: &usize| !of(*place).iter().all(|value| value.is_nan());
    let rows: Vec<(u64, usize)> =
        numbers.zip(places).filter(|(_, place)| is_given(place)).collect();
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
