//! Writer of XDMF with all numbers in the XML.
//!
//! A mesh whose faces are triangles has one grid of triangles, and lines and points in grids of mesh tags, as DOLFINx writes
//! them: DOLFIN and DOLFINx read no other cells beside triangles. Other meshes have one grid of all cells.

use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::formats::vtk::write::{Array, ArrayValues, of_cells, of_points};
use crate::visit::items::CellKind;
use std::fmt::Write;

pub(crate) fn write_xdmf(input: &WriterInput<'_>) -> String {
    let kinds = &input.content.cells.kinds;
    let of = |kind| -> Vec<usize> { input.all(kind).collect() };
    let [points, lines, triangles] = [CellKind::Point, CellKind::Line, CellKind::Triangle].map(of);
    let mut out = "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\" xmlns:xi=\"http://www.w3.org/2001/XInclude\">\n<Domain>\n\
                   <Grid Name=\"mesh\" GridType=\"Uniform\">\n"
        .to_owned();
    geometry(input, &mut out);
    let is_of_triangles = input.cells().count() == points.len() + lines.len() + triangles.len();
    // Mesh tags have whole numbers alone, for all lines or for none.
    let fits = |cells: &[usize]| {
        of_cells(input, cells).iter().all(|array| array.is_of_tags() || array.is_missing())
    };
    let are_tags =
        || of_cells(input, &[]).iter().all(Array::is_of_tags) && fits(&lines) && fits(&points);
    let has_tags = is_of_triangles && (points.is_empty() && lines.is_empty() || are_tags());
    let cells = if has_tags { triangles } else { input.cells().collect() };
    match has_tags {
        true => uniform(input, "Triangle", 3, &cells, &mut out),
        false => mixed(input, &cells, &mut out),
    }
    let count = input.content.points.len();
    of_points(input).iter().for_each(|array| attribute(array, "Node", count, &mut out));
    let arrays = match has_tags && kinds.len() > cells.len() {
        true => without_empty_groups(input, &cells),
        false => of_cells(input, &cells),
    };
    arrays.iter().for_each(|array| attribute(array, "Cell", cells.len(), &mut out));
    out.push_str("</Grid>\n");
    if has_tags {
        tags(input, "lines", "PolyLine", 2, &lines, &mut out);
        tags(input, "points", "PolyVertex", 1, &points, &mut out);
    }
    out.push_str("</Domain>\n</Xdmf>\n");
    out
}

/// Makes the arrays of some cells, without the numbers of groups to which none of these cells belong.
fn without_empty_groups(input: &WriterInput<'_>, cells: &[usize]) -> Vec<Array> {
    let mut arrays = of_cells(input, cells);
    // The data of the mesh follow the numbers of groups.
    let data = arrays.split_off(arrays.len() - input.cell_data().count());
    arrays.retain(|array| !array.is_zero());
    arrays.extend(data);
    arrays
}

/// Appends the points: x and y if z is 0 everywhere, as DOLFINx takes the columns for the dimension of space.
fn geometry(input: &WriterInput<'_>, out: &mut String) {
    let count = input.content.points.len();
    let is_flat = (0..count).all(|vertex| input.content.z(vertex) == 0.0);
    let (kind, columns) = if is_flat { ("XY", 2) } else { ("XYZ", 3) };
    put!(
        out,
        "<Geometry GeometryType=\"{kind}\">\n<DataItem DataType=\"Float\" Dimensions=\"{count} {columns}\" Format=\"XML\" \
         Precision=\"8\">\n"
    );
    for vertex in 0..count {
        let row = if is_flat { input.xy(vertex) } else { input.xyz(vertex) };
        put!(out, "{row}\n");
    }
    out.push_str("</DataItem>\n</Geometry>\n");
}

/// Appends a topology of cells of one kind with `corners` vertices each.
fn uniform(input: &WriterInput<'_>, kind: &str, corners: usize, cells: &[usize], out: &mut String) {
    let count = cells.len();
    put!(
        out,
        "<Topology TopologyType=\"{kind}\" NumberOfElements=\"{count}\" NodesPerElement=\"{corners}\">\n\
         <DataItem DataType=\"Int\" Dimensions=\"{count} {corners}\" Format=\"XML\" Precision=\"8\">\n"
    );
    cells.iter().for_each(|&cell| put!(out, "{}\n", input.positions(cell, 0)));
    out.push_str("</DataItem>\n</Topology>\n");
}

/// Appends a topology of cells of several kinds.
fn mixed(input: &WriterInput<'_>, cells: &[usize], out: &mut String) {
    let rows: Vec<String> = cells.iter().map(|&cell| row(input, cell)).collect();
    let words: usize = rows.iter().map(|row| row.split(' ').count()).sum();
    put!(
        out,
        "<Topology TopologyType=\"Mixed\" NumberOfElements=\"{}\">\n<DataItem DataType=\"Int\" \
         Dimensions=\"{words}\" Format=\"XML\" Precision=\"8\">\n",
        cells.len()
    );
    rows.iter().for_each(|row| put!(out, "{row}\n"));
    out.push_str("</DataItem>\n</Topology>\n");
}

/// Appends a grid of mesh tags, which refers to the points of the mesh.
fn tags(
    input: &WriterInput<'_>,
    name: &str,
    kind: &str,
    corners: usize,
    cells: &[usize],
    out: &mut String,
) {
    if cells.is_empty() {
        return;
    }
    put!(
        out,
        "<Grid Name=\"{name}\" GridType=\"Uniform\">\n<xi:include xpointer=\"xpointer(/Xdmf/Domain/Grid/Geometry)\"/>\n"
    );
    uniform(input, kind, corners, cells, out);
    let mut arrays = without_empty_groups(input, cells);
    // Data that only triangles have are NaN at lines, and no whole numbers.
    arrays.retain(Array::is_of_tags);
    if arrays.is_empty() {
        arrays.push(Array::whole(name, vec![0; cells.len()]));
    }
    arrays.iter().for_each(|array| attribute(array, "Cell", cells.len(), out));
    out.push_str("</Grid>\n");
}

/// Formats a cell: XDMF's type number, the vertex count of points, lines and polygons, and the vertices.
fn row(input: &WriterInput<'_>, cell: usize) -> String {
    let vertices = input.positions(cell, 0);
    match input.content.cells.kinds[cell] {
        CellKind::Point => format!("1 1 {vertices}"),
        CellKind::Line => format!("2 2 {vertices}"),
        CellKind::Triangle => format!("4 {vertices}"),
        CellKind::Quadrilateral => format!("5 {vertices}"),
        CellKind::Polygon => format!("3 {} {vertices}", input.content.cells.of(cell).len()),
    }
}

/// Appends an `Attribute` with the data of `count` nodes or cells.
fn attribute(array: &Array, center: &str, count: usize, out: &mut String) {
    let Array { name, components, numbers } = array;
    let name = quick_xml::escape::escape(name);
    let kind = match components {
        1 => "Scalar",
        3 => "Vector",
        9 => "Tensor",
        _ => "Matrix",
    };
    let (number, words): (_, Vec<String>) = match numbers {
        // NaN becomes `nan`, as C prints NaN, so that readers in C parse the text.
        ArrayValues::Real(numbers) => {
            ("Float", numbers.iter().map(|x| format!("{x:?}").to_lowercase()).collect())
        }
        ArrayValues::Whole(numbers) => ("Int", numbers.iter().map(i64::to_string).collect()),
    };
    let dimensions = match components {
        1 => count.to_string(),
        components => format!("{count} {components}"),
    };
    put!(
        out,
        "<Attribute Name=\"{name}\" AttributeType=\"{kind}\" Center=\"{center}\">\n<DataItem DataType=\"{number}\" \
         Dimensions=\"{dimensions}\" Format=\"XML\" Precision=\"8\">\n"
    );
    for row in words.chunks((*components).max(1)) {
        put!(out, "{}\n", row.join(" "));
    }
    out.push_str("</DataItem>\n</Attribute>\n");
}
