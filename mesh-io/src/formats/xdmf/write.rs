//! Writer of XDMF with all numbers in the XML.

use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::formats::vtk::write::{Array, ArrayValues, of_cells, of_points};
use crate::visit::items::CellKind;
use std::fmt::Write;

pub(crate) fn write_xdmf(input: &WriterInput<'_>) -> String {
    let content = input.content;
    let cells: Vec<usize> = input.cells().collect();
    let (points, count) = (content.points.len(), cells.len());
    let mut out = "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"Grid\" GridType=\"Uniform\">\n"
        .to_owned();
    put!(
        out,
        "<Geometry GeometryType=\"XYZ\">\n<DataItem DataType=\"Float\" Dimensions=\"{points} 3\" Format=\"XML\" \
         Precision=\"8\">\n"
    );
    (0..points).for_each(|vertex| put!(out, "{}\n", input.xyz(vertex)));
    out.push_str("</DataItem>\n</Geometry>\n");
    let rows: Vec<String> = cells.iter().map(|&cell| row(input, cell)).collect();
    let words: usize = rows.iter().map(|row| row.split(' ').count()).sum();
    put!(
        out,
        "<Topology TopologyType=\"Mixed\" NumberOfElements=\"{count}\">\n<DataItem DataType=\"Int\" \
         Dimensions=\"{words}\" Format=\"XML\" Precision=\"8\">\n"
    );
    rows.iter().for_each(|row| put!(out, "{row}\n"));
    out.push_str("</DataItem>\n</Topology>\n");
    of_points(input).iter().for_each(|array| attribute(array, "Node", points, &mut out));
    of_cells(input, &cells).iter().for_each(|array| attribute(array, "Cell", count, &mut out));
    out.push_str("</Grid>\n</Domain>\n</Xdmf>\n");
    out
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
