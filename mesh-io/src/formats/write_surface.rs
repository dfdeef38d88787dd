//! Writes Wavefront's `.obj` and Geomview's `.off`.

use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::visit::items::CellKind;
use std::fmt::Write;

pub(crate) fn write_obj(input: &WriterInput<'_>) -> String {
    let mut out = String::new();
    let content = input.content;
    (0..content.points.len()).for_each(|vertex| put!(out, "v {}\n", input.xyz(vertex)));
    let group_of = |cell: usize| input.group_numbers.group(content, cell);
    let all_are = |what: &str| {
        let groups = input.cells().filter_map(group_of);
        groups.into_iter().all(|group| content.groups[group as usize].kind == what)
    };
    let keyword = match () {
        () if all_are("material") => "usemtl",
        () if all_are("object") => "o",
        () => "g",
    };
    let mut last = None;
    for cell in input.cells() {
        let group = group_of(cell);
        if group != last {
            // A group without a name ends the group before.
            let name =
                group.map(|group| format!(" {}", input.name_or_number(group))).unwrap_or_default();
            put!(out, "{keyword}{name}\n");
            last = group;
        }
        let letter = match content.cells.kinds[cell] {
            CellKind::Point => 'p',
            CellKind::Line => 'l',
            _ => 'f',
        };
        put!(out, "{letter} {}\n", input.positions(cell, 1));
    }
    out
}

pub(crate) fn write_off(input: &WriterInput<'_>) -> String {
    let content = input.content;
    let mut out = format!("OFF\n{} {} 0\n", content.points.len(), input.cells().count());
    (0..content.points.len()).for_each(|vertex| put!(out, "{}\n", input.xyz(vertex)));
    for cell in input.cells() {
        put!(out, "{} {}\n", content.cells.of(cell).len(), input.positions(cell, 0));
    }
    out
}
