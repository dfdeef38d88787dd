//! Writer of Exodus II: element blocks by kind and group, side sets for grouped lines, node sets for groups of
//! vertices.
//!
//! The format: Sandia's report SAND92-2137, "Exodus: a finite element data model".

use crate::content::group_label::GroupLabel;
use crate::export::blocks::{Block, blocks};
use crate::export::content::ContentGroup;
use crate::export::sides::{pair, sides};
use crate::export::writer_input::WriterInput;
use crate::netcdf::write::{NetCdfWriter, Values};
use crate::visit::items::CellKind;
use std::collections::{HashMap, HashSet};

/// Name of the dimension of time steps, the record dimension.
const RECORDS: &str = "time_step";

/// A side set: the lines of a group, as sides of elements.
struct SideSet {
    group: u32,
    /// Element number of each side, from 1 through all blocks.
    elements: Vec<i32>,
    /// Number of each side within its element, from 1.
    sides: Vec<i32>,
}

/// Returns the Exodus name of an element type, and the number of nodes per element.
fn type_of(kind: CellKind) -> (&'static str, usize) {
    let name = match kind {
        CellKind::Point | CellKind::Polygon => "SPHERE",
        CellKind::Line => "BAR2",
        CellKind::Triangle => "TRI3",
        CellKind::Quadrilateral => "QUAD4",
    };
    (name, kind.nodes())
}

/// Returns the group that determines block or side set of a cell: the cell's most important group, else a group of the
/// kind `block`.
fn group_of(input: &WriterInput<'_>, cell: usize) -> Option<u32> {
    let of_any = || {
        let set = &input.content.sets[input.content.cells.sets[cell] as usize];
        set.iter().copied().find(|&group| input.content.groups[group as usize].kind == "block")
    };
    input.group_numbers.group(input.content, cell).or_else(of_any)
}

pub(crate) fn write_exodus(input: &WriterInput<'_>) -> Vec<u8> {
    let content = input.content;
    let sides = sides(content, |cell| input.group_numbers.group(content, cell));
    let cells = input.cells().filter(|cell| !sides.contains(cell));
    let blocks = blocks(input.content, cells, |cell| group_of(input, cell));
    let side_sets = side_sets(input, &blocks, &sides);
    let names = || {
        let groups = content.groups.iter().chain(content.vertex_groups.iter().map(|(g, _)| g));
        let data = input.point_data().chain(input.cell_data());
        groups.filter_map(ContentGroup::name).chain(data.map(|data| data.name.as_str()))
    };
    let longest = names().map(str::len).max().unwrap_or(0).max(32);
    let mut out = NetCdfWriter::default();
    out.dimension(RECORDS, 0);
    out.attribute("api_version", Values::Single(5.1));
    out.attribute("version", Values::Single(5.1));
    out.attribute("floating_point_word_size", Values::Whole(vec![8]));
    out.attribute("file_size", Values::Whole(vec![1]));
    out.attribute("maximum_name_length", Values::Whole(vec![longest as i32]));
    out.attribute("title", Values::Text(format!("written by {}", input.creator).into_bytes()));
    out.dimension("len_string", 33);
    out.dimension("len_name", longest + 1);
    out.dimension("four", 4);
    let has_data = input.point_data().chain(input.cell_data()).next().is_some();
    let times = if has_data { vec![0.0] } else { Vec::new() };
    out.variable("time_whole", &[RECORDS], Vec::new(), Values::Real(times));
    points(&mut out, input, longest + 1);
    elements(&mut out, input, &blocks, longest + 1);
    sets(&mut out, input, &side_sets, longest + 1);
    data(&mut out, input, &blocks, longest + 1);
    out.bytes()
}

fn side_sets(input: &WriterInput<'_>, blocks: &[Block], sides: &HashSet<usize>) -> Vec<SideSet> {
    let content = input.content;
    let mut wanted: HashMap<(u32, u32), (i32, i32)> = HashMap::new();
    for &line in sides {
        if let &[a, b] = content.cells.of(line) {
            wanted.insert(pair(a, b), (0, 0));
        }
    }
    let mut element = 0;
    // In space, sides 1 and 2 of a triangle are its faces.
    let faces = if input.is_flat() { 0 } else { 2 };
    for block in blocks {
        for &cell in &block.cells {
            element += 1;
            if block.kind.dimension() < 2 {
                continue;
            }
            let corners = content.cells.of(cell);
            for (side, &a) in corners.iter().enumerate() {
                let b = corners[(side + 1) % corners.len()];
                if let Some(found) = wanted.get_mut(&pair(a, b)).filter(|found| found.0 == 0) {
                    let before = if block.kind == CellKind::Triangle { faces } else { 0 };
                    *found = (element, side as i32 + 1 + before);
                }
            }
        }
    }
    let mut sets: Vec<SideSet> = Vec::new();
    let mut places: HashMap<u32, usize> = HashMap::new();
    for line in content.cells.all(CellKind::Line).filter(|line| sides.contains(line)) {
        let (Some(group), &[a, b]) =
            (input.group_numbers.group(content, line), content.cells.of(line))
        else {
            continue;
        };
        let place = *places.entry(group).or_insert(sets.len());
        if place == sets.len() {
            sets.push(SideSet { group, elements: Vec::new(), sides: Vec::new() });
        }
        let (element, side) = wanted[&pair(a, b)];
        sets[place].elements.push(element);
        sets[place].sides.push(side);
    }
    sets
}

/// Returns a netCDF attribute with a text.
fn text(name: &'static str, content: &str) -> (&'static str, Values) {
    (name, Values::Text(content.as_bytes().to_vec()))
}

fn points(out: &mut NetCdfWriter, input: &WriterInput<'_>, width: usize) {
    let count = input.content.points.len();
    let axes = if input.is_flat() { 2 } else { 3 };
    out.dimension("num_dim", axes);
    out.dimension("num_nodes", count);
    for (axis, name) in ["coordx", "coordy", "coordz"].into_iter().enumerate().take(axes) {
        let numbers = Values::Real(input.axis(axis).collect());
        out.variable(name, &["num_nodes"], Vec::new(), numbers);
    }
    let names = Values::names(["x", "y", "z"].into_iter().take(axes), width);
    out.variable("coor_names", &["num_dim", "len_name"], Vec::new(), names);
}

/// Assigns distinct 32-bit numbers to groups. The smallest unused numbers from 1 on replace missing, larger and
/// repeated ones.
fn numbers(wanted: impl Iterator<Item = Option<i64>>) -> Vec<i32> {
    let wanted: Vec<Option<i32>> =
        wanted.map(|own| own.and_then(|own| i32::try_from(own).ok())).collect();
    let mut taken: HashSet<i32> = wanted.iter().flatten().copied().collect();
    let (mut given, mut next) = (HashSet::new(), 1);
    let number = |own: &Option<i32>| match own {
        Some(own) if given.insert(*own) => *own,
        _ => {
            while !taken.insert(next) {
                next += 1;
            }
            next
        }
    };
    wanted.iter().map(number).collect()
}

/// Adds count, status, ids and names of blocks or sets. `width` is the length of a name with its terminating zero.
fn named(
    out: &mut NetCdfWriter,
    [count, status, property, names]: [&str; 4],
    numbers: Vec<i32>,
    texts: &[&str],
    width: usize,
) {
    out.dimension(count, numbers.len());
    out.variable(status, &[count], Vec::new(), Values::Whole(vec![1; numbers.len()]));
    out.variable(property, &[count], vec![text("name", "ID")], Values::Whole(numbers));
    out.variable(
        names,
        &[count, "len_name"],
        Vec::new(),
        Values::names(texts.iter().copied(), width),
    );
}

fn elements(out: &mut NetCdfWriter, input: &WriterInput<'_>, blocks: &[Block], width: usize) {
    let content = input.content;
    out.dimension("num_elem", blocks.iter().map(|block| block.cells.len()).sum());
    let number = |block: &Block| block.group.map(|group| input.group_numbers.number(group));
    let name = |block: &Block| content.groups[block.group? as usize].name();
    let names: Vec<&str> = blocks.iter().map(|block| name(block).unwrap_or("")).collect();
    let told = ["num_el_blk", "eb_status", "eb_prop1", "eb_names"];
    named(out, told, numbers(blocks.iter().map(number)), &names, width);
    for (block, place) in blocks.iter().zip(1..) {
        let (type_name, nodes) = type_of(block.kind);
        let [count, each] = [format!("num_el_in_blk{place}"), format!("num_nod_per_el{place}")];
        out.dimension(&count, block.cells.len());
        out.dimension(&each, nodes);
        let vertices = block.cells.iter().flat_map(|&cell| content.cells.of(cell));
        let vertices = Values::Whole(vertices.map(|&vertex| vertex as i32 + 1).collect());
        let kind = vec![text("elem_type", type_name)];
        out.variable(format!("connect{place}"), &[&count, &each], kind, vertices);
    }
}

fn sets(out: &mut NetCdfWriter, input: &WriterInput<'_>, side_sets: &[SideSet], width: usize) {
    let content = input.content;
    if !side_sets.is_empty() {
        let own = numbers(side_sets.iter().map(|set| Some(input.group_numbers.number(set.group))));
        let name = |set: &SideSet| content.groups[set.group as usize].name().unwrap_or("");
        let told = ["num_side_sets", "ss_status", "ss_prop1", "ss_names"];
        let names: Vec<&str> = side_sets.iter().map(name).collect();
        named(out, told, own, &names, width);
    }
    for (set, place) in side_sets.iter().zip(1..) {
        let count = format!("num_side_ss{place}");
        out.dimension(&count, set.elements.len());
        for (name, numbers) in [("elem_ss", &set.elements), ("side_ss", &set.sides)] {
            let numbers = Values::Whole(numbers.clone());
            out.variable(format!("{name}{place}"), &[&count], Vec::new(), numbers);
        }
    }
    let groups = &content.vertex_groups;
    if !groups.is_empty() {
        let own = numbers(groups.iter().map(|(group, _)| match group.label {
            GroupLabel::Tag(tag) => Some(tag),
            GroupLabel::Name(_) => None,
        }));
        let names: Vec<&str> = groups.iter().map(|(group, _)| group.name().unwrap_or("")).collect();
        let told = ["num_node_sets", "ns_status", "ns_prop1", "ns_names"];
        named(out, told, own, &names, width);
    }
    for ((_, vertices), place) in groups.iter().zip(1..) {
        let count = format!("num_nod_ns{place}");
        out.dimension(&count, vertices.len());
        let vertices = Values::Whole(vertices.iter().map(|&vertex| vertex as i32 + 1).collect());
        out.variable(format!("node_ns{place}"), &[&count], Vec::new(), vertices);
    }
}

fn data(out: &mut NetCdfWriter, input: &WriterInput<'_>, blocks: &[Block], width: usize) {
    let of_points: Vec<_> = input.point_data().collect();
    if !of_points.is_empty() {
        out.dimension("num_nod_var", of_points.len());
        let names = Values::names(of_points.iter().map(|data| data.name.as_str()), width);
        out.variable("name_nod_var", &["num_nod_var", "len_name"], Vec::new(), names);
        for (data, place) in of_points.iter().zip(1..) {
            let values = Values::Real(data.values.clone());
            let name = format!("vals_nod_var{place}");
            out.variable(name, &[RECORDS, "num_nodes"], Vec::new(), values);
        }
    }
    let of_cells: Vec<_> = input.cell_data().collect();
    if !of_cells.is_empty() {
        out.dimension("num_elem_var", of_cells.len());
        let names = Values::names(of_cells.iter().map(|data| data.name.as_str()), width);
        out.variable("name_elem_var", &["num_elem_var", "len_name"], Vec::new(), names);
        let all = Values::Whole(vec![1; blocks.len() * of_cells.len()]);
        out.variable("elem_var_tab", &["num_el_blk", "num_elem_var"], Vec::new(), all);
        for (data, place) in of_cells.iter().zip(1..) {
            for (block, own) in blocks.iter().zip(1..) {
                let values = block.cells.iter().map(|&cell| data.values[cell]).collect();
                let name = format!("vals_elem_var{place}eb{own}");
                let count = format!("num_el_in_blk{own}");
                out.variable(name, &[RECORDS, &count], Vec::new(), Values::Real(values));
            }
        }
    }
}
