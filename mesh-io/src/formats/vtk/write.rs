//! Arrays of groups and data for VTK's formats, and the writer of legacy `.vtk`, as text and in binary.

use crate::binary::byte_order::ByteOrder;
use crate::export::content::DataArray;
use crate::export::content_builder::common_kind;
use crate::export::put;
use crate::export::rows::Rows;
use crate::export::writer_input::WriterInput;
use crate::formats::vtk::types::number_of;
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

/// Returns the old and the new name of each region array that has another name in the written file. `names` are names of
/// arrays in a file of VTK's formats or of XDMF.
pub(crate) fn renamed_regions(names: &[String]) -> Vec<(&str, String)> {
    let new = |name: &String| array_name(&common_kind(name)).to_owned();
    let renamed = names.iter().map(|name| (name.as_str(), new(name)));
    renamed.filter(|(old, new)| old != new).collect()
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

impl ArrayValues {
    /// Returns whether the values are whole numbers of at most 32 bits.
    fn is_small(&self) -> bool {
        match self {
            ArrayValues::Real(_) => false,
            ArrayValues::Whole(numbers) => {
                numbers.iter().all(|&number| i32::try_from(number).is_ok())
            }
        }
    }

    /// Returns VTK's type for the values, of the fewest bytes, and the values in little byte order.
    pub(crate) fn little(&self) -> (&'static str, Vec<u8>) {
        match self {
            ArrayValues::Real(numbers) => {
                ("Float64", numbers.iter().flat_map(|number| number.to_le_bytes()).collect())
            }
            ArrayValues::Whole(numbers) => {
                if numbers.iter().all(|&number| u8::try_from(number).is_ok()) {
                    ("UInt8", numbers.iter().map(|&number| number as u8).collect())
                } else if self.is_small() {
                    let bytes = |&number: &i64| (number as i32).to_le_bytes();
                    ("Int32", numbers.iter().flat_map(bytes).collect())
                } else {
                    ("Int64", numbers.iter().flat_map(|number| number.to_le_bytes()).collect())
                }
            }
        }
    }
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

    /// Returns whether each value is a whole number.
    pub(crate) fn is_of_tags(&self) -> bool {
        self.components == 1 && matches!(self.numbers, ArrayValues::Whole(_))
    }

    /// Returns whether all values are the whole number 0, as of groups that no cell has.
    pub(crate) fn is_zero(&self) -> bool {
        matches!(&self.numbers, ArrayValues::Whole(numbers) if numbers.iter().all(|&number| number == 0))
    }

    /// Returns whether all numbers are missing, as those of lines in data of triangles.
    pub(crate) fn is_missing(&self) -> bool {
        matches!(&self.numbers, ArrayValues::Real(numbers) if numbers.iter().all(|x| x.is_nan()))
    }

    pub(crate) fn whole(name: &str, numbers: Vec<i64>) -> Array {
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
    legacy(input, None).into_text()
}

/// Writes a legacy file in binary, which has the big byte order.
pub(crate) fn write_legacy_binary(input: &WriterInput<'_>) -> Vec<u8> {
    legacy(input, Some(ByteOrder::Big)).into_bytes()
}

fn legacy(input: &WriterInput<'_>, order: Option<ByteOrder>) -> Rows {
    let content = input.content;
    let cells: Vec<usize> = input.cells().collect();
    let mut out = Rows::new(order);
    let encoding = if out.is_binary() { "BINARY" } else { "ASCII" };
    out.text(&format!(
        "# vtk DataFile Version 4.2\nwritten by {}\n{encoding}\nDATASET UNSTRUCTURED_GRID\n",
        input.creator
    ));
    out.text(&format!("POINTS {} double\n", content.points.len()));
    for (vertex, &[x, y]) in content.points.iter().enumerate() {
        [x, y, content.z(vertex)].into_iter().for_each(|x| out.real(x));
        out.end_row();
    }
    out.end_list();
    let numbers: usize = cells.iter().map(|&cell| 1 + content.cells.of(cell).len()).sum();
    out.text(&format!("CELLS {} {numbers}\n", cells.len()));
    for &cell in &cells {
        let vertices = content.cells.of(cell);
        out.int(vertices.len() as i64);
        vertices.iter().for_each(|&vertex| out.int(i64::from(vertex)));
        out.end_row();
    }
    out.end_list();
    out.text(&format!("CELL_TYPES {}\n", cells.len()));
    for &cell in &cells {
        out.int(number_of(content.cells.kinds[cell]) as i64);
        out.end_row();
    }
    out.end_list();
    for (keyword, count, arrays) in [
        ("CELL_DATA", cells.len(), of_cells(input, &cells)),
        ("POINT_DATA", content.points.len(), of_points(input)),
    ] {
        if arrays.is_empty() {
            continue;
        }
        out.text(&format!("{keyword} {count}\nFIELD FieldData {}\n", arrays.len()));
        for Array { name, components, numbers } in arrays {
            let is_small = numbers.is_small();
            let kind = match &numbers {
                ArrayValues::Real(_) => "double",
                ArrayValues::Whole(_) if is_small => "int",
                // The size of a `long` in a binary file depends on the platform.
                ArrayValues::Whole(_) if out.is_binary() => "vtktypeint64",
                ArrayValues::Whole(_) => "long",
            };
            out.text(&format!("{} {components} {count} {kind}\n", encoded(&name)));
            let components = components.max(1);
            match numbers {
                ArrayValues::Real(numbers) => numbers.chunks(components).for_each(|row| {
                    row.iter().for_each(|&number| out.real(number));
                    out.end_row();
                }),
                ArrayValues::Whole(numbers) => numbers.chunks(components).for_each(|row| {
                    for &number in row {
                        if is_small { out.int(number) } else { out.long(number) }
                    }
                    out.end_row();
                }),
            }
            out.end_list();
        }
    }
    out
}

/// Encodes a name as a single word: bytes outside of `!` to `~`, quotes, percent signs and number signs, at which some readers begin
/// a comment, become `%` and two hexadecimal digits, as in VTK.
fn encoded(name: &str) -> String {
    let mut encoded = String::new();
    for byte in name.bytes() {
        match byte {
            b'!'..=b'~' if !matches!(byte, b'"' | b'%' | b'#') => encoded.push(char::from(byte)),
            _ => put!(encoded, "%{byte:02X}"),
        }
    }
    encoded
}
