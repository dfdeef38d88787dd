//! gmsh's `.msh` in binary: the meshes of the text samples, in either byte order.

use super::facts::{mesh_of, remarks};
use super::long::{points, triangles};
use super::{Folder, GMSH22, GMSH41};
use mesh_io::{Format, Location, MeshFile};
use std::fs;
use support::Mesh;
use support::{Binary, write_msh22_binary, write_msh41_binary};

/// Adds a section with content that looks like lines, comments and ends of other sections.
fn misleading(file: &mut Binary, name: &str) {
    file.text(&format!("${name}\n"));
    file.bytes.extend_from_slice(b"\n\0\xFF# $Nodes\n#\n$Elements of\n \n$EndNodes\n\n3");
    file.text(&format!("\n$End{name}\n"));
}

/// Returns the mesh of [`GMSH22`] in binary. The first node has the tag 90000, as its tag in text does not fit an
/// `int`.
pub(crate) fn msh22(big: bool) -> Vec<u8> {
    let mut file = Binary::new("2.2", big);
    file.text("$PhysicalNames\n1\n2 1 \"$Nodes # a\"\n$EndPhysicalNames\n$Nodes\n6\n");
    for (tag, x, y) in
        [(90_000, 0., 0.), (4, 1., 0.), (3, 1., 1.), (70, 0., 1.), (5, 0.25, 0.5), (6, 2., 0.5)]
    {
        file.ints(&[tag]);
        file.doubles(&[x, y, 5.]);
    }
    file.text("\n$EndNodes\n$Elements\n7\n");
    file.ints(&[15, 1, 2, 1, 0, 1, 4]);
    file.ints(&[1, 1, 2, 2, 0, 1, 90_000, 4]);
    file.ints(&[2, 1, 2, 3, 0, 1, 90_000, 4, 5]);
    file.ints(&[2, 1, 3, 4, 0, 1, 8, 4, 3, 5]);
    file.ints(&[2, 2, 2, 5, 0, 1, 3, 70, 5, 6, 0, 1, 70, 90_000, 5]);
    file.ints(&[3, 1, 2, 7, 0, 1, 4, 6, 6, 3]);
    file.text("\n$EndElements\n");
    misleading(&mut file, "NodeData");
    file.bytes
}

/// Returns the mesh of [`GMSH41`] in binary.
pub(crate) fn msh41(big: bool) -> Vec<u8> {
    let mut file = Binary::new("4.1", big);
    misleading(&mut file, "Entities");
    file.text("$Nodes\n");
    file.sizes(&[2, 5, 1, 9]);
    file.ints(&[0, -1, 0]);
    file.sizes(&[1, 1]);
    file.doubles(&[0., 0., 0.]);
    file.ints(&[2, 1, 1]);
    file.sizes(&[4, 9, 8, 7, 6]);
    for [x, y] in [[1., 0.], [1., 1.], [0., 1.], [0.25, 0.5]] {
        file.doubles(&[x, y, 0., 0.5, 0.5]);
    }
    file.text("\n$EndNodes\n$Elements\n");
    file.sizes(&[2, 5, 1, 5]);
    file.ints(&[1, -1, 1]);
    file.sizes(&[1, 1, 1, 9]);
    file.ints(&[2, 1, 2]);
    file.sizes(&[4, 2, 1, 9, 6, 3, 9, 8, 6, 4, 8, 7, 6, 5, 7, 1, 6]);
    file.text("\n$EndElements\n");
    misleading(&mut file, "Periodic");
    file.bytes
}

fn read(bytes: &[u8]) -> (Folder, MeshFile) {
    let folder = Folder::new(&[]);
    fs::write(folder.path("a.msh"), bytes).unwrap();
    let file = folder.read("a.msh");
    (folder, file)
}

/// Returns the offset of `part` in `bytes`, where `part` must occur exactly once.
fn find(bytes: &[u8], part: &[u8]) -> usize {
    let at: Vec<_> = bytes.windows(part.len()).enumerate().filter(|(_, w)| *w == part).collect();
    assert_eq!(at.len(), 1, "{part:?}");
    at[0].0
}

#[test]
fn binary_files_hold_what_those_in_text_do() {
    let text22 = GMSH22.replace("900000000000", "90000");
    for (text, binary, format) in [
        (text22.as_str(), msh22 as fn(bool) -> Vec<u8>, Format::Gmsh22Binary),
        (GMSH41, msh41, Format::Gmsh41Binary),
    ] {
        let (_folder, of_text) = read(text.as_bytes());
        for big in [false, true] {
            let (_folder, file) = read(&binary(big));
            assert_eq!(file.format(), format);
            assert_eq!(mesh_of(&file), mesh_of(&of_text));
            assert_eq!(remarks(&file), remarks(&of_text));
        }
    }
}

#[test]
fn places_in_binary_files_are_bytes() {
    for big in [false, true] {
        let bytes = msh22(big);
        let (_folder, file) = read(&bytes);
        let nodes = find(&bytes, b"$Nodes\n6\n") + 9;
        let place = file.vertex_location(3);
        assert_eq!((place.location, place.id), (Location::Byte(nodes + 3 * 28), 70));
        assert!(place.to_string().ends_with(&format!("a.msh, byte {}", nodes + 3 * 28)), "{place}");
        let elements = find(&bytes, b"$Elements\n7\n") + 12;
        let place = file.triangle_location(2);
        assert_eq!((place.location, place.id), (Location::Byte(elements + 37 * 4), 5));

        let bytes = msh41(big);
        let (_folder, file) = read(&bytes);
        let nodes = find(&bytes, b"\n$EndNodes\n$Elements\n");
        let place = file.vertex_location(4);
        assert_eq!((place.location, place.id), (Location::Byte(nodes - 40), 6));
        let elements = find(&bytes, b"\n$EndElements");
        let place = file.triangle_location(3);
        assert_eq!((place.location, place.id), (Location::Byte(elements - 32), 5));
    }
}

#[test]
fn binary_files_come_back_but_for_what_moved() {
    for big in [false, true] {
        for (bytes, format) in
            [(msh22(big), Format::Gmsh22Binary), (msh41(big), Format::Gmsh41Binary)]
        {
            let (folder, file) = read(&bytes);
            let mut points = file.points().to_vec();
            file.write(&folder.path("same"), &points).unwrap();
            assert!(fs::read(folder.path("same")).unwrap() == bytes);

            points[1][1] = -0.0;
            points[4] = [1e-7, f64::MAX];
            file.write(&folder.path("a.msh"), &points).unwrap();
            let out = fs::read(folder.path("a.msh")).unwrap();
            let (y, x) = match format {
                Format::Gmsh22Binary => {
                    let nodes = find(&bytes, b"$Nodes\n6\n") + 9;
                    (nodes + 28 + 12, nodes + 4 * 28 + 4)
                }
                _ => {
                    let end = find(&bytes, b"\n$EndNodes\n$Elements\n");
                    (end - 4 * 40 + 8, end - 40)
                }
            };
            let mut expected = bytes.clone();
            let mut moved = Binary { bytes: Vec::new(), big };
            moved.doubles(&[-0.0, 1e-7, f64::MAX]);
            expected[y..y + 8].copy_from_slice(&moved.bytes[..8]);
            expected[x..x + 16].copy_from_slice(&moved.bytes[8..]);
            assert!(out == expected);
            let again = folder.read("a.msh").points().to_vec();
            assert_eq!(again, points);
            assert!(again[1][1].is_sign_negative());
        }
    }
}

/// Returns files of the mesh with rows in several arrangements.
fn arrangements(mesh: &Mesh) -> [Vec<u8>; 6] {
    let arranged = |big| {
        [
            write_msh22_binary(mesh, big, false),
            write_msh22_binary(mesh, big, true),
            write_msh41_binary(mesh, big),
        ]
    };
    let [a, b, c] = arranged(false);
    let [d, e, f] = arranged(true);
    [a, b, c, d, e, f]
}

#[test]
fn long_binary_files_come_back_but_for_what_moved() {
    let mesh = Mesh { points: points(), triangles: triangles(), ..Mesh::default() };
    let mut moved = mesh.clone();
    for (v, [x, y]) in moved.points.iter_mut().enumerate() {
        match v % 5 {
            0 => *x += 0.123_456_789,
            1 => *y = -*y / 3.0,
            _ => {}
        }
    }
    for (before, after) in arrangements(&mesh).iter().zip(arrangements(&moved)) {
        let (folder, file) = read(before);
        assert!(mesh_of(&file) == mesh);
        file.write(&folder.path("out"), &moved.points).unwrap();
        assert!(fs::read(folder.path("out")).unwrap() == after);

        // One node gets another tag, and one triangle is inverted by a swap of two corners.
        let start = |triangle| match file.triangle_location(triangle).location {
            Location::Byte(at) => at,
            other => panic!("{other:?}"),
        };
        let (corners, width) = match file.format() {
            Format::Gmsh22Binary => (12, 4),
            _ => (8, 8),
        };
        let mut odd = before.clone();
        odd[start(50_000) + 3] ^= 1;
        let [a, b, c] = [0, 1, 2].map(|i| start(60_000) + corners + i * width);
        odd.copy_within(a..b, b);
        odd[a..b].copy_from_slice(&before[b..c]);
        let (folder, file) = read(&odd);
        let [a, b, c] = mesh.triangles[60_000];
        assert_eq!(file.triangles()[60_000], [b, a, c]);
        assert_eq!(file.triangle_location(49_999).id, 50_000);
        assert_ne!(file.triangle_location(50_000).id, 50_001);
        file.write(&folder.path("out"), file.points()).unwrap();
        assert!(fs::read(folder.path("out")).unwrap() == odd);
    }
}

#[test]
fn sections_may_end_without_a_line_end_before_them() {
    for bytes in [msh22(false), msh41(false)] {
        let (_folder, file) = read(&bytes);
        for end in ["\n$EndNodes\n$Elements", "\n$EndElements"] {
            let at = find(&bytes, end.as_bytes());
            let without = [&bytes[..at], &bytes[at + 1..]].concat();
            let (folder, again) = read(&without);
            assert_eq!(mesh_of(&again), mesh_of(&file));
            again.write(&folder.path("out"), again.points()).unwrap();
            assert!(fs::read(folder.path("out")).unwrap() == without);
        }
    }
}

#[test]
fn parametric_nodes_of_version_2_are_read() {
    for big in [false, true] {
        let mut file = Binary::new("2.2", big);
        file.text("$ParametricNodes\n4\n");
        for (tag, dimension) in [(1, 0), (2, 1), (3, 2), (4, 3)] {
            file.ints(&[tag]);
            file.doubles(&[f64::from(tag), f64::from(tag * tag), 0.]);
            file.ints(&[dimension, 7]);
            file.doubles(&vec![0.5; if dimension < 3 { dimension as usize } else { 0 }]);
        }
        file.text("\n$EndParametricNodes\n$Elements\n1\n");
        file.ints(&[2, 1, 0, 1, 1, 2, 4]);
        file.text("\n$EndElements\n");
        let (_folder, read) = read(&file.bytes);
        assert_eq!(read.points(), [[1., 1.], [2., 4.], [3., 9.], [4., 16.]]);
        assert_eq!(read.triangles(), [[0, 1, 3]]);
    }
}

/// Returns the error for a file in which `from`, which occurs once, is replaced by `to`, and the offset of `from`.
fn error(bytes: &[u8], from: &[u8], to: &[u8]) -> (usize, String) {
    let at = find(bytes, from);
    let damaged = [&bytes[..at], to, &bytes[at + from.len()..]].concat();
    (at, error_of(&damaged))
}

fn error_of(bytes: &[u8]) -> String {
    let folder = Folder::new(&[]);
    fs::write(folder.path("a.msh"), bytes).unwrap();
    let error = MeshFile::read(&folder.path("a.msh")).unwrap_err().to_string();
    assert_eq!(error.lines().count(), 1, "{error}");
    let name = error.find("a.msh").unwrap();
    error[name..].to_owned()
}

fn words(numbers: &[i32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

#[test]
fn errors_in_binary_files_name_byte_and_remedy() {
    let v2 = msh22(false);
    assert_eq!(
        error(&v2, b"2.2 1 8", b"2.2 1 4").1,
        "a.msh:2: its numbers have 4 bytes, and only those of 8 are read. Save as ASCII (Mesh.Binary=0)"
    );
    assert_eq!(
        error(&v2, b"\x01\0\0\0\n$End", b"\x01\0\n$End").1,
        "a.msh, byte 20: the byte-order mark is not the number 1 in either byte order. The file is damaged: copy it again as \
         binary, or save the mesh again"
    );
    assert_eq!(
        error_of(&v2[..22]),
        "a.msh, byte 20: the file ends before its byte-order mark. The file is cut off: copy it again, or \
         write the mesh again"
    );
    let nodes = find(&v2, b"$Nodes\n6\n") + 9;
    assert_eq!(
        error_of(&v2[..nodes + 60]),
        format!(
            "a.msh, byte {}: the file ends after 2 of 6 nodes. The file is cut off: copy it again, or write the \
             mesh again",
            nodes + 56
        )
    );
    let (_, message) = error(&v2, b"$Nodes\n6\n", b"$Nodes\n5\n");
    assert!(message.contains("$Nodes goes on after the 5 nodes it announces"), "{message}");
    let (at, message) = error(&v2, &words(&[70, 0]), &words(&[-70, 0]));
    let wanted =
        format!("a.msh, byte {at}: a node tag is -70, not a whole number from 0. The file");
    assert!(message.starts_with(&wanted), "{message}");
    let (at, message) = error(&v2, &0.25_f64.to_le_bytes(), &f64::NAN.to_le_bytes());
    let wanted = format!("a.msh, byte {}: x of node 5 is NaN, not a finite number. ", at - 4);
    assert!(message.starts_with(&wanted), "{message}");
    let (at, message) = error(&v2, &words(&[2, 1, 3, 4, 0, 1]), &words(&[9, 1, 3, 4, 0, 1]));
    let wanted = format!("a.msh, byte {at}: element type 9 is of higher order");
    assert!(message.starts_with(&wanted), "{message}");
    let (at, message) = error(&v2, &words(&[2, 2, 2, 5]), &words(&[2, 4, 2, 5]));
    let wanted =
        format!("a.msh, byte {at}: a block of 4 elements where the section's count leaves 3");
    assert!(message.starts_with(&wanted), "{message}");
    let (at, message) = error(&v2, &words(&[3, 70, 5]), &words(&[3, 71, 5]));
    let wanted = format!("a.msh, byte {}: triangle 5 has node 71, which $Nodes does not", at - 12);
    assert!(message.starts_with(&wanted), "{message}");
    let node = |tag: i32| [&words(&[tag])[..], &1_f64.to_le_bytes(), &0_f64.to_le_bytes()].concat();
    let (at, message) = error(&v2, &node(4), &node(90_000));
    let wanted = format!("a.msh, byte {}: node 90000 is listed a second time", at + 4);
    assert!(message.starts_with(&wanted), "{message}");
}

#[test]
fn errors_in_blocks_of_binary_files_name_byte_and_remedy() {
    let v4 = msh41(false);
    let size =
        |numbers: &[u64]| -> Vec<u8> { numbers.iter().flat_map(|n| n.to_le_bytes()).collect() };
    let nodes = find(&v4, b"$Nodes\n\x02") + 7;
    let (_, message) = error(&v4, &size(&[2, 5, 1, 9]), &size(&[2, 1 << 40, 1, 9]));
    let wanted = format!("a.msh, byte {nodes}: 1099511627776 vertices are announced, but at most");
    assert!(message.starts_with(&wanted), "{message}");
    let (_, message) = error(&v4, &size(&[2, 5, 1, 9]), &size(&[2, 6, 1, 9]));
    assert!(
        message.contains("the blocks hold 5 of the 6 nodes the section announces"),
        "{message}"
    );
    let (at, message) = error(&v4, &size(&[4, 9, 8]), &size(&[5, 9, 8]));
    let wanted =
        format!("a.msh, byte {}: a block of 5 nodes where the section's count leaves 4", at - 12);
    assert!(message.starts_with(&wanted), "{message}");
    let (_, message) = error(&v4, &size(&[2, 5, 1, 5]), &size(&[u64::MAX, u64::MAX, 1, 5]));
    assert!(message.contains("element type 1953391981 is not known"), "{message}");
    let (_, message) = error(&v4, &size(&[2, 5, 1, 9]), &size(&[u64::MAX, 5, 1, 9]));
    assert!(message.contains("a block of 8319395793566264389 nodes where the"), "{message}");
    let (at, message) = error(&v4, &size(&[3, 9, 8, 6]), &size(&[3, 9, 8, 9]));
    let wanted = format!("a.msh, byte {at}: triangle 3 lists node 9 twice. Remove the triangle");
    assert!(message.starts_with(&wanted), "{message}");
    for cut in nodes..v4.len() {
        // A file is complete if the cut comes after $EndElements.
        if let Err(error) = std::panic::catch_unwind(|| error_of(&v4[..cut])) {
            let whole = find(&v4, b"$EndElements") + "$EndElements".len();
            assert!(cut >= whole, "cut at {cut}: {error:?}");
        }
    }
}
