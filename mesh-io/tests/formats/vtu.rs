//! VTK's XML format of unstructured grids and polygons in all its encodings.

use super::facts::{between_regions, fixed, freed, mesh_of, remarks};
use super::made::base;
pub(crate) use super::made::vtu::{Place, styles, write, write_pieces};
use super::{Folder, damage};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mesh_io::Precision;
use mesh_io::{Conversion, Encoding, Format, Location, MeshFile, PointField, ReadOptions};
use std::fs;
use support::Mesh;
use support::{SplitMix64, check};
pub(crate) fn folder(bytes: &[u8]) -> Folder {
    let folder = Folder::new(&[]);
    folder.put("in.vtu", bytes);
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
        assert_eq!(file.points(), rounded(&mesh.points, style.precision), "{style:?}");
        assert_eq!(file.triangles(), mesh.triangles, "{style:?}");
        let held = fixed(&file).into_iter();
        let held: Vec<u32> = held.filter(|v| !between_regions(&file).contains(v)).collect();
        assert_eq!(held, [7, 8, 15, 16, 22, 21], "{style:?}");
        let regions: Vec<u32> = (0..mesh.triangles.len() as u32).map(|t| t / 30).collect();
        assert_eq!(file.regions(), Some(regions.as_slice()), "{style:?}");
        file.write(&folder.path("out.vtu"), &mesh.points).unwrap();
        assert!(fs::read(folder.path("out.vtu")).unwrap() == bytes, "{style:?}");
        assert_eq!(file.difference(&folder.read("out.vtu")), None, "{style:?}");
    }
}

/// If a third coordinate differs, the error names vertex and location, in every encoding of the points.
#[test]
fn the_vertex_is_told_whose_third_coordinate_differs() {
    let points = |z: f64| {
        let numbers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, z, 0.0, 1.0, 0.0];
        let bytes: Vec<u8> = numbers.iter().flat_map(|x: &f64| x.to_le_bytes()).collect();
        STANDARD.encode([&(bytes.len() as u32).to_le_bytes()[..], &bytes].concat())
    };
    let text = |z: f64| {
        format!(
            "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
             <Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">\n<Points>\n\
             <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"binary\">{}</DataArray></Points>\n<Cells>\
             <DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 0 2 3</DataArray>\n\
             <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6</DataArray>\n\
             <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 5</DataArray></Cells>\n</Piece>\n\
             </UnstructuredGrid>\n</VTKFile>\n",
            points(z)
        )
    };
    let folder = Folder::new(&[("a.vtu", &text(0.0)), ("b.vtu", &text(0.5))]);
    let difference = folder.read("a.vtu").difference(&folder.read("b.vtu")).unwrap();
    assert_eq!(difference.description, "third coordinates are not the same, first of vertex 2");
    assert_eq!(difference.location.location, Location::Line(5));
    assert_eq!(difference.other_location.location, Location::Line(5));
}

/// Some programs write `NumberOfComponents` with an empty value. VTK then reads one component.
#[test]
fn an_empty_number_of_components_is_one() {
    for style in styles() {
        let text = write(&base(), style);
        let named = &b"Name='offsets'"[..];
        let at = memchr::memmem::find(&text, named).unwrap();
        let empty = [&text[..at], b"NumberOfComponents=\"\" ", &text[at..]].concat();
        assert_eq!(folder(&empty).read("in.vtu").triangles(), base().triangles, "{style:?}");
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
        let mut to = file.points().to_vec();
        let held = check::held(&mesh_of(&file));
        for (point, _) in to.iter_mut().zip(held).filter(|(_, held)| !held) {
            *point = point.map(|x| x + rng.range(-0.3, 0.3));
        }
        file.write(&folder.path("out.vtu"), &to).unwrap();
        let after = folder.read("out.vtu");
        assert_eq!(after.points(), rounded(&to, style.precision), "{style:?}");
        assert_eq!((after.triangles(), after.regions()), (&mesh.triangles[..], file.regions()));
        assert_eq!(file.difference(&after), None, "{style:?}");
        // Without compression and text, the file equals the one that the test's writer makes of the moved mesh.
        if style.place != Place::Text && style.compressor.is_none() {
            let moved = Mesh { points: to, ..mesh.clone() };
            assert!(fs::read(folder.path("out.vtu")).unwrap() == write(&moved, style), "{style:?}");
        }
        let place = after.vertex_location(14);
        let written = fs::read(folder.path("out.vtu")).unwrap();
        let line_of = |tag: &str| {
            let at = written.windows(tag.len()).position(|bytes| bytes == tag.as_bytes()).unwrap();
            1 + written[..at].iter().filter(|&&byte| byte == b'\n').count()
        };
        let lines = line_of("<Points>")..=line_of("</Points>");
        let inside = matches!(place.location, Location::Line(line) if lines.contains(&line));
        assert!(place.id == 14 && inside, "{style:?}: {place:?}, not in {lines:?}");
    }
}

/// Offsets once ignored a byte order mark, so numbers were read three bytes too early.
#[test]
fn a_byte_order_mark_moves_all_places() {
    for style in styles().into_iter().step_by(11) {
        let bytes = [b"\xEF\xBB\xBF", &write(&base(), style)[..]].concat();
        let folder = folder(&bytes);
        let file = folder.read("in.vtu");
        assert_eq!(file.triangles(), base().triangles, "{style:?}");
        file.write(&folder.path("out.vtu"), file.points()).unwrap();
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
            folder.put("in.vtu", content);
            match MeshFile::read(&folder.path("in.vtu")) {
                Ok(file) => {
                    let points = file.points();
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
        for cut in (0..bytes.len()).skip(n % 13).step_by(13) {
            assert!(!read(&bytes[..cut]) || cut > bytes.len() / 2, "{style:?}: {cut}");
        }
        // The number of rounds is divided among about a hundred styles.
        for _ in 0..damage::rounds(5_000) / 100 {
            read(&damage::damaged(&bytes, &mut random));
        }
    }
}

#[test]
fn features_of_vtu_that_are_not_read_are_refused_by_name() {
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

/// Returns the mesh twice, with the second copy farther right.
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
        ..Mesh::default()
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
        folder.put(names[0], &bytes);
        let file = folder.read(names[0]);
        let format = if polygons { Format::Vtp } else { Format::Vtu };
        assert_eq!((file.format(), file.precision()), (format, style.precision), "{style:?}");
        assert_eq!(file.points(), rounded(&mesh.points, style.precision), "{style:?}");
        assert_eq!(file.triangles(), mesh.triangles, "{style:?}");
        let regions: Vec<u32> =
            (0..mesh.triangles.len()).map(|t| (t % first.triangles.len()) as u32 / 30).collect();
        assert_eq!(file.regions(), Some(regions.as_slice()), "{style:?}");
        let groups = file.groups().unwrap();
        assert!(groups.iter().any(|group| group.quadrilaterals().len() == meshes.len()));
        file.write(&folder.path(names[1]), &mesh.points).unwrap();
        assert!(fs::read(folder.path(names[1])).unwrap() == bytes, "{style:?}");

        let mut to = file.points().to_vec();
        let held = check::held(&mesh_of(&file));
        for (point, _) in to.iter_mut().zip(held).filter(|(_, held)| !held) {
            *point = point.map(|x| x + rng.range(-0.3, 0.3));
        }
        let mut fields = file.point_fields(None).unwrap();
        assert_eq!(fields.len(), 1 + 2 * meshes.len());
        for field in &mut fields {
            let values = field.values().iter().map(|value| value + 0.5).collect();
            field.set(values).unwrap();
        }
        file.write_with_fields(&folder.path(names[1]), &to, &fields).unwrap();
        let after = folder.read(names[1]);
        assert_eq!(after.points(), rounded(&to, style.precision), "{style:?}");
        assert_eq!(after.triangles(), mesh.triangles);
        let found = after.point_fields(None).unwrap();
        let bits = |field: &PointField| -> Vec<u64> {
            field.values().iter().map(|x| x.to_bits()).collect()
        };
        assert!(found.iter().map(bits).eq(fields.iter().map(bits)), "{style:?}");
        assert_eq!(file.difference_ignoring(&after, [&fields, &found]), None, "{style:?}");

        // The conversion joins all pieces to one piece, without loss.
        let conversion = Conversion::new(&file, Format::Vtu).unwrap().unwrap();
        assert_eq!(conversion.losses(), [""; 0]);
        conversion.write(&folder.path("one.vtu")).unwrap();
        let one = folder.read("one.vtu");
        assert_eq!(one.triangles(), mesh.triangles);
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

/// Neither deeply nested elements nor entities make a small file take much memory or time.
#[test]
fn hostile_xml_takes_no_memory_and_no_time() {
    let opening = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid>\n";
    let refused = |text: String| {
        let error = MeshFile::from_bytes(std::path::Path::new("a.vtu"), text.into_bytes());
        error.unwrap_err().to_string()
    };
    let deep = refused(format!("{opening}{}", "<a>".repeat(1_000_000)));
    assert!(deep.starts_with("a.vtu:3: elements are nested more than 100 deep"), "{deep}");
    let text = format!("<Xdmf>\n<Domain>\n{}", "<Grid>".repeat(1_000_000));
    let deep = MeshFile::from_bytes(std::path::Path::new("a.xdmf"), text.into_bytes());
    let deep = deep.unwrap_err().to_string();
    assert!(deep.starts_with("a.xdmf:3: elements are nested more than 100 deep"), "{deep}");
    let entities =
        "<!DOCTYPE v [<!ENTITY a \"9999999999\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;\">]>\n";
    let text = opening.replacen('\n', &format!("\n{entities}"), 1);
    let entity = refused(format!("{text}<Piece NumberOfPoints=\"&b;\" NumberOfCells=\"1\">"));
    assert!(entity.contains("a.vtu:4: NumberOfPoints is `&b;`"), "{entity}");
}

/// Returns the mesh with three points of its own for each triangle, in order, and the vertex of each point.
fn torn(mesh: &Mesh) -> (Mesh, Vec<u32>) {
    let vertices: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
    let points = vertices.iter().map(|&v| mesh.points[v as usize]).collect();
    let triangles =
        (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    (Mesh { points, triangles, ..Mesh::default() }, vertices)
}

/// Returns a file with the points of a mesh in text, a continuous and a discontinuous array, and points of z `height`.
fn discontinuous(mesh: &Mesh, height: f64) -> String {
    let joined = |numbers: Vec<String>| numbers.join(" ");
    let (cells, count) = (mesh.triangles.len(), mesh.points.len());
    let array = |of: &str, numbers: String| {
        format!("<DataArray {of} format='ascii'>{numbers}</DataArray>\n")
    };
    let points = mesh.points.iter().map(|[x, y]| format!("{x:?} {y:?} {height}")).collect();
    let corners = mesh.triangles.iter().flatten().map(ToString::to_string).collect();
    [
        format!("<VTKFile type='UnstructuredGrid'>\n<UnstructuredGrid>\n<Piece NumberOfPoints='{count}' NumberOfCells='{cells}'>\n"),
        "<PointData>\n".into(),
        array("type='Float64' Name='sum'", joined(mesh.points.iter().map(|[x, y]| format!("{:?}", x + y)).collect())),
        array("type='Float64' Name='jump'", joined((0..count).map(|i| format!("{i}.5")).collect())),
        "</PointData>\n<Points>\n".into(),
        array("type='Float64' NumberOfComponents='3'", joined(points)),
        "</Points>\n<Cells>\n".into(),
        array("type='Int32' Name='connectivity'", joined(corners)),
        array("type='Int32' Name='offsets'", joined((1..=cells).map(|t| (3 * t).to_string()).collect())),
        array("type='UInt8' Name='types'", joined(vec!["5".to_owned(); cells])),
        "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n".into(),
    ]
    .concat()
}

/// The vertices of the mesh in the order in which triangles name them first.
fn first_uses(vertices: &[u32]) -> Vec<u32> {
    let mut seen = Vec::new();
    vertices.iter().for_each(|v| {
        if !seen.contains(v) {
            seen.push(*v);
        }
    });
    seen
}

#[test]
fn points_of_discontinuous_triangles_are_joined_and_each_copy_is_written() {
    let mesh = base();
    let (torn, vertices) = torn(&mesh);
    let order = first_uses(&vertices);
    let index = |v: u32| order.iter().position(|&own| own == v).unwrap() as u32;
    let welded = ReadOptions::new().weld(true);
    let text = discontinuous(&torn, 0.0);
    let folder = Folder::new(&[("in.vtu", &text)]);
    assert_eq!(folder.read("in.vtu").points().len(), vertices.len());
    let file = welded.clone().read(&folder.path("in.vtu")).unwrap();
    let points: Vec<[f64; 2]> = order.iter().map(|&v| mesh.points[v as usize]).collect();
    assert_eq!(file.points(), points);
    assert_eq!(file.triangles(), mesh.triangles.iter().map(|t| t.map(index)).collect::<Vec<_>>());
    let joined = format!("{} points are joined to {} vertices", vertices.len(), order.len());
    assert_eq!(remarks(&file), [joined]);
    assert!(check::mover_count(&freed(&file)) >= 12);
    file.write(&folder.path("same.vtu"), &points).unwrap();
    assert_eq!(folder.text("same.vtu"), text);
    // Every copy of a moved vertex moves, and with it a continuous field. A discontinuous field stays.
    let to = |[x, y]: [f64; 2]| [x + 0.25, y * 0.5];
    let moved: Vec<[f64; 2]> = points.iter().map(|&at| to(at)).collect();
    let mut fields = file.point_fields(None).unwrap();
    fields.retain(|field| field.name() != "z");
    let told: Vec<_> = fields.iter().map(|field| (field.name(), field.is_replaceable())).collect();
    assert_eq!(told, [("sum", true), ("jump", false)]);
    for field in &mut fields {
        field.set(moved.iter().map(|[x, y]| x + y).collect()).unwrap();
    }
    file.write_with_fields(&folder.path("out.vtu"), &moved, &fields).unwrap();
    let new = Mesh { points: torn.points.iter().map(|&at| to(at)).collect(), ..torn };
    assert_eq!(folder.text("out.vtu"), discontinuous(&new, 0.0));
    let again = welded.read(&folder.path("out.vtu")).unwrap();
    assert_eq!(again.points(), moved);
}

/// Arrays of points are in base64, in raw bytes, and compressed.
#[test]
fn points_are_joined_in_every_encoding() {
    let (torn, vertices) = torn(&base());
    let order = first_uses(&vertices);
    let folder = Folder::new(&[("in.vtu", &discontinuous(&torn, 0.5))]);
    let welded = ReadOptions::new().weld(true);
    for encoding in [Encoding::Text, Encoding::Binary, Encoding::Compressed] {
        let mut conversion = Conversion::new(&folder.read("in.vtu"), Format::Vtu).unwrap().unwrap();
        assert!(conversion.set_encoding(encoding));
        conversion.write(&folder.path("torn.vtu")).unwrap();
        let file = welded.clone().read(&folder.path("torn.vtu")).unwrap();
        assert_eq!(file.points().len(), order.len(), "{encoding:?}");
        let moved: Vec<[f64; 2]> = file.points().iter().map(|[x, y]| [x + 0.25, *y]).collect();
        file.write(&folder.path("out.vtu"), &moved).unwrap();
        let place = |v: &u32| moved[order.iter().position(|own| own == v).unwrap()];
        let expected: Vec<[f64; 2]> = vertices.iter().map(place).collect();
        assert_eq!(folder.read("out.vtu").points(), expected, "{encoding:?}");
    }
}

/// Points of the same x and y in two planes, and points of a mesh without copies.
#[test]
fn points_apart_are_not_joined() {
    let mesh = base();
    let text = discontinuous(&mesh, 0.0);
    let folder = Folder::new(&[("a.vtu", &text)]);
    let file = ReadOptions::new().weld(true).read(&folder.path("a.vtu")).unwrap();
    assert_eq!((file.points(), remarks(&file).len()), (&mesh.points[..], 0));
    let (torn, vertices) = torn(&mesh);
    let text = discontinuous(&torn, 0.0);
    // One of several copies of a vertex, in another plane.
    let is_copied = |v: &u32| vertices.iter().filter(|own| *own == v).count() > 1;
    let copied = vertices.iter().position(is_copied).unwrap();
    let [x, y] = torn.points[copied];
    let (before, after) = text.split_once("<Points>").unwrap();
    let lifted = after.replacen(&format!(" {x:?} {y:?} 0 "), &format!(" {x:?} {y:?} 1 "), 1);
    let lifted = format!("{before}<Points>{lifted}");
    assert_ne!(text, lifted);
    let [flat, lifted] = [text, lifted].map(|text| {
        folder.put("b.vtu", text.as_bytes());
        ReadOptions::new().weld(true).read(&folder.path("b.vtu")).unwrap().points().len()
    });
    assert_eq!((flat, lifted), (mesh.points.len(), mesh.points.len() + 1));
}
