//! VTK's XML format in all its encodings.

use super::made::base;
use super::support::{Binary, SplitMix64, check};
use super::{Folder, damage};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use gpu_smooth::{Format, Location, Mesh, MeshFile, Precision};
use std::fs;
use std::io::Write;

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
    /// None, or the attribute of the compressor.
    pub(crate) compressor: Option<&'static str>,
    wide_header: bool,
    big: bool,
    pub(crate) precision: Precision,
    /// The type of whole numbers.
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

/// An array that is written: its attributes, its numbers as text, and as bytes.
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

    /// The array with its header, as its place has it.
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

    /// Vectors of two numbers each, in the other precision than points have.
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

/// A file of the mesh, with an edge and a quadrilateral among its triangles, and regions.
pub(crate) fn write(mesh: &Mesh, style: Style) -> Vec<u8> {
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
    let mut cells: Vec<(u32, Vec<u32>, u32)> =
        mesh.triangles.iter().enumerate().map(|(t, c)| (5, c.to_vec(), t as u32 / 30)).collect();
    cells.insert(0, (3, vec![7, 8], 9));
    cells.insert(5, (9, vec![15, 16, 22, 21], 9));
    let column = |of: fn(&(u32, Vec<u32>, u32)) -> u32| cells.iter().map(of).collect::<Vec<_>>();
    let connectivity: Vec<u32> = cells.iter().flat_map(|cell| cell.1.clone()).collect();
    let mut end = 0;
    let offsets: Vec<u32> = cells
        .iter()
        .map(|cell| {
            end += cell.1.len() as u32;
            end
        })
        .collect();
    let numbers: Vec<u32> = (0..mesh.points.len() as u32).collect();
    let sections = [
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
            vec![style.integers("offset", &offsets), style.integers("Region", &column(|c| c.2))],
        ),
        ("Points", vec![points]),
        (
            "Cells",
            vec![
                style.integers("connectivity", &connectivity),
                style.integers("offsets", &offsets),
                style.integers("types", &column(|c| c.0)),
            ],
        ),
    ];
    let mut out = Vec::new();
    let order = if style.big { "BigEndian" } else { "LittleEndian" };
    let header = if style.wide_header { "header_type=\"UInt64\"" } else { "" };
    let compressor =
        style.compressor.map(|name| format!("compressor=\"{name}\"")).unwrap_or_default();
    write!(
        out,
        "<?xml version=\"1.0\"?>\n<!-- <VTKFile> \"by hand\" -->\n<VTKFile type=\"UnstructuredGrid\" \
         byte_order=\"{order}\" {header} {compressor}>\n <UnstructuredGrid>\n  <Piece \
         NumberOfPoints=\"0\" NumberOfCells=\"0\"/>\n  <Piece NumberOfPoints=\"{}\"\n NumberOfCells='{}'>\n",
        mesh.points.len(),
        cells.len()
    )
    .unwrap();
    let mut appended = Vec::new();
    for (section, arrays) in sections {
        writeln!(out, "<{section}>").unwrap();
        for Array { attributes, text, bytes } in arrays {
            match style.place {
                Place::Text => {
                    writeln!(out, "<DataArray {attributes} format=\"ascii\">\n{text}</DataArray>")
                        .unwrap();
                }
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
    out.extend_from_slice(b"  </Piece>\n </UnstructuredGrid>\n");
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

pub(crate) fn folder(bytes: &[u8]) -> Folder {
    let folder = Folder::new(&[]);
    fs::write(folder.path("in.vtu"), bytes).unwrap();
    folder
}

fn rounded(points: &[[f64; 2]], precision: Precision) -> Vec<[f64; 2]> {
    points.iter().map(|point| point.map(|x| precision.rounded(x))).collect()
}

#[test]
fn every_encoding_is_read_and_comes_back() {
    let mesh = base();
    for style in styles() {
        let bytes = write(&mesh, style);
        let folder = folder(&bytes);
        let file = folder.read("in.vtu");
        assert_eq!((file.format(), file.precision()), (Format::Vtu, style.precision), "{style:?}");
        assert_eq!(file.mesh().points, rounded(&mesh.points, style.precision), "{style:?}");
        assert_eq!(file.mesh().triangles, mesh.triangles, "{style:?}");
        let held = file.mesh().fixed.iter().copied();
        let held: Vec<u32> = held.filter(|v| !file.interface_vertices().contains(v)).collect();
        assert_eq!(held, [7, 8, 15, 16, 22, 21], "{style:?}");
        let regions: Vec<u32> = (0..mesh.triangles.len() as u32).map(|t| t / 30).collect();
        assert_eq!(file.regions(), Some(regions.as_slice()), "{style:?}");
        file.write(&folder.path("out.vtu"), &mesh.points).unwrap();
        assert!(fs::read(folder.path("out.vtu")).unwrap() == bytes, "{style:?}");
        assert_eq!(file.difference(&folder.read("out.vtu")), None, "{style:?}");
    }
}

#[test]
fn only_coordinates_change_in_every_encoding() {
    let mesh = base();
    let mut rng = SplitMix64::new(7);
    for style in styles() {
        let bytes = write(&mesh, style);
        let folder = folder(&bytes);
        let file = folder.read("in.vtu");
        let mut to = file.mesh().points.clone();
        let held = check::held(file.mesh());
        for (point, _) in to.iter_mut().zip(held).filter(|(_, held)| !held) {
            *point = point.map(|x| x + rng.range(-0.3, 0.3));
        }
        file.write(&folder.path("out.vtu"), &to).unwrap();
        let after = folder.read("out.vtu");
        assert_eq!(after.mesh().points, rounded(&to, style.precision), "{style:?}");
        assert_eq!((&after.mesh().triangles, after.regions()), (&mesh.triangles, file.regions()));
        assert_eq!(file.difference(&after), None, "{style:?}");
        // The whole file is what a writer makes of the moved mesh, where encoders are the same and numbers have no
        // form of their own.
        if style.place != Place::Text && style.compressor.is_none() {
            let moved = Mesh { points: to, ..mesh.clone() };
            assert!(fs::read(folder.path("out.vtu")).unwrap() == write(&moved, style), "{style:?}");
        }
        let place = after.vertex_place(14);
        let written = fs::read(folder.path("out.vtu")).unwrap();
        let line_of = |tag: &str| {
            let at = written.windows(tag.len()).position(|bytes| bytes == tag.as_bytes()).unwrap();
            1 + written[..at].iter().filter(|&&byte| byte == b'\n').count()
        };
        let lines = line_of("<Points>")..=line_of("</Points>");
        let inside = matches!(place.location, Location::Line(line) if lines.contains(&line));
        assert!(place.label == 14 && inside, "{style:?}: {place:?}, not in {lines:?}");
    }
}

#[test]
fn cut_off_and_damaged_files_never_panic() {
    let mesh = base();
    let mut random = damage::random(23);
    for (n, style) in styles().into_iter().enumerate() {
        let bytes = write(&mesh, style);
        let folder = folder(&bytes);
        let read = |content: &[u8]| {
            fs::write(folder.path("in.vtu"), content).unwrap();
            match MeshFile::read(&folder.path("in.vtu")) {
                Ok(file) => {
                    let points = &file.mesh().points;
                    file.write(&folder.path("out.vtu"), points).unwrap();
                    assert!(fs::read(folder.path("out.vtu")).unwrap() == content, "{style:?}");
                    true
                }
                Err(error) => {
                    assert!(error.to_string().contains("in.vtu"), "{error}");
                    false
                }
            }
        };
        for cut in (0..bytes.len()).skip(n % 7).step_by(7) {
            assert!(!read(&bytes[..cut]) || cut > bytes.len() / 2, "{style:?}: {cut}");
        }
        for _ in 0..100 {
            read(&damage::damaged(&bytes, &mut random));
        }
    }
}

#[test]
fn what_is_not_read_is_refused_by_its_name() {
    let mesh = base();
    let style = styles()[0];
    let text = String::from_utf8(write(&mesh, style)).unwrap();
    for (from, to, part) in [
        ("UnstructuredGrid", "PolyData", "of the type PolyData"),
        ("NumberOfPoints=\"0\"", "NumberOfPoints=\"3\"", "in several pieces"),
        ("byte_order", "compressor=\"vtkLZMADataCompressor\" byte_order", "vtkLZMADataCompressor"),
        ("type=\"Float64\"", "type=\"Int32\"", "points of the type Int32"),
        ("<Cells>", "<Other>", "no array of connectivity"),
        ("NumberOfCells='", "NumberOfCells='1", "types for 1"),
    ] {
        let folder = folder(text.replacen(from, to, 1).as_bytes());
        let error = MeshFile::read(&folder.path("in.vtu")).unwrap_err().to_string();
        assert!(error.contains("in.vtu") && error.contains(part), "{error}");
    }
}
