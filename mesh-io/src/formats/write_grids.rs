//! Writes grids of coastal models: SMS's `.2dm`, the grids of ADCIRC and SCHISM, and MIKE's `.mesh`.

use crate::export::capabilities::NO_PROJECTION;
use crate::export::content::{Content, DataArray};
use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::format::Format;
use crate::formats::boundary_codes::BoundaryCodes;
use crate::formats::chains::chains;
use crate::formats::selafin;
use crate::visit::items::CellKind;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Converts heights of the bed between formats with different conventions. Depths of ADCIRC and FVCOM are positive
/// downwards, z of SMS, MIKE and UGRID and the bed of SELAFIN upwards. SMS, too, opens a grid of ADCIRC with minus its
/// depths as z. In UGRID, z is a node variable named `z` or ending in `node_z`, and a depth is a node variable whose
/// name ends in `depth`. In gmsh's formats, heights are z, unless data of vertices have the name that a conversion from ADCIRC
/// or SELAFIN gives them.
pub(crate) fn match_depths(content: &mut Content, from: Format, to: Format) {
    // The subtraction gives no negative zero.
    let minus = |number: f64| 0.0 - number;
    let turned = |values: Vec<f64>| -> Vec<f64> { values.into_iter().map(minus).collect() };
    if to == Format::Ugrid && !content.z_values.is_empty() {
        let values = std::mem::take(&mut content.z_values);
        content.point_data.push(of_vertices("z", values));
    }
    let has_depths = |format| matches!(format, Format::Adcirc | Format::Fvcom);
    let has_z = |format| matches!(format, Format::Sms2dm | Format::Mike);
    if !(has_z(to) || matches!(to, Format::Adcirc | Format::Selafin))
        || from == to
        || (has_depths(from) && has_depths(to))
    {
        return;
    }
    let heights = match from {
        Format::Adcirc | Format::Fvcom => take(content, "depth").map(turned),
        Format::Sms2dm | Format::Mike if has_z(to) => None,
        Format::Sms2dm | Format::Mike => {
            let values = (0..content.points.len()).map(|vertex| content.z(vertex)).collect();
            (content.z_values, content.common_z) = (Vec::new(), 0.0);
            Some(values)
        }
        Format::Ugrid => take_heights(content)
            .map(|(values, is_depth)| if is_depth { turned(values) } else { values }),
        Format::Selafin => take(content, selafin::write::BED),
        Format::Gmsh1
        | Format::Gmsh22
        | Format::Gmsh22Binary
        | Format::Gmsh40
        | Format::Gmsh40Binary
        | Format::Gmsh41
        | Format::Gmsh41Binary => {
            let depths = take(content, "depth").map(turned);
            let heights = depths.or_else(|| take(content, selafin::write::BED));
            match to {
                Format::Sms2dm | Format::Mike => heights,
                _ => heights.or_else(|| {
                    let is_any = !content.z_values.is_empty();
                    is_any.then(|| std::mem::take(&mut content.z_values))
                }),
            }
        }
        _ => None,
    };
    let Some(heights) = heights else { return };
    match to {
        Format::Sms2dm | Format::Mike => content.z_values = heights,
        Format::Adcirc => content.point_data.push(of_vertices("depth", turned(heights))),
        _ => content.point_data.push(of_vertices(selafin::write::BED, heights)),
    }
}

/// Removes data of vertices, and returns their values.
fn take(content: &mut Content, name: &str) -> Option<Vec<f64>> {
    let is_own = |data: &DataArray| data.name == name && data.components == 1;
    let at = content.point_data.iter().position(is_own)?;
    Some(content.point_data.remove(at).values)
}

fn of_vertices(name: &str, values: Vec<f64>) -> DataArray {
    DataArray { name: name.to_owned(), components: 1, is_real: true, values, packing: None }
}

/// Removes z, or else a depth, from the node variables of UGRID. Returns the values, and true for depths. `None` if
/// UGRID has neither variable.
fn take_heights(content: &mut Content) -> Option<(Vec<f64>, bool)> {
    let is_z = |data: &DataArray| data.name == "z" || data.name.ends_with("node_z");
    let is_depth = |data: &DataArray| data.name.to_ascii_lowercase().ends_with("depth");
    let find = |is: &dyn Fn(&DataArray) -> bool| {
        content.point_data.iter().position(|data| data.components == 1 && is(data))
    };
    let (at, is_depth) =
        find(&is_z).map(|at| (at, false)).or_else(|| Some((find(&is_depth)?, true)))?;
    Some((content.point_data.remove(at).values, is_depth))
}

pub(crate) fn write_sms(input: &WriterInput<'_>) -> String {
    let content = input.content;
    let mut out = "MESH2D\n".to_owned();
    let mut element = 0;
    for cell in input.cells() {
        let kind = match content.cells.kinds[cell] {
            CellKind::Triangle => "E3T",
            CellKind::Quadrilateral => "E4Q",
            CellKind::Line if !is_of_string(input, cell) => "E2L",
            _ => continue,
        };
        element += 1;
        put!(out, "{kind} {element} {} {}\n", input.vertex_ids(cell), input.group_number(cell));
    }
    for vertex in 0..content.points.len() {
        put!(out, "ND {} {}\n", input.vertex_id(vertex), input.xyz(vertex));
    }
    let mut materials = BTreeMap::new();
    for cell in input.cells() {
        let Some(group) = input.group_numbers.group(content, cell) else { continue };
        let is_line = content.cells.kinds[cell] == CellKind::Line;
        if let Some(name) = content.groups[group as usize].name().filter(|_| !is_line) {
            materials.insert(input.group_numbers.number(group), name);
        }
    }
    for (group, string) in strings(input) {
        let Some((last, before)) = string.split_last() else { continue };
        out.push_str("NS");
        before.iter().for_each(|&vertex| put!(out, " {}", input.vertex_id(vertex as usize)));
        put!(out, " -{}", input.vertex_id(*last as usize));
        match content.groups[group as usize].name() {
            Some(name) => put!(out, " \"{name}\"\n"),
            None => out.push('\n'),
        }
    }
    materials.iter().for_each(|(tag, name)| put!(out, "MAT {tag} \"{name}\"\n"));
    out
}

pub(crate) fn write_adcirc(input: &WriterInput<'_>) -> String {
    let content = input.content;
    let depth = input.point_data().next();
    let is_inside = |cell: &usize| content.cells.kinds[*cell] != CellKind::Line;
    let elements = || input.cells().filter(is_inside);
    let mut out = format!("grid\n{} {}\n", elements().count(), content.points.len());
    for vertex in 0..content.points.len() {
        let value = depth.map_or(0.0, |depth| depth.values[vertex]);
        put!(out, "{} {} {value:?}\n", input.vertex_id(vertex), input.xy(vertex));
    }
    for (cell, element) in elements().zip(1..) {
        put!(out, "{element} {} {}\n", content.cells.of(cell).len(), input.vertex_ids(cell));
    }
    // Boundaries whose names start with `open` are open; all others are land.
    let strings = strings(input);
    let name = |group: u32| content.groups[group as usize].name().unwrap_or("");
    for (what, is_open) in [("open", true), ("land", false)] {
        let of = |(group, _): &&(u32, Vec<u32>)| name(*group).starts_with("open") == is_open;
        let chosen: Vec<_> = strings.iter().filter(of).collect();
        let nodes: usize = chosen.iter().map(|(_, string)| string.len()).sum();
        put!(out, "{} = Number of {what} boundaries\n", chosen.len());
        put!(out, "{nodes} = Total number of {what} boundary nodes\n");
        for (group, string) in chosen {
            put!(out, "{}", string.len());
            if !is_open {
                put!(out, " {}", u8::from(name(*group).starts_with("island")));
            }
            put!(out, " = Number of nodes for {what} boundary\n");
            string.iter().for_each(|&vertex| put!(out, "{}\n", input.vertex_id(vertex as usize)));
        }
    }
    out
}

/// Writes the layout since 2012, as bathymetry in meters (kind of data 100079, unit 1000). Coordinates of a file without a
/// projection are local coordinates.
pub(crate) fn write_mike(input: &WriterInput<'_>) -> String {
    let content = input.content;
    let codes = node_codes(input);
    let projection =
        if content.projection.is_empty() { NO_PROJECTION } else { &content.projection };
    let mut out = format!("100079  1000  {}  {projection}\n", content.points.len());
    for (vertex, code) in codes.into_iter().enumerate() {
        put!(out, "{} {} {code}\n", input.vertex_id(vertex), input.xyz(vertex));
    }
    let has_four = input.count(CellKind::Quadrilateral) > 0;
    // The last number is the type of the elements: 21 for triangles, 25 for both kinds.
    let (most, kind) = if has_four { (4, 25) } else { (3, 21) };
    put!(out, "{}  {most}  {kind}\n", input.cells().count());
    for (cell, element) in input.cells().zip(1..) {
        let is_triangle = content.cells.kinds[cell] == CellKind::Triangle;
        let fourth = if has_four && is_triangle { " 0" } else { "" };
        put!(out, "{element} {}{fourth}\n", input.vertex_ids(cell));
    }
    out
}

/// Returns the code of each vertex. If the mesh has numbered groups of vertices, codes are their numbers. Otherwise codes are
/// those of boundaries.
fn node_codes(input: &WriterInput<'_>) -> Vec<i64> {
    let codes = input.vertex_group_numbers();
    match codes.iter().all(|&code| code == 0) {
        true => BoundaryCodes::new(input.content).codes,
        false => codes,
    }
}

/// Returns whether a line belongs to a node string, and not to a material.
fn is_of_string(input: &WriterInput<'_>, line: usize) -> bool {
    input.group(line).is_some_and(|group| group.kind != "material")
}

/// Returns the lines of each node string's group as chains of vertices, with the index of the group.
fn strings(input: &WriterInput<'_>) -> Vec<(u32, Vec<u32>)> {
    let mut lines: BTreeMap<u32, Vec<[u32; 2]>> = BTreeMap::new();
    for cell in input.all(CellKind::Line).filter(|&cell| is_of_string(input, cell)) {
        if let (Some(group), &[a, b]) =
            (input.group_numbers.group(input.content, cell), input.content.cells.of(cell))
        {
            lines.entry(group).or_default().push([a, b]);
        }
    }
    let chained = lines.into_iter().map(|(group, lines)| (group, chains(&lines)));
    chained.flat_map(|(group, chains)| chains.into_iter().map(move |c| (group, c))).collect()
}
