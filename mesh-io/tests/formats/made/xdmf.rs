//! Makes XDMF files with all numbers in the XML.

use super::{
    LINE, Made, POINT, PROBED, QUADRILATERAL, Text, cells, fixing, joined, points, region, regions,
    z,
};
use mesh_io::Format;
use mesh_io::Precision;
use support::Mesh;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    vec![mixed(mesh), triangles(mesh)]
}

/// Makes an XDMF of version 3 with a mixed topology, regions, and data of two time steps.
fn mixed(mesh: &Mesh) -> Made {
    let mut text = Text::new(
        "<?xml version=\"1.0\" ?>\n<!-- <Geometry> -->\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"3.0\">\n\
         <Domain>\n<Grid Name='of all kinds'>\n<Geometry Type=\"XYZ\">\n<DataItem DataType=\"Float\" Dimensions=\"",
    );
    text.count(mesh.points.len());
    text.put(" 3\" Format=\"XML\" Precision=\"8\">\n");
    let vertices = text.rows(points(mesh).map(|(i, at)| format!("{at}\n {}", z(i))));
    text.put("</DataItem></Geometry>\n<Topology TopologyType=\"Mixed\" NumberOfElements=\"");
    let cells = cells(mesh);
    text.count(cells.len() + 2);
    let words: usize = cells.iter().map(|cell| cell.len() + 1).sum::<usize>() + 4 + 3;
    text.put("\"><DataItem DataType=\"Int\" Dimensions=\"");
    text.count(words);
    text.put("\" Format=\"XML\" Precision=\"8\">");
    let kind = |cell: &[u32]| if cell.len() == 3 { 4 } else { 5 };
    let rows = cells.iter().map(|cell| format!("{} {}", kind(cell), joined(cell, 0)));
    let rows: Vec<String> =
        rows.chain([format!("2 2\t{}", joined(&LINE, 0)), format!("1 1 {POINT}")]).collect();
    let elements = text.rows(rows);
    text.put("</DataItem></Topology>\n<Attribute Name=\"region\" Center=\"Cell\"><DataItem DataType=\"Int\" Format=\"XML\">\n");
    let mut triangle = 0;
    for cell in &cells {
        text.put(&format!("{} ", region(triangle)));
        triangle += usize::from(cell.len() == 3);
    }
    text.put("0 0</DataItem></Attribute>\n");
    for _ in 0..2 {
        text.put("<Attribute Center=\"Node\" Name=\"T\"><DataItem Format='XML' DataType=\"Float\" Precision=\"4\" Dimensions=\"30\">\n");
        (0..mesh.points.len()).for_each(|i| text.put(&format!("{} ", i as f64 * 0.5)));
        text.put("</DataItem></Attribute>\n");
    }
    text.put("</Grid></Domain></Xdmf>\n");
    let regions = regions(mesh);
    let mesh = fixing(mesh, QUADRILATERAL.into_iter().chain(LINE).chain([POINT]));
    let vertex = PROBED.0 as usize;
    // Cells are counted from 0, and the quadrilateral comes before the probed triangle.
    let probes = [(vertex as u64, vertices[vertex]), (PROBED.1 as u64 + 1, elements[PROBED.1 + 1])];
    let made = text.made("of several kinds", "in.xdmf", Format::Xdmf, mesh, probes);
    Made { regions, ..made }
}

/// Makes an XDMF of version 2 with triangles alone, and planar points of single precision.
fn triangles(mesh: &Mesh) -> Made {
    let mut text = Text::new(
        "<Xdmf Version=\"2.2\"><Domain><Grid><Topology TopologyType=\"Triangle\" NumberOfElements=\"",
    );
    text.count(mesh.triangles.len());
    text.put("\">\n<DataItem Format=\"XML\" NumberType=\"UInt\" Dimensions=\"");
    text.count(mesh.triangles.len());
    text.put(" 3\">\n");
    let rows = mesh.triangles.iter().map(|t| joined(t, 0));
    let elements = text.rows(rows);
    text.put("</DataItem></Topology><Geometry GeometryType=\"XY\"><DataItem Format=\"XML\" Dimensions=\"");
    text.count(mesh.points.len());
    text.put(" 2\">");
    let vertices = text.rows(points(mesh).map(|(_, at)| at));
    text.put("</DataItem>\n</Geometry></Grid>\n<Grid><Topology Reference=\"/Xdmf/Domain/Grid[1]/Topology\"/></Grid></Domain></Xdmf>");
    let vertex = PROBED.0 as usize;
    let probes = [(vertex as u64, vertices[vertex]), (PROBED.1 as u64, elements[PROBED.1])];
    let made = text.made("of triangles", "in.xmf", Format::Xdmf, mesh.clone(), probes);
    Made { precision: Precision::Single, ..made }
}
