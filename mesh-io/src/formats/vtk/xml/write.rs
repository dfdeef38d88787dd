//! Writer of `.vtu`, with arrays in base64, in binary or compressed.

use super::blocks::{BlockEncoding, Compressor};
use crate::binary::byte_order::ByteOrder;
use crate::export::put;
use crate::export::writer_input::WriterInput;
use crate::formats::vtk::types::number_of;
use crate::formats::vtk::write::{Array, ArrayValues, of_cells, of_points};
use std::fmt::Write;

/// Form of the arrays of a file.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// In the XML, in base64.
    Inline,
    /// Behind the XML, as plain bytes.
    Appended,
    /// Behind the XML, compressed by zlib.
    Compressed,
}

pub(crate) fn write_vtu(input: &WriterInput<'_>) -> String {
    String::from_utf8_lossy(&write(input, Form::Inline)).into_owned()
}

pub(crate) fn write_vtu_binary(input: &WriterInput<'_>) -> Vec<u8> {
    write(input, Form::Appended)
}

pub(crate) fn write_vtu_compressed(input: &WriterInput<'_>) -> Vec<u8> {
    write(input, Form::Compressed)
}

fn write(input: &WriterInput<'_>, form: Form) -> Vec<u8> {
    let content = input.content;
    let cells: Vec<usize> = input.cells().collect();
    let (compressor, name) = match form {
        Form::Compressed => (Some(Compressor::Zlib), " compressor=\"vtkZLibDataCompressor\""),
        Form::Inline | Form::Appended => (None, ""),
    };
    let encoding = BlockEncoding {
        order: ByteOrder::Little,
        header: 8,
        compressor,
        base64: form == Form::Inline,
    };
    let mut out = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\"{name}>\n<UnstructuredGrid>\n"
    );
    let mut appended = Vec::new();
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
            let (kind, bytes) = numbers.little();
            let wrapped = encoding.wrap_new(&bytes);
            let name = quick_xml::escape::escape(&name);
            put!(
                out,
                "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" "
            );
            if form == Form::Inline {
                let text = String::from_utf8_lossy(&wrapped);
                put!(out, "format=\"binary\">\n{text}\n</DataArray>\n");
            } else {
                put!(out, "format=\"appended\" offset=\"{}\"/>\n", appended.len());
                appended.extend(wrapped);
            }
        }
        put!(out, "</{section}>\n");
    }
    out.push_str("</Piece>\n</UnstructuredGrid>\n");
    let mut file = out.into_bytes();
    if form != Form::Inline {
        // The underscore precedes the bytes.
        file.extend(b"<AppendedData encoding=\"raw\">\n_");
        file.extend(appended);
        file.extend(b"\n</AppendedData>\n");
    }
    file.extend(b"</VTKFile>\n");
    file
}
