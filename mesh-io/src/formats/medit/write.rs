//! Writes Medit's `.mesh` and `.meshb`, and FreeFem's `.msh`.

use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::visit::items::CellKind;
use std::fmt::Write;

/// A list of elements: name, keyword in binary files, numbers per element (`width`), and the numbers of all elements.
struct List {
    name: &'static str,
    keyword: i32,
    width: usize,
    numbers: Vec<i64>,
}

/// The content that text and binary files share.
struct Medit {
    dimension: usize,
    /// The reference of each vertex.
    references: Vec<i64>,
    lists: Vec<List>,
}

impl Medit {
    fn new(input: &WriterInput<'_>) -> Medit {
        let content = input.content;
        let flat = content.z_values.is_empty() && content.common_z == 0.0;
        let mut references = input.vertex_group_numbers();
        // Points are written as references of their vertices, except those of the format's own lists.
        let is_listed = |cell: usize| input.group(cell).is_some_and(|group| group.kind == "list");
        for cell in input.all(CellKind::Point).filter(|&cell| !is_listed(cell)) {
            references[content.cells.of(cell)[0] as usize] = input.group_number(cell);
        }
        let places =
            |cell: usize| content.cells.of(cell).iter().map(|&vertex| i64::from(vertex) + 1);
        let mut lists = Vec::new();
        for (name, keyword) in [("Corners", 13), ("RequiredVertices", 15)] {
            let is_of = |cell: &usize| {
                let own = input.group(*cell).and_then(|group| group.name());
                is_listed(*cell) && own == Some(name)
            };
            let numbers = input.all(CellKind::Point).filter(is_of).flat_map(places).collect();
            lists.push(List { name, keyword, width: 1, numbers });
        }
        for (kind, name, keyword) in [
            (CellKind::Line, "Edges", 5),
            (CellKind::Triangle, "Triangles", 6),
            (CellKind::Quadrilateral, "Quadrilaterals", 7),
        ] {
            let numbers =
                input.all(kind).flat_map(|cell| places(cell).chain([input.group_number(cell)]));
            let (width, numbers) = (kind.nodes() + 1, numbers.collect());
            lists.push(List { name, keyword, width, numbers });
        }
        lists.retain(|list| !list.numbers.is_empty());
        Medit { dimension: if flat { 2 } else { 3 }, references, lists }
    }
}

pub(crate) fn write_medit(input: &WriterInput<'_>) -> String {
    let Medit { dimension, references, lists } = Medit::new(input);
    let mut out = format!("MeshVersionFormatted 2\nDimension {dimension}\n");
    put!(out, "Vertices\n{}\n", references.len());
    for (vertex, reference) in references.iter().enumerate() {
        let at = if dimension == 2 { input.xy(vertex) } else { input.xyz(vertex) };
        put!(out, "{at} {reference}\n");
    }
    for List { name, width, numbers, .. } in lists {
        put!(out, "{name}\n{}\n", numbers.len() / width);
        for row in numbers.chunks_exact(width) {
            let words: Vec<String> = row.iter().map(i64::to_string).collect();
            put!(out, "{}\n", words.join(" "));
        }
    }
    out.push_str("End\n");
    out
}

/// Limit on the length of files of version 2, whose offsets have 4 bytes. Longer files are written as version 3, with
/// 8 bytes.
const MAX_VERSION_2_BYTES: usize = 1 << 31;

pub(crate) fn write_meshb(input: &WriterInput<'_>) -> Vec<u8> {
    let medit = Medit::new(input);
    let small = meshb(input, &medit, 2);
    if small.len() < MAX_VERSION_2_BYTES { small } else { meshb(input, &medit, 3) }
}

fn meshb(input: &WriterInput<'_>, medit: &Medit, version: i32) -> Vec<u8> {
    let mut out = Vec::new();
    let ints = |numbers: &[i64]| -> Vec<u8> {
        numbers.iter().flat_map(|&number| (number as i32).to_le_bytes()).collect()
    };
    out.extend(ints(&[1, i64::from(version)]));
    // Writes a keyword, the offset of the next keyword (0 after the last keyword), and the content between.
    let mut chain = |keyword: i32, content: &[u8]| {
        out.extend(keyword.to_le_bytes());
        let width = if version == 2 { 4 } else { 8 };
        let is_last = keyword == 54;
        let next = if is_last { 0 } else { (out.len() + width + content.len()) as u64 };
        out.extend_from_slice(&next.to_le_bytes()[..width]);
        out.extend_from_slice(content);
    };
    chain(3, &ints(&[medit.dimension as i64]));
    let mut vertices = ints(&[medit.references.len() as i64]);
    for (vertex, &reference) in medit.references.iter().enumerate() {
        let [x, y] = input.content.points[vertex];
        for coordinate in [x, y, input.content.z(vertex)].into_iter().take(medit.dimension) {
            vertices.extend(coordinate.to_le_bytes());
        }
        vertices.extend(ints(&[reference]));
    }
    chain(4, &vertices);
    for List { keyword, width, numbers, .. } in &medit.lists {
        let count = (numbers.len() / width) as i64;
        chain(*keyword, &[ints(&[count]), ints(numbers)].concat());
    }
    chain(54, &[]);
    out
}

pub(crate) fn write_freefem(input: &WriterInput<'_>) -> String {
    let points = input.content.points.len();
    let counts = [points, input.count(CellKind::Triangle), input.count(CellKind::Line)];
    let mut out = format!("{} {} {}\n", counts[0], counts[1], counts[2]);
    for (vertex, label) in input.vertex_group_numbers().into_iter().enumerate() {
        put!(out, "{} {label}\n", input.xy(vertex));
    }
    for kind in [CellKind::Triangle, CellKind::Line] {
        for cell in input.all(kind) {
            put!(out, "{} {}\n", input.positions(cell, 1), input.group_number(cell));
        }
    }
    out
}
