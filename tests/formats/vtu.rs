//! VTK's XML format in all its encodings.

use super::made::base;
use super::support::{Binary, SplitMix64, check};
use super::{Folder, damage};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use gpu_smooth::{Conversion, Format, Location, Mesh, MeshFile, PointField, Precision};
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
    write_pieces(&[mesh], style, false)
}

/// The same of several meshes, each with an edge before its triangles and a quadrilateral among them; as an unstructured grid or
/// as polygonal data.
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

/// A cell's type, its points and its region.
type Cell = (u32, Vec<u32>, u32);

fn cells(mesh: &Mesh) -> Vec<Cell> {
    let triangles = mesh.triangles.iter().enumerate();
    let mut cells: Vec<Cell> = triangles.map(|(t, c)| (5, c.to_vec(), t as u32 / 30)).collect();
    cells.insert(0, (3, vec![7, 8], 9));
    cells.insert(5, (9, vec![15, 16, 22, 21], 9));
    cells
}

/// The arrays of a piece by the element they stand in.
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
    // Connectivity and offsets of some cells.
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

/// Numbers in a file that a byte order mark stands before were read three bytes too early.
#[test]
fn a_byte_order_mark_moves_all_places() {
    for style in styles().into_iter().step_by(11) {
        let bytes = [b"\xEF\xBB\xBF", &write(&base(), style)[..]].concat();
        let folder = folder(&bytes);
        let file = folder.read("in.vtu");
        assert_eq!(file.mesh().triangles, base().triangles, "{style:?}");
        file.write(&folder.path("out.vtu"), &file.mesh().points).unwrap();
        assert!(fs::read(folder.path("out.vtu")).unwrap() == bytes, "{style:?}");
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
        // There are a hundred styles.
        for _ in 0..damage::rounds(10_000) / 100 {
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
        ("UnstructuredGrid", "ImageData", "of the type ImageData"),
        ("NumberOfPoints=\"0\"", "NumberOfPoints=\"3\"", "no array of Points"),
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

/// The mesh twice, the second time farther right.
fn pieces() -> [Mesh; 2] {
    let first = base();
    let mut second = first.clone();
    second.points.iter_mut().for_each(|point| point[0] += 10.0);
    [first, second]
}

fn both(pieces: &[Mesh; 2]) -> Mesh {
    let [first, second] = pieces;
    let count = first.points.len() as u32;
    let triangles = second.triangles.iter().map(|t| t.map(|v| v + count));
    Mesh {
        points: first.points.iter().chain(&second.points).copied().collect(),
        triangles: first.triangles.iter().copied().chain(triangles).collect(),
        fixed: Vec::new(),
    }
}

#[test]
fn pieces_and_polygons_are_read_and_come_back() {
    let pieces = pieces();
    let [first, second] = &pieces;
    let mut rng = SplitMix64::new(9);
    for (n, style) in styles().into_iter().enumerate().step_by(5) {
        let polygons = n % 2 == 0;
        let several = n % 3 > 0;
        let meshes = if several { vec![first, second] } else { vec![first] };
        let mesh = if several { both(&pieces) } else { first.clone() };
        let bytes = write_pieces(&meshes, style, polygons);
        let names = if polygons { ["in.vtp", "out.vtp"] } else { ["in.vtu", "out.vtu"] };
        let folder = Folder::new(&[]);
        fs::write(folder.path(names[0]), &bytes).unwrap();
        let file = folder.read(names[0]);
        let format = if polygons { Format::Vtp } else { Format::Vtu };
        assert_eq!((file.format(), file.precision()), (format, style.precision), "{style:?}");
        assert_eq!(file.mesh().points, rounded(&mesh.points, style.precision), "{style:?}");
        assert_eq!(file.mesh().triangles, mesh.triangles, "{style:?}");
        let regions: Vec<u32> =
            (0..mesh.triangles.len()).map(|t| (t % first.triangles.len()) as u32 / 30).collect();
        assert_eq!(file.regions(), Some(regions.as_slice()), "{style:?}");
        let groups = file.groups().unwrap();
        assert!(groups.iter().any(|group| group.quadrilaterals == meshes.len()));
        file.write(&folder.path(names[1]), &mesh.points).unwrap();
        assert!(fs::read(folder.path(names[1])).unwrap() == bytes, "{style:?}");

        let mut to = file.mesh().points.clone();
        let held = check::held(file.mesh());
        for (point, _) in to.iter_mut().zip(held).filter(|(_, held)| !held) {
            *point = point.map(|x| x + rng.range(-0.3, 0.3));
        }
        let mut fields = file.point_fields(None).unwrap();
        assert_eq!(fields.len(), 1 + 2 * meshes.len());
        for field in &mut fields {
            let values = field.values().iter().map(|value| value + 0.5).collect();
            field.set(values).unwrap();
        }
        file.write_with(&folder.path(names[1]), &to, &fields).unwrap();
        let after = folder.read(names[1]);
        assert_eq!(after.mesh().points, rounded(&to, style.precision), "{style:?}");
        assert_eq!(after.mesh().triangles, mesh.triangles);
        let found = after.point_fields(None).unwrap();
        let bits = |field: &PointField| -> Vec<u64> {
            field.values().iter().map(|x| x.to_bits()).collect()
        };
        assert!(found.iter().map(bits).eq(fields.iter().map(bits)), "{style:?}");
        assert_eq!(file.difference_besides(&after, [&fields, &found]), None, "{style:?}");

        // All of it comes over into one piece.
        let conversion = Conversion::new(&file, Format::Vtu).unwrap().unwrap();
        assert_eq!(conversion.lost(), [""; 0]);
        conversion.write(&folder.path("one.vtu")).unwrap();
        let one = folder.read("one.vtu");
        assert_eq!(one.mesh().triangles, mesh.triangles);
        let flow = one.point_fields(Some(&["flow".into()])).unwrap();
        assert!(flow.len() == 1 && flow[0].values().iter().all(|value| value.is_finite()));
    }
}

#[test]
fn damaged_pieces_never_panic() {
    let pieces = pieces();
    let [first, second] = &pieces;
    let mut random = damage::random(29);
    for (n, style) in styles().into_iter().enumerate().step_by(5) {
        let bytes = write_pieces(&[first, second], style, n % 2 == 0);
        for _ in 0..12 {
            let folder = folder(&damage::damaged(&bytes, &mut random));
            let Ok(file) = MeshFile::read(&folder.path("in.vtu")) else { continue };
            let _ = file.point_fields(None);
            if let Ok(Some(conversion)) = Conversion::new(&file, Format::Gmsh22) {
                conversion.text();
            }
        }
    }
}

/// Neither depth nor entities make a small file a large one.
#[test]
fn hostile_xml_takes_no_memory_and_no_time() {
    let opening = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid>\n";
    let refused = |text: String| {
        let error = MeshFile::from_bytes(std::path::Path::new("a.vtu"), text.into_bytes());
        error.unwrap_err().to_string()
    };
    let deep = refused(format!("{opening}{}", "<a>".repeat(1_000_000)));
    assert!(deep.starts_with("a.vtu:3: more than 100 elements stand in each other"), "{deep}");
    let entities =
        "<!DOCTYPE v [<!ENTITY a \"9999999999\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;\">]>\n";
    let text = opening.replacen('\n', &format!("\n{entities}"), 1);
    let entity = refused(format!("{text}<Piece NumberOfPoints=\"&b;\" NumberOfCells=\"1\">"));
    assert!(entity.contains("a.vtu:4: NumberOfPoints is `&b;`"), "{entity}");
}
