//! Writes PLY, as text and in binary.

use crate::binary::byte_order::ByteOrder;
use crate::export::content::DataArray;
use crate::export::rows::Rows;
use crate::export::writer_input::WriterInput;
use crate::visit::items::CellKind;

/// Writes PLY as text. Point data with one number per vertex become properties of the vertices.
pub(crate) fn write_ply(input: &WriterInput<'_>) -> String {
    ply(input, None).into_text()
}

/// Writes PLY in binary.
pub(crate) fn write_ply_binary(input: &WriterInput<'_>) -> Vec<u8> {
    ply(input, Some(ByteOrder::Little)).into_bytes()
}

fn ply(input: &WriterInput<'_>, order: Option<ByteOrder>) -> Rows {
    let content = input.content;
    let data: Vec<&DataArray> = input.point_data().collect();
    let mut out = Rows::new(order);
    let encoding = if out.is_binary() { "binary_little_endian" } else { "ascii" };
    out.text(&format!("ply\nformat {encoding} 1.0\n"));
    out.text(&format!("element vertex {}\n", content.points.len()));
    out.text("property double x\nproperty double y\nproperty double z\n");
    let is_int = |data: &DataArray| {
        let fits = |&value: &f64| value.fract() == 0.0 && value.abs() <= f64::from(i32::MAX);
        !data.is_real && data.values.iter().all(fits)
    };
    let ints: Vec<bool> = data.iter().map(|data| is_int(data)).collect();
    for (data, &is_int) in data.iter().zip(&ints) {
        let kind = if is_int { "int" } else { "double" };
        out.text(&format!("property {kind} {}\n", data.name));
    }
    let faces = || {
        let is_face = |cell: &usize| content.cells.kinds[*cell].dimension() == 2;
        input.cells().filter(is_face)
    };
    out.text(&format!("element face {}\n", faces().count()));
    let has_large_faces = faces().any(|cell| content.cells.of(cell).len() > usize::from(u8::MAX));
    let count = if has_large_faces { "int" } else { "uchar" };
    out.text(&format!("property list {count} int vertex_indices\n"));
    if input.count(CellKind::Line) > 0 {
        out.text(&format!("element edge {}\n", input.count(CellKind::Line)));
        out.text("property int vertex1\nproperty int vertex2\n");
    }
    out.text("end_header\n");
    for (vertex, &[x, y]) in content.points.iter().enumerate() {
        [x, y, content.z(vertex)].into_iter().for_each(|x| out.real(x));
        for (data, is_int) in data.iter().zip(&ints) {
            match is_int {
                true => out.int(data.values[vertex] as i64),
                false => out.real(data.values[vertex]),
            }
        }
        out.end_row();
    }
    for (cell, has_count) in
        faces().map(|cell| (cell, true)).chain(input.all(CellKind::Line).map(|cell| (cell, false)))
    {
        let vertices = content.cells.of(cell);
        match (has_count, has_large_faces) {
            (true, false) => out.byte(vertices.len() as u8),
            (true, true) => out.int(vertices.len() as i64),
            (false, _) => {}
        }
        vertices.iter().for_each(|&vertex| out.int(i64::from(vertex)));
        out.end_row();
    }
    out
}
