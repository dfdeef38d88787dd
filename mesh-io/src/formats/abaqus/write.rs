//! Writes input files of Abaqus and CalculiX, `.inp`, with the mesh alone.

use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::precision::short_text;
use crate::visit::items::CellKind;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Maximum number of ids in a data line of `*NSET` and `*ELSET`.
const ROW: usize = 16;

pub(crate) fn write_inp(input: &WriterInput<'_>) -> String {
    let content = input.content;
    // Plane types (CPS3) have no third coordinate, shell types (S3) have one.
    let is_flat = content.z_values.is_empty() && content.common_z == 0.0;
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
    let mut sets: BTreeMap<String, Vec<u64>> = BTreeMap::new();
    for (cell, element) in input.cells().zip(1..) {
        let own = kind_of(cell);
        if last.replace(own) != Some(own) {
            put!(out, "*ELEMENT, TYPE={own}\n");
        }
        put!(out, "{element}, {}\n", input.vertex_ids(cell).replace(' ', ", "));
        for &group in input.stored_groups(cell) {
            sets.entry(input.name_or_number(group)).or_default().push(element);
        }
    }
    // Some programs read the parameter ELSET of several lists of elements as several sets.
    for (name, elements) in sets {
        put!(out, "*ELSET, ELSET={name}\n");
        rows(&elements, &mut out);
    }
    for (group, vertices) in &content.vertex_groups {
        put!(out, "*NSET, NSET={}\n", group.name().unwrap_or_default());
        let ids: Vec<u64> = vertices.iter().map(|&v| input.vertex_id(v as usize)).collect();
        rows(&ids, &mut out);
    }
    out
}

/// Writes the ids of a set.
fn rows(ids: &[u64], out: &mut String) {
    for row in ids.chunks(ROW) {
        let numbers: Vec<_> = row.iter().map(u64::to_string).collect();
        put!(out, "{}\n", numbers.join(", "));
    }
}
