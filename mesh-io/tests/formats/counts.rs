//! Lists that end early and counts that do not fit their lists: no part of a mesh is left out without an error.

use mesh_io::{Conversion, Encoding, Format, MeshFile};
use std::path::Path;

const GRID: &str = "bay\n2 4\n1 0 0 2.5\n2 1 0 3\n3 1 1 4\n4 0 1 5\n1 3 1 2 3\n2 3 1 3 4\n";
const OPEN: &str = "1 = Number of open boundaries\n2 = Total\n2 = Number of nodes\n1\n2\n";
const LAND: &str = "2 ! land\n5\n2 0 = first\n2\n3\n2 24\n3 1 2.5 1 1\n4 2 2.5 1 1\n";

/// Reads a mesh of one file. Returns the message of the error; `None` if the mesh was read.
fn refusal(name: &str, bytes: impl Into<Vec<u8>>) -> Option<String> {
    let read = MeshFile::from_bytes(Path::new(name), bytes.into());
    read.err().map(|error| error.to_string())
}

/// Requires that a mesh is refused with a message of all `parts`.
fn assert_refused(name: &str, bytes: impl Into<Vec<u8>>, parts: &[&str]) {
    let message = refusal(name, bytes).expect("the mesh should be refused");
    assert!(parts.iter().all(|part| message.contains(part)), "{message}");
}

/// Requires that a mesh is read.
fn assert_read(name: &str, bytes: impl Into<Vec<u8>>) {
    assert_eq!(refusal(name, bytes), None);
}

/// A former defect: a file that was cut off between two markers lost the second one without a word.
#[test]
fn missing_and_further_markers_of_su2_are_errors() {
    let zone = "NDIME= 2\nNELEM= 1\n5 0 1 2\nNPOIN= 3\n0 0\n1 0\n0 1\n";
    let [low, up] =
        ["low", "up"].map(|name| format!("MARKER_TAG= {name}\nMARKER_ELEMS= 1\n3 0 1\n"));
    assert_read("a.su2", format!("{zone}{low}{up}"));
    assert_read("a.su2", format!("{zone}NMARK= 2\n{low}{up}"));
    assert_read("a.su2", format!("{low}NMARK= 2\n{up}{zone}"));
    let copies = "MARKER_TAG= SEND_RECEIVE\nMARKER_ELEMS= 1\nSEND_TO= 2\n1 0\n";
    assert_read("a.su2", format!("{zone}NMARK= 1\n{low}{copies}"));
    assert_read("a.su2", format!("{zone}NMARK= 2\n{low}{copies}"));
    let cut = format!("{zone}NMARK= 2\n{low}");
    assert_refused("a.su2", cut, &["a.su2:11: the file ends after 1 of 2 markers", "cut off"]);
    let further = format!("{zone}NMARK= 1\n{low}{up}");
    let parts = ["a.su2:13: further markers follow the 1 that NMARK announces. Correct NMARK"];
    assert_refused("a.su2", further, &parts);
    let zones = format!("NZONE= 2\nIZONE= 1\n{zone}NMARK= 1\n{low}IZONE= 2\n{zone}NMARK= 1\n{up}");
    assert_read("a.su2", zones.clone());
    let parts = ["the zone ends after 1 of 2 markers (NMARK)"];
    assert_refused("a.su2", zones.replacen("NMARK= 1", "NMARK= 2", 1), &parts);
    let first = &zones[..zones.find("IZONE= 2").unwrap()];
    assert_refused("a.su2", first, &["the file ends after 1 of 2 zones. ", "cut off"]);
    assert_refused("a.su2", format!("{zone}NMARK= two\n"), &["a.su2:8: NMARK is `two`. "]);
}

/// A former defect: boundaries of a grid that were cut off or miscounted ended reading, and later ones were lost without a
/// word.
#[test]
fn missing_and_further_boundaries_of_adcirc_are_errors() {
    let whole = format!("{GRID}{OPEN}{LAND}");
    // Grids without boundaries, or without land; and text or other counts behind the boundaries.
    for end in ["", "0\n", "0\n0\n0\n0\n", "made by hand\n", OPEN] {
        assert_read("a.14", format!("{GRID}{end}"));
    }
    for end in ["", "end\n", "0 = Number of generic boundaries\n0\n", "1\n2\n2\n3\n4\n"] {
        assert_read("a.14", format!("{whole}{end}"));
    }
    let rows: Vec<usize> = whole.match_indices('\n').map(|(at, _)| at + 1).collect();
    let first = GRID.lines().count() + 1;
    for (end, row) in rows.iter().zip(1..).filter(|&(_, row)| row >= first) {
        // The grid may end behind its open boundaries.
        match row == first + 4 || row == rows.len() {
            true => assert_read("a.14", &whole[..*end]),
            false => assert_refused("a.14", &whole[..*end], &[&format!("a.14:{row}: "), "cut off"]),
        }
    }
    let cut = |change: [&str; 2], parts: &[&str]| {
        assert_refused("a.14", whole.replace(change[0], change[1]), parts);
    };
    cut(["2 ! land", "3 ! land"], &["a.14:21: the file ends after 2 of 3 land boundaries. "]);
    cut(["2 ! land", "1 ! land"], &["a.14:19: further land boundaries follow the 1 that"]);
    cut(["2 24\n", "3 24\n"], &["a.14:21: the file ends after 2 of 3 nodes of land boundary 2. "]);
    cut(["\n3 1 2.5", "\n3 x 2.5"], &["a.14:20: the other node of one of the nodes of land boun"]);
    cut(["\n2\n3\n2 24", "\n2\nx\n2 24"], &["a.14:18: one of the nodes of land boundary 1 is `x`"]);
}

/// Converts the grid, whose mesh has two triangles.
fn grid_as(to: Format, encoding: Encoding) -> Vec<u8> {
    let file = MeshFile::from_bytes(Path::new("a.14"), GRID.into()).unwrap();
    let mut conversion = Conversion::new(&file, to).unwrap().unwrap();
    assert!(conversion.set_encoding(encoding));
    conversion.bytes().unwrap()
}

/// A former defect: time steps that were cut off were left out without a word.
#[test]
fn time_steps_of_selafin_that_are_cut_off_are_errors() {
    let whole = grid_as(Format::Selafin, Encoding::Binary);
    assert_read("a.slf", &whole[..]);
    // A step is a record of the time and a record of four depths.
    let step = 12 + 24;
    let mesh = whole.len() - step;
    assert_read("a.slf", &whole[..mesh]);
    for end in mesh + 1..whole.len() {
        assert_refused(
            "a.slf",
            &whole[..end],
            &["a.slf, byte ", "the file ends before the ", "cut off"],
        );
    }
    assert_read("a.slf", [&whole[..], &whole[mesh..]].concat());
    let next = [&whole[..], &whole[mesh..whole.len() - 4]].concat();
    assert_refused("a.slf", next, &["the file ends before the values of a variable. "]);
    let mut damaged = whole.clone();
    damaged[mesh + 12 + 3] += 1;
    assert_refused("a.slf", damaged, &["the record of the values of a variable has 17 bytes. "]);
}

/// A former defect: a count of elements that was too small left elements out of the mesh without a word.
#[test]
fn further_elements_of_mike_are_errors() {
    let mike = "100079 1000 4 UTM-32\n1 0 0 0 1\n2 1 0 0 1\n3 1 1 0 1\n4 0 1 0 1\n";
    let elements = "1 1 2 3\n2 1 3 4\n";
    assert_read("a.mesh", format!("{mike}2 3 21\n{elements}"));
    assert_read("a.mesh", format!("{mike}2 3 21\n{elements}\nend\n"));
    let parts = ["a.mesh:8: further elements follow the 1 that the file announces"];
    assert_refused("a.mesh", format!("{mike}1 3 21\n{elements}"), &parts);
}

/// A former defect: a count of elements or points that was too small left some out of the mesh without a word.
#[test]
fn further_items_of_jigsaw_are_errors() {
    let jigsaw = "MSHID=3\nPOINT=4\n0;0;0\n1;0;0\n1;1;0\n0;1;0\nTRIA3=2\n0;1;2;0\n0;2;3;0\nEDGE2=2\n0;1;1\n1;2;1\n";
    assert_read("a.msh", jigsaw);
    let changed = |from: &str, to: &str, parts: &[&str]| {
        assert_refused("a.msh", jigsaw.replace(from, to), parts);
    };
    changed("TRIA3=2", "TRIA3=1", &["a.msh:9: further elements follow the 1 that the file an"]);
    changed("EDGE2=2", "EDGE2=1", &["a.msh:12: further elements follow the 1 that the file a"]);
    changed("POINT=4", "POINT=3", &["a.msh:6: further points follow the 3 that the file anno"]);
}

/// A former defect: in binary, a count of faces that was too small left faces out of the mesh without a word.
#[test]
fn further_bytes_of_a_binary_ply_are_errors() {
    let ply = grid_as(Format::Ply, Encoding::Binary);
    assert_read("a.ply", &ply[..]);
    for end in ["\n", "\r\n", "\0\0\0"] {
        assert_read("a.ply", [&ply[..], end.as_bytes()].concat());
    }
    let count = b"element face 2";
    let at = ply.windows(count.len()).position(|bytes| bytes == count).unwrap() + count.len() - 1;
    let mut few = ply.clone();
    few[at] = b'1';
    let end = ply.len() - 13;
    let place = format!("a.ply, byte {end}: further bytes follow the 5 items that the header");
    assert_refused("a.ply", few, &[&place, "Correct the counts"]);
}
