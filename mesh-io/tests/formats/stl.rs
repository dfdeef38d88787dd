//! STL, which repeats the coordinates of a vertex in each of its triangles.

use super::Folder;
use super::damage::{damaged, random, rounds};
use super::facts::{between_regions, freed, remarks};
use super::made::base;
use super::spoiled::mesh_or_error;
use mesh_io::Precision;
use mesh_io::{Conversion, Format, Location, MeshFile, ReadOptions};
use std::fs;
use support::Mesh;
use support::{Binary, check};

/// Returns the mesh with vertices numbered in the order of their first use by triangles.
fn in_order() -> Mesh {
    let mesh = base();
    let mut numbers = vec![u32::MAX; mesh.points.len()];
    let mut points = Vec::new();
    let mut number = |v: u32| {
        if numbers[v as usize] == u32::MAX {
            numbers[v as usize] = points.len() as u32;
            points.push(mesh.points[v as usize]);
        }
        numbers[v as usize]
    };
    let triangles = mesh.triangles.iter().map(|t| t.map(&mut number)).collect();
    Mesh { points, triangles, ..Mesh::default() }
}

/// Returns the mesh as text: two solids, the second from triangle 30 on, with words and numbers in several spellings.
fn ascii(mesh: &Mesh, points: &[[f64; 2]], z: &str) -> String {
    let mut text = "solid  left half\r\n".to_owned();
    for (t, corners) in mesh.triangles.iter().enumerate() {
        if t == 30 {
            text += "endsolid left half\nSOLID right # half\n";
        }
        text += &format!("  facet normal 0 0 {}\n    outer loop\n", t % 2);
        for (c, &v) in corners.iter().enumerate() {
            let [x, y] = points[v as usize];
            text += &match (t + c) % 2 {
                0 => format!("      vertex {x} {y:e} {z}\n"),
                _ => format!("\tVertex\t{x:E}  {y:?} {z}\r\n"),
            };
        }
        text += "    endloop\n  endfacet\n\n";
    }
    text + "endsolid"
}

/// Returns the mesh in binary, after a header that looks like text.
fn binary(mesh: &Mesh, points: &[[f64; 2]], z: f64) -> Vec<u8> {
    let mut out = Binary::empty(false);
    out.bytes = b"solid of another program".to_vec();
    out.bytes.resize(80, b' ');
    out.ints(&[mesh.triangles.len() as i32]);
    for (t, corners) in mesh.triangles.iter().enumerate() {
        out.reals(Precision::Single, &[0.0, 0.0, 1.0]);
        for &v in corners {
            let [x, y] = points[v as usize];
            out.reals(Precision::Single, &[x, y, z]);
        }
        out.bytes.extend_from_slice(&[t as u8, 7]);
    }
    out.bytes
}

fn read(name: &str, bytes: &[u8]) -> (Folder, MeshFile) {
    let folder = Folder::new(&[]);
    folder.put(name, bytes);
    let file = ReadOptions::new().weld(true).read(&folder.path(name)).unwrap();
    (folder, file)
}

fn samples() -> [(Format, Vec<u8>); 2] {
    let mesh = in_order();
    [
        (Format::Stl, ascii(&mesh, &mesh.points, "-2.5").into_bytes()),
        (Format::StlBinary, binary(&mesh, &mesh.points, 7.0)),
    ]
}

#[test]
fn corners_are_joined_where_that_is_asked_for() {
    let mesh = in_order();
    for (format, bytes) in samples() {
        let (folder, file) = read("in.stl", &bytes);
        let rounded = |x: f64| file.precision().rounded(x);
        assert_eq!(file.format(), format);
        assert_eq!(file.triangles(), mesh.triangles);
        let points: Vec<_> = mesh.points.iter().map(|p| p.map(rounded)).collect();
        assert_eq!(file.points(), points);
        assert_eq!(remarks(&file), ["120 corners are joined to 30 vertices"]);
        let error = MeshFile::read(&folder.path("in.stl")).unwrap_err().to_string();
        assert!(error.contains("no vertices") && error.contains("ReadOptions::weld"), "{error}");
        // Two solids are two regions.
        assert_eq!(file.regions().is_some(), format == Format::Stl);
        assert_eq!(between_regions(&file).is_empty(), format == Format::StlBinary);
        let groups = file.groups().unwrap();
        let named: Vec<_> = groups.iter().map(ToString::to_string).collect();
        if format == Format::Stl {
            assert_eq!(named, ["solid surface left half", "solid surface right # half"]);
            assert_eq!(groups.find("left half").unwrap().triangles().len(), 30);
        } else {
            assert!(named.is_empty());
        }
        assert!(check::mover_count(&freed(&file)) >= 12);
    }
}

/// A text may start with a byte-order mark, and its first word may be in capitals or precede a tab.
#[test]
fn a_text_may_start_in_several_spellings() {
    let text = ascii(&in_order(), &in_order().points, "0");
    for start in ["\u{feff}solid ", "solid\t", "SOLID ", "Solid\t", "\u{feff}SOLID ", " solid "] {
        let text = text.replacen("solid ", start, 1);
        let (folder, file) = read("a.stl", text.as_bytes());
        assert_eq!(file.format(), Format::Stl, "{start:?}");
        assert_eq!(file.triangles(), in_order().triangles, "{start:?}");
        file.write(&folder.path("b.stl"), file.points()).unwrap();
        assert_eq!(folder.text("b.stl"), text);
    }
    let mark = [&b"\xEF\xBB\xBF"[..], &binary(&in_order(), &in_order().points, 0.0)].concat();
    let folder = Folder::new(&[]);
    folder.put("a.stl", mark);
    assert!(ReadOptions::new().weld(true).read(&folder.path("a.stl")).is_err());
}

#[test]
fn every_copy_of_a_moved_corner_is_written() {
    let mesh = in_order();
    for (format, bytes) in samples() {
        let (folder, file) = read("in.stl", &bytes);
        file.write(&folder.path("out.stl"), file.points()).unwrap();
        assert!(fs::read(folder.path("out.stl")).unwrap() == bytes);
        let mut moved = file.points().to_vec();
        for (v, [x, y]) in moved.iter_mut().enumerate().filter(|(v, _)| v % 3 > 0) {
            (*x, *y) = (*x + 1.0 / (v + 2) as f64, -*y / 3.0 + 0.01 * v as f64);
        }
        file.write(&folder.path("out.stl"), &moved).unwrap();
        let written = fs::read(folder.path("out.stl")).unwrap();
        let again = ReadOptions::new().weld(true).read(&folder.path("out.stl")).unwrap();
        let rounded = |p: &[f64; 2]| p.map(|x| file.precision().rounded(x));
        assert_eq!(again.points(), moved.iter().map(rounded).collect::<Vec<_>>());
        assert_eq!(again.triangles(), mesh.triangles);
        assert_eq!(file.difference(&again), None);
        if format == Format::StlBinary {
            assert!(written == binary(&mesh, &moved, 7.0));
        } else {
            // Texts are compared with all numbers in one spelling.
            let plain = |bytes: &[u8]| -> Vec<String> {
                let text = String::from_utf8(bytes.to_vec()).unwrap();
                let word =
                    |word: &str| word.parse().map_or(word.to_owned(), |x: f64| x.to_string());
                text.split([' ', '\t', '\n', '\r']).map(word).collect()
            };
            assert_eq!(plain(&written), plain(ascii(&mesh, &moved, "-2.5").as_bytes()));
        }
        // A changed copy of a corner becomes a vertex of its own, so the triangles differ.
        let mut torn = written.clone();
        let at = match format {
            Format::StlBinary => 84 + 50 * 20 + 14,
            _ => torn.windows(6).rposition(|w| w == b"vertex").unwrap() + 7,
        };
        torn[at] ^= 1;
        folder.put("out.stl", torn);
        let torn = ReadOptions::new().weld(true).read(&folder.path("out.stl")).unwrap();
        assert!(file.difference(&torn).is_some());
    }
}

/// A mesh in the plane of x and z: corners at one x and y need not be one vertex.
#[test]
fn third_coordinates_of_every_copy_are_written() {
    let mesh = in_order();
    let upright: Vec<_> = mesh.points.iter().map(|&[x, y]| [x, 5.5, y]).collect();
    let text = |points: &[[f64; 3]]| {
        let mut text = "solid upright\n".to_owned();
        for corners in &mesh.triangles {
            text += " facet normal 0 -1 0\n  outer loop\n";
            for &v in corners {
                let [x, y, z] = points[v as usize];
                text += &format!("   vertex {x:?} {y:?} {z:?}\n");
            }
            text += "  endloop\n endfacet\n";
        }
        (text + "endsolid upright\n").into_bytes()
    };
    let binary = |points: &[[f64; 3]]| {
        let mut bytes = binary(&mesh, &mesh.points, 0.0);
        for (t, corners) in mesh.triangles.iter().enumerate() {
            for (c, &v) in corners.iter().enumerate() {
                let own = points[v as usize].map(|x| (x as f32).to_le_bytes());
                bytes[84 + 50 * t + 12 + 12 * c..][..12].copy_from_slice(own.as_flattened());
            }
        }
        bytes
    };
    type Make<'m> = dyn Fn(&[[f64; 3]]) -> Vec<u8> + 'm;
    let made: [&Make<'_>; 2] = [&text, &binary];
    for make in made {
        let (folder, file) = read("in.stl", &make(&upright));
        assert!(file.has_third_coordinates());
        assert_eq!(file.triangles(), mesh.triangles);
        let mut fields = file.point_fields(Some(&["z".into()])).unwrap();
        let rounded = |x: f64| file.precision().rounded(x);
        let z: Vec<f64> = mesh.points.iter().map(|&[_, y]| rounded(y)).collect();
        assert_eq!((fields.len(), fields[0].values()), (1, &z[..]));
        let converted = Conversion::new(&file, Format::Obj).unwrap().unwrap();
        let converted = MeshFile::from_bytes("a.obj".as_ref(), converted.bytes().unwrap()).unwrap();
        assert_eq!(converted.point_fields(None).unwrap()[0].values(), z);
        let mut moved = upright.clone();
        for (v, [x, _, z]) in moved.iter_mut().enumerate().filter(|(v, _)| v % 3 > 0) {
            (*x, *z) = (*x + 1.0 / (v + 2) as f64, -*z / 3.0 + 0.01 * v as f64);
        }
        fields[0].set(moved.iter().map(|point| point[2]).collect()).unwrap();
        let points: Vec<_> = moved.iter().map(|&[x, y, _]| [x, y]).collect();
        file.write_with_fields(&folder.path("out.stl"), &points, &fields).unwrap();
        assert!(fs::read(folder.path("out.stl")).unwrap() == make(&moved));
    }
}

#[test]
fn places_are_those_of_the_first_copy() {
    let mesh = in_order();
    let (_folder, file) = read("in.stl", ascii(&mesh, &mesh.points, "0").as_bytes());
    // After the line of the solid, a triangle takes seven lines and a blank line.
    assert_eq!(file.triangle_location(2).location, Location::Line(18));
    let first = mesh.triangles.iter().position(|t| t.contains(&9)).unwrap();
    let corner = mesh.triangles[first].iter().position(|&v| v == 9).unwrap();
    let place = file.vertex_location(9);
    assert_eq!((place.location, place.id), (Location::Line(2 + 8 * first + 2 + corner), 10));
    let (_folder, file) = read("in.stl", &binary(&mesh, &mesh.points, 0.0));
    assert_eq!(file.triangle_location(2).location, Location::Byte(84 + 100));
    let at = 84 + 50 * first + 12 + 12 * corner;
    assert_eq!(file.vertex_location(9).location, Location::Byte(at));
}

#[test]
fn an_stl_that_is_no_plane_mesh_is_refused() {
    let mesh = in_order();
    let text = ascii(&mesh, &mesh.points, "1");
    let bytes = binary(&mesh, &mesh.points, 1.0);
    let refused = |bytes: &[u8], parts: &[&str]| {
        let folder = Folder::new(&[]);
        folder.put("a.stl", bytes);
        let error = mesh_or_error(&folder, "a.stl").unwrap_err();
        assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
    };
    refused(&bytes[..bytes.len() - 1], &["a.stl, byte 80: the file ends before its 40 triangles"]);
    let four = text.replacen("endloop", "vertex 0 0 1", 1);
    refused(four.as_bytes(), &["a.stl:7: a vertex beyond the three"]);
    let two = text.replacen("      vertex", "#", 1);
    refused(two.as_bytes(), &["a.stl:7: the facet has 2 vertices, not three"]);
    refused(text.replace("endsolid left half\n", "").as_bytes(), &["do not alternate"]);
    refused(text.replace("outer", "inner").as_bytes(), &["a.stl:3: a row starts with `inner`"]);
    let twice = "solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex -0 0 0\nendfacet\nendsolid\n";
    refused(twice.as_bytes(), &["a.stl:2: triangle 1 lists node 1 twice"]);
    let mut infinite = bytes.clone();
    infinite[84 + 50 + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    refused(&infinite, &["byte 146: a corner of triangle 2 is not finite"]);
    for count in [41, 0x7FFF_FFFF, u32::MAX] {
        let mut huge = bytes.clone();
        huge[80..84].copy_from_slice(&count.to_le_bytes());
        refused(&huge, &["byte 80: the file ends before its"]);
    }
}

#[test]
fn files_cut_off_or_damaged_never_panic() {
    let folder = Folder::new(&[]);
    let mut random = random(29);
    for (format, bytes) in samples() {
        for cut in 0..bytes.len() {
            folder.put("a.stl", &bytes[..cut]);
            let last = bytes[..cut].split(|&byte| byte == b'\n').rfind(|line| !line.is_empty());
            let is_whole = last.is_some_and(|line| line.starts_with(b"endsolid"));
            let read = mesh_or_error(&folder, "a.stl");
            assert_eq!(read.is_ok(), is_whole, "the first {cut} bytes");
        }
        let mut read = 0;
        let rounds = rounds(2000);
        for _ in 0..rounds {
            folder.put("a.stl", damaged(&bytes, &mut random));
            read += usize::from(mesh_or_error(&folder, "a.stl").is_ok());
        }
        let few = rounds / 50;
        assert!((few..rounds - few).contains(&read), "{format}: {read} of {rounds} were read");
    }
}
