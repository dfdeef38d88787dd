//! Writer of VTK's formats: legacy `.vtk` as text, and `.vtu` with base64 arrays.

use crate::export::content::DataArray;
use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::formats::vtk::types::number_of;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write;

/// Returns the usual array name for a kind of group, by which other programs recognize regions. Other group kinds name
/// their array themselves.
fn array_name(what: &str) -> &str {
    match what {
        "physical" => "gmsh:physical",
        "entity" => "gmsh:geometrical",
        "reference" | "label" => "medit:ref",
        "material" => "MaterialIDs",
        "attribute" => "region",
        "zone" => "domain",
        "marker" | "boundary" | "nodestring" | "list" => "cell_tags",
        other => other,
    }
}

/// An array of real or whole numbers for the written file.
pub(crate) struct Array {
    pub(crate) name: String,
    /// Numbers per vertex or cell.
    pub(crate) components: usize,
    pub(crate) numbers: ArrayValues,
}

/// Values of an array, tuple by tuple.
pub(crate) enum ArrayValues {
    Real(Vec<f64>),
    Whole(Vec<i64>),
}

impl Array {
    /// Copies data in file order, or the tuples of the cells `places`. Whole numbers become real ones if some value is
    /// not finite, as integers have no NaN.
    fn of(data: &DataArray, places: Option<&[usize]>) -> Array {
        let each = data.components;
        let values: Vec<f64> = match places {
            None => data.values.clone(),
            Some(places) => {
                let of = |&place: &usize| data.values[place * each..(place + 1) * each].to_vec();
                places.iter().flat_map(of).collect()
            }
        };
        let is_whole = !data.is_real && values.iter().all(|value| value.is_finite());
        let numbers = match is_whole {
            true => ArrayValues::Whole(values.into_iter().map(|value| value as i64).collect()),
            false => ArrayValues::Real(values),
        };
        Array { name: data.name.clone(), components: each, numbers }
    }

    fn whole(name: &str, numbers: Vec<i64>) -> Array {
        Array { name: name.to_owned(), components: 1, numbers: ArrayValues::Whole(numbers) }
    }
}

/// Makes the point data: the mesh's own arrays, then an array of vertex groups if the mesh has any.
pub(crate) fn of_points(input: &WriterInput<'_>) -> Vec<Array> {
    let mut arrays: Vec<Array> = input.point_data().map(|data| Array::of(data, None)).collect();
    if !input.content.vertex_groups.is_empty() {
        let what = &input.content.vertex_groups[0].0.kind;
        arrays.push(Array::whole(array_name(what), input.vertex_group_numbers()));
    }
    arrays
}

/// Makes the cell data: an array of group numbers per kind of group, then the mesh's own arrays. `cells` are the
/// written cells in order.
pub(crate) fn of_cells(input: &WriterInput<'_>, cells: &[usize]) -> Vec<Array> {
    let mut kinds: Vec<&str> = Vec::new();
    for what in (0..3).rev().flat_map(|dimension| input.content.group_kinds(dimension)) {
        if !kinds.contains(&what) {
            kinds.push(what);
        }
    }
    // Arrays with usual names come first, in a fixed order, whichever group the mesh lists first.
    const FIRST: [&str; 5] =
        ["gmsh:physical", "gmsh:geometrical", "medit:ref", "MaterialIDs", "region"];
    kinds.sort_by_key(|what| {
        FIRST.iter().position(|first| *first == array_name(what)).unwrap_or(FIRST.len())
    });
    let mut arrays: Vec<Array> = Vec::new();
    for what in kinds {
        let column = input.content.column(what);
        let tag = |&cell: &usize| column[cell].map_or(0, |group| input.group_numbers.number(group));
        let usual = array_name(what);
        let is_taken = arrays.iter().any(|array| array.name == usual);
        let name = if is_taken { what } else { usual };
        arrays.push(Array::whole(name, cells.iter().map(tag).collect()));
    }
    arrays.extend(input.cell_data().map(|data| Array::of(data, Some(cells))));
    arrays
}

pub(crate) fn write_legacy(input: &WriterInput<'_>) -> String {
    let content = input.content;
    let cells: Vec<usize> = input.cells().collect();
    let mut out = format!(
        "# vtk DataFile Version 4.2\nwritten by {}\nASCII\nDATASET UNSTRUCTURED_GRID\n",
        input.creator
    );
    put!(out, "POINTS {} double\n", content.points.len());
    (0..content.points.len()).for_each(|vertex| put!(out, "{}\n", input.xyz(vertex)));
    let numbers: usize = cells.iter().map(|&cell| 1 + content.cells.of(cell).len()).sum();
    put!(out, "CELLS {} {numbers}\n", cells.len());
    for &cell in &cells {
        put!(out, "{} {}\n", content.cells.of(cell).len(), input.positions(cell, 0));
    }
    put!(out, "CELL_TYPES {}\n", cells.len());
    cells.iter().for_each(|&cell| put!(out, "{}\n", number_of(content.cells.kinds[cell])));
    for (keyword, count, arrays) in [
        ("CELL_DATA", cells.len(), of_cells(input, &cells)),
        ("POINT_DATA", content.points.len(), of_points(input)),
    ] {
        if arrays.is_empty() {
            continue;
        }
        put!(out, "{keyword} {count}\nFIELD FieldData {}\n", arrays.len());
        for Array { name, components, numbers } in arrays {
            let (kind, words): (_, Vec<String>) = match numbers {
                ArrayValues::Real(numbers) => {
                    ("double", numbers.iter().map(|x| format!("{x:?}").to_lowercase()).collect())
                }
                ArrayValues::Whole(numbers) => {
                    let small = numbers.iter().all(|&number| i32::try_from(number).is_ok());
                    let kind = if small { "int" } else { "long" };
                    (kind, numbers.iter().map(i64::to_string).collect())
                }
            };
            put!(out, "{} {components} {count} {kind}\n", encoded(&name));
            for row in words.chunks(components.max(1)) {
                put!(out, "{}\n", row.join(" "));
            }
        }
    }
    out
}

/// Encodes a name as a single word: bytes outside of `!` to `~`, quotes and percent signs become `%` and two
/// hexadecimal digits, as in VTK.
fn encoded(name: &str) -> String {
    let mut encoded = String::new();
    for byte in name.bytes() {
        match byte {
            b'!'..=b'~' if !matches!(byte, b'"' | b'%') => encoded.push(char::from(byte)),
            _ => put!(encoded, "%{byte:02X}"),
        }
    }
    encoded
}

pub(crate) fn write_xml(input: &WriterInput<'_>) -> String {
    let content = input.content;
    let cells: Vec<usize> = input.cells().collect();
    let mut out = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
                   byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
        .to_owned();
    let (points, count) = (content.points.len(), cells.len());
    put!(out, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{count}\">\n");
    let at = |vertex: usize| {
        let [x, y] = content.points[vertex];
        [x, y, content.z(vertex)]
    };
    let coordinates = Array {
        name: "Points".into(),
        components: 3,
        numbers: ArrayValues::Real((0..points).flat_map(at).collect()),
    };
    let connectivity = cells.iter().flat_map(|&cell| content.cells.of(cell));
    let connectivity = connectivity.map(|&vertex| i64::from(vertex)).collect();
    let mut end = 0;
    let ends = cells.iter().map(|&cell| {
        end += content.cells.of(cell).len() as i64;
        end
    });
    let ends = ends.collect();
    let types = cells.iter().map(|&cell| number_of(content.cells.kinds[cell]) as i64).collect();
    let sections = [
        ("PointData", of_points(input)),
        ("CellData", of_cells(input, &cells)),
        ("Points", vec![coordinates]),
        (
            "Cells",
            vec![
                Array::whole("connectivity", connectivity),
                Array::whole("offsets", ends),
                Array::whole("types", types),
            ],
        ),
    ];
    for (section, arrays) in sections {
        put!(out, "<{section}>\n");
        for Array { name, components, numbers } in arrays {
            let (kind, bytes): (_, Vec<u8>) = match numbers {
                ArrayValues::Real(numbers) => {
                    ("Float64", numbers.iter().flat_map(|number| number.to_le_bytes()).collect())
                }
                ArrayValues::Whole(numbers) => {
                    ("Int64", numbers.iter().flat_map(|number| number.to_le_bytes()).collect())
                }
            };
            let length = (bytes.len() as u64).to_le_bytes();
            let text = STANDARD.encode([&length[..], &bytes].concat());
            let name = quick_xml::escape::escape(&name);
            put!(
                out,
                "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
                 format=\"binary\">\n{text}\n</DataArray>\n"
            );
        }
        put!(out, "</{section}>\n");
    }
    out.push_str("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    out
}
