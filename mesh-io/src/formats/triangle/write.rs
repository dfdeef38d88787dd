//! Writes the files of the mesh generator Triangle.

use crate::export::put;
use crate::export::writer_input::{WriterInput, text_of};
use crate::visit::items::CellKind;
use std::fmt::Write;

/// Returns the contents of the `.node`, the `.ele`, and the `.poly` if there are lines.
pub(crate) fn write(input: &WriterInput<'_>) -> Vec<String> {
    let content = input.content;
    let data: Vec<_> = input.point_data().collect();
    let markers = (!content.vertex_groups.is_empty()).then(|| input.vertex_group_numbers());
    let marked = usize::from(markers.is_some());
    let mut node = format!("{} 2 {} {marked}\n", content.points.len(), data.len());
    for vertex in 0..content.points.len() {
        put!(node, "{} {}", vertex + 1, input.xy(vertex));
        data.iter().for_each(|data| put!(node, " {}", text_of(data, data.values[vertex])));
        markers.iter().for_each(|markers| put!(node, " {}", markers[vertex]));
        node.push('\n');
    }
    let grouped = input.all(CellKind::Triangle).any(|cell| input.group(cell).is_some());
    let mut ele = format!("{} 3 {}\n", input.count(CellKind::Triangle), usize::from(grouped));
    for (cell, number) in input.all(CellKind::Triangle).zip(1..) {
        put!(ele, "{number} {}", input.positions(cell, 1));
        if grouped {
            // A fraction cannot be a tag, but can be the name of a group that stands for an attribute.
            let name =
                input.group(cell).and_then(|group| group.name()).filter(|name| is_number(name));
            put!(
                ele,
                " {}",
                name.map_or_else(|| input.group_number(cell).to_string(), str::to_owned)
            );
        }
        ele.push('\n');
    }
    let lines = input.count(CellKind::Line);
    if lines == 0 {
        return vec![node, ele];
    }
    let mut poly = format!("0 2 0 0\n{lines} 1\n");
    for (cell, number) in input.all(CellKind::Line).zip(1..) {
        put!(poly, "{number} {} {}\n", input.positions(cell, 1), input.group_number(cell));
    }
    poly.push_str("0\n");
    vec![node, ele, poly]
}

fn is_number(name: &str) -> bool {
    name.parse::<f64>().is_ok()
}
