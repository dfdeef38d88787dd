//! Makes VTK XML files in all encodings of arrays.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use mesh_io::Precision;
use std::io::Write;
use support::Binary;
use support::Mesh;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    Text,
    Base64,
    AppendedBase64,
    AppendedRaw,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Style {
    pub(crate) place: Place,
    /// Value of the attribute `compressor`; `None` without compression.
    pub(crate) compressor: Option<&'static str>,
    wide_header: bool,
    big: bool,
    pub(crate) precision: Precision,
    /// Whether integers have 64 bits instead of 32.
    wide_integers: bool,
}

pub(crate) fn styles() -> Vec<Style> {
    let mut styles = Vec::new();
    for place in [Place::Text, Place::Base64, Place::AppendedBase64, Place::AppendedRaw] {
        for compressor in [None, Some("vtkZLibDataCompressor"), Some("vtkLZ4DataCompressor")] {
            for bits in 0..8 {
                let [wide_header, big, single] = [1, 2, 4].map(|bit| bits & bit != 0);
                let precision = if single { Precision::Single } else { Precision::Double };
                let wide_integers = bits % 3 == 0;
                let style = Style { place, compressor, wide_header, big, precision, wide_integers };
                styles.push(style);
            }
        }
    }
    styles
}

/// An array to write: XML attributes, numbers as text, and numbers as bytes.
struct Array {
    attributes: String,
    text: String,
    bytes: Vec<u8>,
}

impl Style {
    fn length(self, count: usize) -> Vec<u8> {
        let mut bytes = Binary::empty(self.big);
        match self.wide_header {
            true => bytes.sizes(&[count as u64]),
            false => bytes.ints(&[count as i32]),
        }
        bytes.bytes
    }

    /// Returns the bytes with their header, encoded as `place` requires.
    fn encoded(self, bytes: &[u8]) -> Vec<u8> {
        const BLOCK: usize = 100;
        let text = |bytes: &[u8]| STANDARD.encode(bytes).into_bytes();
        let raw = self.place == Place::AppendedRaw;
        let Some(compressor) = self.compressor else {
            let all = [self.length(bytes.len()), bytes.to_vec()].concat();
            return if raw { all } else { text(&all) };
        };
        let blocks: Vec<Vec<u8>> = bytes
            .chunks(BLOCK)
            .map(|block| match compressor {
                "vtkLZ4DataCompressor" => lz4_flex::block::compress(block),
                _ => {
                    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
                    encoder.write_all(block).unwrap();
                    encoder.finish().unwrap()
                }
            })
            .collect();
        let counts = [blocks.len(), BLOCK, bytes.len() % BLOCK];
        let counts = counts.into_iter().chain(blocks.iter().map(Vec::len));
        let header: Vec<u8> = counts.flat_map(|count| self.length(count)).collect();
        let content = blocks.concat();
        if raw { [header, content].concat() } else { [text(&header), text(&content)].concat() }
    }

    /// Returns vectors of two numbers each, in another precision than the points.
    fn vectors(self, name: &str, count: usize) -> Array {
        let single = self.precision == Precision::Double;
        let precision = if single { Precision::Single } else { Precision::Double };
        let kind = if single { "Float32" } else { "Float64" };
        let mut bytes = Binary::empty(self.big);
        let numbers: Vec<f64> = (0..2 * count).map(|i| i as f64 * -0.25).collect();
        bytes.reals(precision, &numbers);
        let text: Vec<_> = numbers.iter().map(f64::to_string).collect();
        let attributes = format!("type=\"{kind}\" Name=\"flow\" NumberOfComponents=\"2\"");
        Array {
            attributes: attributes.replace("flow", name),
            text: text.join(" "),
            bytes: bytes.bytes,
        }
    }

    fn integers(self, name: &str, numbers: &[u32]) -> Array {
        let mut bytes = Binary::empty(self.big);
        let kind = if self.wide_integers { "Int64" } else { "UInt32" };
        for &number in numbers {
            match self.wide_integers {
                true => bytes.sizes(&[u64::from(number)]),
                false => bytes.ints(&[number as i32]),
            }
        }
        let text: Vec<_> = numbers.iter().map(u32::to_string).collect();
        let attributes = format!("type=\"{kind}\" Name='{name}'");
        Array { attributes, text: text.join(" "), bytes: bytes.bytes }
    }
}

/// Returns a file of the mesh, with an edge and a quadrilateral among its triangles, and with regions.
pub(crate) fn write(mesh: &Mesh, style: Style) -> Vec<u8> {
    write_pieces(&[mesh], style, false)
}

/// Returns a file of several pieces, as an unstructured grid or as polygonal data. Each piece has an edge before its
/// triangles, and a quadrilateral between two triangles.
pub(crate) fn write_pieces(meshes: &[&Mesh], style: Style, polygons: bool) -> Vec<u8> {
    let mut out = Vec::new();
    let order = if style.big { "BigEndian" } else { "LittleEndian" };
    let header = if style.wide_header { "header_type=\"UInt64\"" } else { "" };
    let compressor =
        style.compressor.map(|name| format!("compressor=\"{name}\"")).unwrap_or_default();
    let kind = if polygons { "PolyData" } else { "UnstructuredGrid" };
    write!(
        out,
        "<?xml version=\"1.0\"?>\n<!-- <VTKFile> \"by hand\" -->\n<VTKFile type=\"{kind}\" \
         byte_order=\"{order}\" {header} {compressor}>\n <{kind}>\n  <Piece \
         NumberOfPoints=\"0\" NumberOfCells=\"0\"/>\n"
    )
    .unwrap();
    let mut appended = Vec::new();
    for mesh in meshes {
        let cells = cells(mesh);
        let counts = match polygons {
            true => format!("NumberOfLines=\"1\" NumberOfPolys=\"{}\"", cells.len() - 1),
            false => format!("NumberOfCells='{}'", cells.len()),
        };
        let points = mesh.points.len();
        writeln!(out, "  <Piece NumberOfPoints=\"{points}\"\n {counts}>").unwrap();
        for (section, arrays) in sections(mesh, &cells, style, polygons) {
            writeln!(out, "<{section}>").unwrap();
            for Array { attributes, text, bytes } in arrays {
                match style.place {
                    Place::Text => writeln!(
                        out,
                        "<DataArray {attributes} format=\"ascii\">\n{text}</DataArray>"
                    )
                    .unwrap(),
                    Place::Base64 => {
                        let text = String::from_utf8(style.encoded(&bytes)).unwrap();
                        writeln!(
                            out,
                            "<DataArray {attributes} format=\"binary\">\n  {text}\n</DataArray>"
                        )
                        .unwrap();
                    }
                    _ => {
                        let offset = appended.len();
                        writeln!(
                            out,
                            "<DataArray {attributes} format=\"appended\" offset = \"{offset}\" />"
                        )
                        .unwrap();
                        appended.extend(style.encoded(&bytes));
                    }
                }
            }
            writeln!(out, "</{section}>").unwrap();
        }
        out.extend_from_slice(b"  </Piece>\n");
    }
    writeln!(out, " </{kind}>").unwrap();
    if matches!(style.place, Place::AppendedBase64 | Place::AppendedRaw) {
        let raw = style.place == Place::AppendedRaw;
        let encoding = if raw { "raw" } else { "base64" };
        write!(out, " <AppendedData encoding=\"{encoding}\">\n _").unwrap();
        out.extend(appended);
        out.extend_from_slice(b"\n </AppendedData>\n");
    }
    out.extend_from_slice(b"</VTKFile>\n");
    out
}

/// Type, points and region of a cell.
type Cell = (u32, Vec<u32>, u32);

fn cells(mesh: &Mesh) -> Vec<Cell> {
    let triangles = mesh.triangles.iter().enumerate();
    let mut cells: Vec<Cell> = triangles.map(|(t, c)| (5, c.to_vec(), t as u32 / 30)).collect();
    cells.insert(0, (3, vec![7, 8], 9));
    cells.insert(5, (9, vec![15, 16, 22, 21], 9));
    cells
}

/// Returns the arrays of a piece, grouped by the enclosing XML element.
fn sections(
    mesh: &Mesh,
    cells: &[Cell],
    style: Style,
    polygons: bool,
) -> Vec<(&'static str, Vec<Array>)> {
    let mut points = Binary::empty(style.big);
    let mut words = Vec::new();
    for (i, &[x, y]) in mesh.points.iter().enumerate() {
        points.reals(style.precision, &[x, y, i as f64 * 0.5]);
        words.push(format!("{x:?} {y:e}{}{}", if i % 3 == 0 { "\n" } else { " " }, i as f64 * 0.5));
    }
    let kind = if style.precision == Precision::Single { "Float32" } else { "Float64" };
    let points = Array {
        attributes: format!("NumberOfComponents=\"3\" type=\"{kind}\" Name=\"Points\""),
        text: words.join("  "),
        bytes: points.bytes,
    };
    let column = |of: fn(&Cell) -> u32| cells.iter().map(of).collect::<Vec<_>>();
    // Makes the connectivity and the offsets of some cells.
    let lists = |cells: &[Cell]| {
        let connectivity: Vec<u32> = cells.iter().flat_map(|cell| cell.1.clone()).collect();
        let mut end = 0;
        let ends = cells.iter().map(|cell| {
            end += cell.1.len() as u32;
            end
        });
        let offsets: Vec<u32> = ends.collect();
        [style.integers("connectivity", &connectivity), style.integers("offsets", &offsets)]
    };
    let numbers: Vec<u32> = (0..mesh.points.len() as u32).collect();
    let quality = style.vectors("quality", cells.len() / 2);
    let mut sections = vec![
        (
            "PointData",
            vec![
                style.vectors("flow", mesh.points.len()),
                style.integers("number", &numbers),
                style.vectors("wind", mesh.points.len()),
            ],
        ),
        (
            "CellData",
            vec![
                style.integers("offset", &column(|c| c.0)),
                style.integers("Region", &column(|c| c.2)),
                quality,
            ],
        ),
        ("Points", vec![points]),
    ];
    if polygons {
        sections.push(("Lines", lists(&cells[..1]).into()));
        sections.push(("Polys", lists(&cells[1..]).into()));
    } else {
        let types = style.integers("types", &column(|c| c.0));
        sections.push(("Cells", lists(cells).into_iter().chain([types]).collect()));
    }
    sections
}
