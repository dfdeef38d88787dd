//! Writes input files of Abaqus and CalculiX, `.inp`, with the mesh alone.

use crate::content::group_label::GroupLabel;
use crate::export::name_rules::{NameRules, distinct};
use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::precision::short_text;
use crate::visit::items::CellKind;
use std::fmt::Write;

/// Maximum number of ids in a data line of `*NSET`.
const ROW: usize = 16;

pub(crate) fn write_inp(input: &WriterInput<'_>) -> String {
    let content = input.content;
    // Plane types (CPS3) have no third coordinate, shell types (S3) have one.
    let is_flat = content.z_values.is_empty();
    let mut out = "*HEADING\nmesh\n*NODE\n".to_owned();
    for (vertex, [x, y]) in content.points.iter().enumerate() {
        put!(out, "{}, {}, {}", input.vertex_id(vertex), short_text(*x), short_text(*y));
        if !is_flat {
            put!(out, ", {}", short_text(content.z(vertex)));
        }
        out.push('\n');
    }
    let kind_of = |cell: usize| match (content.cells.kinds[cell], is_flat) {
        (CellKind::Triangle, true) => "CPS3",
        (CellKind::Triangle, false) => "S3",
        (CellKind::Quadrilateral, true) => "CPS4",
        (CellKind::Quadrilateral, false) => "S4",
        (_, true) => "T2D2",
        (_, false) => "T3D2",
    };
    let mut last = None;
    for (cell, element) in input.cells().zip(1..) {
        let own = (kind_of(cell), input.group_numbers.group(content, cell));
        if last.replace(own) != Some(own) {
            put!(out, "*ELEMENT, TYPE={}", own.0);
            let set = own.1.map(|group| format!(", ELSET={}", input.name_or_number(group)));
            put!(out, "{}\n", set.unwrap_or_default());
        }
        put!(out, "{element}, {}\n", input.vertex_ids(cell).replace(' ', ", "));
    }
    let names: Vec<&str> =
        content.vertex_groups.iter().map(|(group, _)| group.name().unwrap_or_default()).collect();
    let number = |place: usize| {
        let (group, _) = &content.vertex_groups[place];
        match &group.label {
            GroupLabel::Tag(tag) => tag.to_string(),
            GroupLabel::Name(name) => name.clone(),
        }
    };
    let names =
        distinct(&names, NameRules::Label, &[], |place| NameRules::Label.of(&number(place)));
    for ((_, vertices), name) in content.vertex_groups.iter().zip(names) {
        put!(out, "*NSET, NSET={name}\n");
        for row in vertices.chunks(ROW) {
            let numbers: Vec<_> =
                row.iter().map(|&v| input.vertex_id(v as usize).to_string()).collect();
            put!(out, "{}\n", numbers.join(", "));
        }
    }
    out
}
