//! Writes SU2's `.su2`.

use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::formats::vtk::types;
use std::collections::HashMap;
use std::fmt::Write;

pub(crate) fn write(input: &WriterInput<'_>) -> String {
    let content = input.content;
    let is_inside = |cell: &usize| content.cells.kinds[*cell].dimension() == 2;
    let mut out = format!("NDIME= 2\nNELEM= {}\n", input.cells().filter(is_inside).count());
    for (index, cell) in input.cells().filter(is_inside).enumerate() {
        let kind = types::number_of(content.cells.kinds[cell]);
        put!(out, "{kind} {} {index}\n", input.positions(cell, 0));
    }
    put!(out, "NPOIN= {}\n", content.points.len());
    (0..content.points.len()).for_each(|vertex| put!(out, "{} {vertex}\n", input.xy(vertex)));
    // Lines without a group are in no marker.
    let marker = |cell: &usize| {
        let group = input.group_numbers.group(content, *cell).filter(|_| !is_inside(cell))?;
        Some((input.name_or_number(group), *cell))
    };
    let mut markers: Vec<(String, Vec<usize>)> = Vec::new();
    let mut places: HashMap<String, usize> = HashMap::new();
    for cell in input.cells() {
        let Some((name, cell)) = marker(&cell) else { continue };
        let place = *places.entry(name.clone()).or_insert(markers.len());
        if place == markers.len() {
            markers.push((name, Vec::new()));
        }
        markers[place].1.push(cell);
    }
    put!(out, "NMARK= {}\n", markers.len());
    for (name, cells) in markers {
        put!(out, "MARKER_TAG= {name}\nMARKER_ELEMS= {}\n", cells.len());
        for cell in cells {
            put!(out, "{} {}\n", types::LINE, input.positions(cell, 0));
        }
    }
    out
}
