//! Writes Medit's `.mesh` and FreeFem's `.msh`.

use super::job::Job;
use crate::file::sink::Kind;
use std::fmt::Write;

pub(crate) fn write_medit(job: &Job<'_>) -> String {
    let content = job.content;
    let flat = content.heights.is_empty() && content.height == 0.0;
    let dimension = if flat { 2 } else { 3 };
    let mut out = format!("MeshVersionFormatted 2\nDimension {dimension}\n");
    let mut references = job.vertex_tags();
    // Points are told by the references of their vertices, but for those of the format's own lists.
    let is_listed = |cell: usize| job.group(cell).is_some_and(|group| group.what == "list");
    for cell in job.all(Kind::Point).filter(|&cell| !is_listed(cell)) {
        references[content.cells.of(cell)[0] as usize] = job.tag(cell);
    }
    put!(out, "Vertices\n{}\n", content.points.len());
    for (vertex, reference) in references.iter().enumerate() {
        let at = if flat { job.plane(vertex) } else { job.space(vertex) };
        put!(out, "{at} {reference}\n");
    }
    for list in ["Corners", "RequiredVertices"] {
        let is_of = |cell: &usize| {
            let name = job.group(*cell).and_then(|group| group.name());
            is_listed(*cell) && name == Some(list)
        };
        let cells: Vec<usize> = job.all(Kind::Point).filter(is_of).collect();
        if !cells.is_empty() {
            put!(out, "{list}\n{}\n", cells.len());
            cells.iter().for_each(|&cell| put!(out, "{}\n", job.places(cell, 1)));
        }
    }
    for (kind, keyword) in [
        (Kind::Line, "Edges"),
        (Kind::Triangle, "Triangles"),
        (Kind::Quadrilateral, "Quadrilaterals"),
    ] {
        let count = job.count(kind);
        if count > 0 {
            put!(out, "{keyword}\n{count}\n");
            for cell in job.all(kind) {
                put!(out, "{} {}\n", job.places(cell, 1), job.tag(cell));
            }
        }
    }
    out.push_str("End\n");
    out
}

pub(crate) fn write_freefem(job: &Job<'_>) -> String {
    let points = job.content.points.len();
    let counts = [points, job.count(Kind::Triangle), job.count(Kind::Line)];
    let mut out = format!("{} {} {}\n", counts[0], counts[1], counts[2]);
    for (vertex, label) in job.vertex_tags().into_iter().enumerate() {
        put!(out, "{} {label}\n", job.plane(vertex));
    }
    for kind in [Kind::Triangle, Kind::Line] {
        for cell in job.all(kind) {
            put!(out, "{} {}\n", job.places(cell, 1), job.tag(cell));
        }
    }
    out
}
