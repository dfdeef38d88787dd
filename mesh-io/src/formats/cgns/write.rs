//! Writer of CGNS in HDF5: one zone, a section for the elements of each shape and group, and a boundary condition for
//! each section of lines and each group of vertices.

use crate::export::blocks::{Block, blocks};
use crate::export::name_rules::{NameRules, distinct};
use crate::export::writer_input::WriterInput;
use crate::hdf5::write::{NewObject, Values};
use crate::visit::items::CellKind;

/// Names of nodes beside the sections of the zone and beside the families of the base.
pub(crate) const NAMES: [&str; 5] = ["ZoneType", "GridCoordinates", "ZoneBC", "VertexData", "Zone"];
/// Name of the section of lines without a group.
pub(crate) const LINES: &str = "lines";

/// Returns the number of an element type, and a name for sections of elements without a group.
fn type_of(kind: CellKind) -> (i32, &'static str) {
    match kind {
        CellKind::Point => (2, "points"),
        CellKind::Line => (3, LINES),
        CellKind::Triangle => (5, "triangles"),
        CellKind::Quadrilateral => (7, "quadrilaterals"),
        CellKind::Polygon => (22, "polygons"),
    }
}

/// Writes vertices, elements, groups, and data of vertices.
pub(crate) fn write_cgns(input: &WriterInput<'_>) -> Vec<u8> {
    let content = input.content;
    let axes = if input.is_flat() { 2 } else { 3 };
    let mut file = NewObject::default();
    let texts = [("name", "HDF5 MotherNode", 33), ("label", "Root Node of HDF5 File", 33)];
    for (name, text, size) in [&texts[..], &[("type", "MT", 3)]].concat() {
        file.attribute(name, Values::text(text.as_bytes(), size));
    }
    file.dataset(" format", Values::chars(b"IEEE_LITTLE_32\0"));
    let mut version = b"HDF5 Version 1.10.8".to_vec();
    version.resize(33, 0);
    file.dataset(" hdf5version", Values::chars(&version));
    let version = node(&mut file, "CGNSLibraryVersion", "CGNSLibraryVersion_t", "R4");
    version.dataset(" data", Values::singles([3.4]));

    let base = ints(&mut file, "Base", "CGNSBase_t", Values::ints([2, axes]));
    let blocks = blocks(content, input.cells(), |cell| input.group_numbers.group(content, cell));
    let is_surface = |block: &&Block| block.kind.dimension() == 2;
    let surfaces: usize = blocks.iter().filter(is_surface).map(|block| block.cells.len()).sum();
    // Numbers of vertices, of elements and of boundary vertices, which is 0 for vertices in any order.
    let sizes = [content.points.len() as i32, surfaces as i32, 0];
    let zone = ints(base, "Zone", "Zone_t", Values::ints(sizes).shaped(&[3, 1]));
    chars(zone, "ZoneType", "ZoneType_t", "Unstructured");

    let grid = node(zone, "GridCoordinates", "GridCoordinates_t", "MT");
    for (axis, name) in
        ["CoordinateX", "CoordinateY", "CoordinateZ"].into_iter().enumerate().take(axes as usize)
    {
        reals(grid, name, input.axis(axis));
    }
    let families = sections(input, &blocks, zone);
    let data: Vec<_> = input.point_data().collect();
    if !data.is_empty() {
        let solution = node(zone, "VertexData", "FlowSolution_t", "MT");
        chars(solution, "GridLocation", "GridLocation_t", "Vertex");
        for own in data {
            reals(solution, &own.name, own.values.iter().copied());
        }
    }
    for family in families {
        let family = node(base, &family, "Family_t", "MT");
        chars(family, "FamilyBC", "FamilyBC_t", "Null");
    }
    file.file()
}

/// Adds sections and boundary conditions. Returns the names of boundary conditions on lines, which are also the names of
/// their families.
fn sections(input: &WriterInput<'_>, blocks: &[Block], zone: &mut NewObject) -> Vec<String> {
    let content = input.content;
    let named = blocks.iter().filter_map(|block| Some(input.name_or_number(block.group?)));
    let others = blocks.iter().filter(|block| block.group.is_none());
    let others = others.map(|block| type_of(block.kind).1.to_owned());
    // Names of groups stay, and other names differ from them.
    let names: Vec<String> = named.chain(others).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let names =
        distinct(&names, NameRules::Node32, &NAMES, |place| format!("section{}", place + 1));
    let grouped = blocks.iter().filter(|block| block.group.is_some()).count();
    let (mut named, mut others) = (names[..grouped].iter(), names[grouped..].iter());
    let name = |block: &Block| match block.group {
        Some(_) => named.next(),
        None => others.next(),
    };
    let names: Vec<&String> = blocks.iter().filter_map(name).collect();
    let mut boundaries: Vec<(&str, Values)> = Vec::new();
    let mut first = 1;
    for (block, name) in blocks.iter().zip(&names) {
        let kind = type_of(block.kind).0;
        let section = ints(zone, name, "Elements_t", Values::ints([kind, 0]));
        let last = first + block.cells.len() as i32 - 1;
        ints(section, "ElementRange", "IndexRange_t", Values::ints([first, last]));
        let corners = block.cells.iter().flat_map(|&cell| content.cells.of(cell));
        let corners = Values::ints(corners.map(|&vertex| vertex as i32 + 1));
        ints(section, "ElementConnectivity", "DataArray_t", corners);
        if block.kind == CellKind::Line {
            boundaries.push((name, Values::ints([first, last]).shaped(&[2, 1])));
        }
        first = last + 1;
    }
    if boundaries.is_empty() && content.vertex_groups.is_empty() {
        return Vec::new();
    }
    let all = node(zone, "ZoneBC", "ZoneBC_t", "MT");
    let families = boundaries.iter().map(|(name, _)| (*name).to_owned()).collect();
    // VTK reads only boundary conditions of families.
    for (name, range) in boundaries {
        let boundary = chars(all, name, "BC_t", "FamilySpecified");
        chars(boundary, "FamilyName", "FamilyName_t", name);
        ints(boundary, "PointRange", "IndexRange_t", range);
        chars(boundary, "GridLocation", "GridLocation_t", "EdgeCenter");
    }
    for (group, vertices) in &content.vertex_groups {
        let mut vertices: Vec<i32> = vertices.iter().map(|&vertex| vertex as i32 + 1).collect();
        vertices.sort_unstable();
        let boundary = chars(all, group.name().unwrap_or_default(), "BC_t", "Null");
        let count = vertices.len();
        let list = Values::ints(vertices).shaped(&[count, 1]);
        ints(boundary, "PointList", "IndexArray_t", list);
        chars(boundary, "GridLocation", "GridLocation_t", "Vertex");
    }
    families
}

/// Adds a node of CGNS. `kind` is its type of numbers: `I4`, `R4`, `R8`, `C1`, or `MT` for a node without content.
fn node<'n>(of: &'n mut NewObject, name: &str, label: &str, kind: &str) -> &'n mut NewObject {
    let node = of.add(name);
    for (attribute, text, size) in [("name", name, 33), ("label", label, 33), ("type", kind, 3)] {
        node.attribute(attribute, Values::text(text.as_bytes(), size));
    }
    node.attribute("flags", Values::ints([1]))
}

fn ints<'n>(of: &'n mut NewObject, name: &str, label: &str, values: Values) -> &'n mut NewObject {
    let node = node(of, name, label, "I4");
    node.dataset(" data", values);
    node
}

fn chars<'n>(of: &'n mut NewObject, name: &str, label: &str, text: &str) -> &'n mut NewObject {
    let node = node(of, name, label, "C1");
    node.dataset(" data", Values::chars(text.as_bytes()));
    node
}

fn reals(of: &mut NewObject, name: &str, values: impl Iterator<Item = f64>) {
    node(of, name, "DataArray_t", "R8").dataset(" data", Values::reals(values));
}
