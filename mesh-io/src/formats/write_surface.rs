//! Writes Wavefront's `.obj` and Geomview's `.off`.

use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::visit::items::Kind;
use std::fmt::Write;

pub(crate) fn write_obj(job: &WriterInput<'_>) -> String {
    let mut out = String::new();
    let content = job.content;
    (0..content.points.len()).for_each(|vertex| put!(out, "v {}\n", job.xyz(vertex)));
    let group_of = |cell: usize| job.group_numbers.group(content, cell);
    let all_are = |what: &str| {
        let groups = job.cells().filter_map(group_of);
        groups.into_iter().all(|group| content.groups[group as usize].what == what)
    };
    let keyword = match () {
        () if all_are("material") => "usemtl",
        () if all_are("object") => "o",
        () => "g",
    };
    let mut last = None;
    for cell in job.cells() {
        let group = group_of(cell);
        if group != last {
            // A group without a name ends the group before.
            let name =
                group.map(|group| format!(" {}", job.name_or_number(group))).unwrap_or_default();
            put!(out, "{keyword}{name}\n");
            last = group;
        }
        let letter = match content.cells.kinds[cell] {
            Kind::Point => 'p',
            Kind::Line => 'l',
            _ => 'f',
        };
        put!(out, "{letter} {}\n", job.positions(cell, 1));
    }
    out
}

pub(crate) fn write_off(job: &WriterInput<'_>) -> String {
    let content = job.content;
    let mut out = format!("OFF\n{} {} 0\n", content.points.len(), job.cells().count());
    (0..content.points.len()).for_each(|vertex| put!(out, "{}\n", job.xyz(vertex)));
    for cell in job.cells() {
        put!(out, "{} {}\n", content.cells.of(cell).len(), job.positions(cell, 0));
    }
    out
}
