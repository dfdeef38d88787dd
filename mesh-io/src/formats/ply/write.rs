//! Writes PLY.

use crate::export::content::DataArray;
use crate::export::put;
use crate::export::writer_input::{WriterInput, text_of};
use crate::visit::items::CellKind;
use std::fmt::Write;

/// Writes PLY as text. Point data with one number per vertex become properties of the vertices.
pub(crate) fn write_ply(input: &WriterInput<'_>) -> String {
    let content = input.content;
    let data: Vec<&DataArray> = input.point_data().collect();
    let mut out = "ply\nformat ascii 1.0\n".to_owned();
    put!(out, "element vertex {}\n", content.points.len());
    out.push_str("property double x\nproperty double y\nproperty double z\n");
    for data in &data {
        let kind = if data.is_real { "double" } else { "int" };
        put!(out, "property {kind} {}\n", data.name);
    }
    let faces = || {
        let is_face = |cell: &usize| content.cells.kinds[*cell].dimension() == 2;
        input.cells().filter(is_face)
    };
    put!(out, "element face {}\n", faces().count());
    out.push_str("property list uchar int vertex_indices\n");
    if input.count(CellKind::Line) > 0 {
        put!(out, "element edge {}\n", input.count(CellKind::Line));
        out.push_str("property int vertex1\nproperty int vertex2\n");
    }
    out.push_str("end_header\n");
    for vertex in 0..content.points.len() {
        out.push_str(&input.xyz(vertex));
        data.iter().for_each(|data| put!(out, " {}", text_of(data, data.values[vertex])));
        out.push('\n');
    }
    for cell in faces() {
        put!(out, "{} {}\n", content.cells.of(cell).len(), input.positions(cell, 0));
    }
    input.all(CellKind::Line).for_each(|cell| put!(out, "{}\n", input.positions(cell, 0)));
    out
}
