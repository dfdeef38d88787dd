//! Bulk data of Nastran: fields of all widths, held vertices, properties, refused cards, and the digits of coordinates.

use super::Folder;
use super::facts::{between_regions, fixed, remarks};
use super::layouts::{assert_refused, assert_same};
use mesh_io::Precision;
use mesh_io::{Group, MeshFile};
use std::path::Path;

const NODES: &str =
    "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,2.,2.,0.\nGRID,4,,0.,2.,0.\nGRID,5,,1.,1.25,0.\n";
const ELEMENTS: &str = "CTRIA3,1,7,1,2,5\nCTRIA3,2,7,2,3,5\nCTRIA3,3,9,3,4,5\nCTRIA3,4,9,4,1,5\n";

fn deck() -> String {
    ["BEGIN BULK\n", NODES, ELEMENTS, "ENDDATA\n"].concat()
}

/// Returns the deck with all triangles of one property, so that vertex 5 is free.
fn one() -> String {
    deck().replace(",9,", ",7,")
}

fn read(text: &str) -> MeshFile {
    MeshFile::from_bytes(Path::new("a.bdf"), text.into())
        .unwrap_or_else(|error| panic!("{error} of {text}"))
}

fn written(file: &MeshFile, points: &[[f64; 2]]) -> String {
    let mut out = Vec::new();
    file.write_to(Path::new("out"), &mut out, points).unwrap();
    String::from_utf8(out).unwrap()
}

/// Returns the text with vertex 5 moved.
fn moved(text: &str, to: [f64; 2]) -> String {
    let file = read(text);
    let mut points = file.points().to_vec();
    points[4] = to;
    let out = written(&file, &points);
    let after = read(&out);
    assert_eq!(file.difference(&after), None);
    assert_eq!(after.points()[4], to.map(|x| file.precision().rounded(x)));
    out
}

/// Returns the fields of all lines, without blanks around their contents.
pub(crate) fn fields(text: &str) -> Vec<String> {
    let of_line = |line: &str| -> Vec<String> {
        if line.chars().take(10).any(|letter| letter == ',') {
            return line.split(',').map(|field| field.trim().to_owned()).collect();
        }
        let mut wide = String::new();
        for letter in line.chars() {
            match letter {
                '\t' => wide.push_str(&" ".repeat(8 - wide.len() % 8)),
                letter => wide.push(letter),
            }
        }
        let width = if line.chars().take(8).any(|letter| letter == '*') { 16 } else { 8 };
        let (head, rest) = wide.split_at(wide.len().min(8));
        let rest = rest.as_bytes().chunks(width).map(|field| str::from_utf8(field).unwrap());
        [head].into_iter().chain(rest).map(|field| field.trim().to_owned()).collect()
    };
    text.lines().flat_map(of_line).collect()
}

/// Parses a number whose exponent has no letter.
pub(crate) fn value(word: &str) -> f64 {
    let sign = word.rfind(['+', '-']).unwrap();
    format!("{}e{}", &word[..sign], &word[sign..]).parse().unwrap()
}

#[test]
fn cards_may_be_laid_out_in_many_ways() {
    let deck = deck();
    for (from, to) in [
        ("GRID", "grid"),
        ("GRID", "Grid "),
        (",", " , "),
        (",", ",\t"),
        ("\n", "\r\n"),
        ("\n", "\n\n$ GRID,9,,9.,9.\n# GRID,9,,9.,9.\n  \n"),
        ("0.\n", "0. $, comment\n"),
        ("0.\n", "0.,0,345,\n"),
        ("0.\n", ".0\n"),
        ("0.\n", "0.D0\n"),
        ("GRID,2,,2.", "GRID,2,0,+2."),
        ("GRID,2,,2.", "GRID,2,,20.-1"),
        ("GRID,2,,2.", "GRID,2,,.2+1"),
        ("GRID,2,,2.", "GRID,2,,.2D+01"),
        ("GRID,2,,2.,0.,0.", "GRID,2,,2.,,"),
        ("GRID,2,,2.,0.,0.", "GRID,2,,2., ,"),
        ("GRID,2,,2.,0.,0.", "GRID    2               2.              0."),
        ("GRID,2,,2.,0.,0.", "GRID    2               2.      0.      0."),
        ("GRID,2,,2.,0.,0.", "GRID\t2\t\t2.\t\t0.\t0"),
        (
            "GRID,2,,2.,0.,0.",
            "GRID*   2                               2.              0.              +\n*       0.",
        ),
        ("GRID,2,,2.,0.,0.", "GRID*,2,,2.,0.,+\n*,0."),
        ("GRID,2,,2.,0.,0.", "GRID*,2,,2.,0.,*A,*A,0."),
        ("GRID,2,,2.,0.,0.", "GRID*,2,,2.,0."),
        ("GRID,4", "GRDSET,,0,,,,345\nGRID,4"),
        ("CTRIA3,1,7,1,2,5", "CTRIA3  1       7       1       2       5"),
        ("CTRIA3,1,7,1,2,5", "CTRIAR,1,7,1,2,5,30."),
        ("CTRIA3,1,7,1,2,5", "CTRIA3*,1,7,1,2\n$ comment\n*,5"),
        ("CTRIA3,1,7,1,2,5", "CTRIA3*,1,7,1,2,*A,*A,5"),
        (
            "CTRIA3,1,7,1,2,5",
            "CTRIA3* 1               7               1               2               *A\n*A      5",
        ),
        ("CTRIA3,1,7,1,2,5", "ctria3\t1\t7\t1\t2\t5"),
        ("CTRIA3,1,7,1,2,5", "CTRIA3,1,7,1,2,5\n,,,.5"),
        ("BEGIN BULK", "SOL 101\nGRID,7\nCEND\nTITLE = x\nbegin  bulk $"),
        ("BEGIN BULK\n", ""),
        ("ENDDATA\n", ""),
        ("ENDDATA\n", "enddata\nGRID,1,,x\n"),
        ("ENDDATA\n", "MAT1,1,2.+7,,.3\nPSHELL,7,1,.1\nSPC1,1,123456,1,THRU,4\n"),
    ] {
        assert!(deck.contains(from), "{from}");
        assert_same("a.bdf", &deck, &deck.replace(from, to));
    }
    assert_same("a.dat", &deck, &format!("\u{feff}{deck}"));
    assert_same("a.dat", &deck, &["$ made by hand\n", ELEMENTS, NODES].concat());
    // A blank property is the one with the number of the element, if there is one.
    let by_number = deck.replace("CTRIA3,3,9", "CTRIA3,9,");
    let properties = by_number.replace("ENDDATA\n", "PSHELL,9,1,.1\nENDDATA\n");
    assert_eq!(read(&properties).regions(), Some(&[0, 0, 1, 1][..]));
    assert_eq!(read(&by_number).regions(), Some(&[0, 0, 1, 2][..]));
    let blank = deck.replace(",7,", ",,").replace(",9,", ",,");
    assert_eq!(read(&blank).regions(), None);
    assert_eq!(read(&one()).regions(), None);
}

#[test]
fn what_bulk_data_leave_out_or_make_is_refused_with_its_place() {
    let refused = |from: &str, to: &str, parts: &[&str]| {
        let deck = deck();
        assert!(deck.contains(from), "{from}");
        assert_refused("a.bdf", &deck.replacen(from, to, 1), parts);
    };
    let grid = "GRID,4,,0.,2.,0.";
    let left_out = "is left out at the end of its row, which stands for 0. Write the number 0";
    refused(grid, "GRID,4,,0.", &[&format!("a.bdf:5: y of node 4 {left_out}")]);
    refused(grid, "GRID,4", &[&format!("a.bdf:5: x of node 4 {left_out}")]);
    refused(grid, "GRID    4               0.", &[&format!("a.bdf:5: y of node 4 {left_out}")]);
    refused(grid, "GRID,4,,0.,x", &["a.bdf:5: y of node 4 is `x`, not a finite number"]);
    refused(grid, "GRID,4,,0.,0.,x", &["a.bdf:5: z of node 4 is `x`, not a number"]);
    refused(grid, "GRID,4.,,0.,2.", &["a.bdf:5: the number of a node is `4.`, not a whole number"]);
    refused(grid, "GRID,,,0.,2.", &["a.bdf:5: the number of a node is missing. Correct"]);
    refused(grid, "GRID,3,,0.,2.", &["a.bdf:5: node 3 is listed a second time"]);
    let system = "node 4 is in the coordinate system 3, not in the basic one. Write the nodes in";
    refused(grid, "GRID,4,3,0.,2.", &[&format!("a.bdf:5: {system}")]);
    let of_default = ["a.bdf:2: node 1 is in the coordinate system 3, not in the basic one"];
    refused("ENDDATA", "GRDSET,,3\nENDDATA", &of_default);
    read(&deck().replace(",,", ",0,").replace("ENDDATA", "GRDSET,,3\nENDDATA"));
    refused(
        "ENDDATA",
        "INCLUDE 'more.bdf'",
        &["a.bdf:11: INCLUDE names another file", "in one file"],
    );
    refused("ENDDATA", "BEGIN SUPER=1", &["a.bdf:11: a second section of bulk data begins here"]);
    refused("ENDDATA", "=,*1,=,*.5,==", &["a.bdf:11: a row repeats the row above", "without `=`"]);
    let triangle = "CTRIA3,1,7,1,2,5";
    refused(triangle, "CTRIA3,1,7,1,2", &["a.bdf:7: a vertex of triangle 1 is missing. Correct"]);
    refused(triangle, "CTRIA3,1,7,1,2,8", &["a.bdf:7: triangle 1 has node 8, which GRID does not"]);
    refused(triangle, "CTRIA3,1,7,1,2,2", &["a.bdf:7: triangle 1 lists node 2 twice"]);
    refused(triangle, "CTRIA3,1,x,1,2,5", &["a.bdf:7: the property of triangle 1 is `x`, not a"]);
    for name in ["CTRIA6", "CQUAD8", "ctriax6"] {
        let problem =
            format!("a.bdf:7: {} elements may have nodes on their sides", name.to_uppercase());
        refused("CTRIA3", name, &[&problem, "Save linear elements (CTRIA3, CQUAD4)"]);
    }
    for name in ["CTETRA", "CHEXA", "CPENTA", "CPYRAM"] {
        refused("CTRIA3", name, &[&format!("a.bdf:7: {name} elements make this a volume mesh")]);
    }
    assert_refused(
        "a.bdf",
        "BEGIN BULK\n",
        &["a.bdf: the file has no GRID card, so this is no mesh of Nastran"],
    );
    assert_refused("a.nas", NODES, &["5 vertices, but no triangle"]);
    assert_refused("a.bdf", &deck().replace('\n', "\r"), &["carriage returns alone"]);
}

#[test]
fn elements_that_are_no_triangles_hold_their_vertices() {
    let held = |cards: &str| {
        let mut held = fixed(&read(&one().replace("ENDDATA", cards)));
        held.sort_unstable();
        held.dedup();
        held
    };
    assert_eq!(held("SPC,1,5,123"), []);
    assert_eq!(held("CBAR,7,1,3,5,0.,0.,1."), [2, 4]);
    assert_eq!(held("CQUAD4,7,1,1,2,3,5"), [0, 1, 2, 4]);
    assert_eq!(held("CONROD,7,3,5,1,.5"), [2, 4]);
    assert_eq!(held("PLOTEL,7,3,5"), [2, 4]);
    assert_eq!(held("CONM2,7,5,,1."), [4]);
    // The other end of a spring may be a scalar point or the ground.
    assert_eq!(held("CELAS1,7,1,5,1,99,1"), [4]);
    assert_eq!(held("CELAS2,7,1.+3,5,1"), [4]);
    assert_eq!(held("CBUSH,7,1,5,,,,,0"), [4]);
    assert_eq!(held("RBE2,7,5,123,1,2,3,,,\n+,4,6.-6"), [0, 1, 2, 3, 4]);
    assert_eq!(held("RBE2    7       5       123     1       2"), [0, 1, 4]);
    assert_eq!(held("RBE3,7,,5,123,1.,123,1,2,,\n,.5,12,3\n,UM,4,3"), [0, 1, 2, 4]);
    assert_eq!(held("RBE1,7,1,123,2,12,,,\n,UM,3,123,5,12"), [0, 1, 2, 4]);
    assert_eq!(held("RBAR,7,1,5,123456"), [0, 4]);
    let notes = |cards: &str| remarks(&read(&one().replace("ENDDATA", cards)));
    assert_eq!(notes("CONM2,7,5,,1."), ["1 element called CONM2"]);
    let both = notes("RBE2,7,5,1,2\nCONM2,7,5");
    assert_eq!(both, ["2 elements such as CONM2"]);
}

#[test]
fn properties_are_groups_with_the_names_that_comments_give() {
    let cards = "$HMNAME PROP 9\"right half\" 4\nCBAR,8,9,1,2\nPLOTEL,9,1,2\nCONM2,10,3\nENDDATA";
    let told = |group: &Group| {
        format!("{group}: {:?} {} {:?}", group.triangles(), group.lines, group.vertices())
    };
    let file = read(&deck().replace("ENDDATA", cards));
    let groups: Vec<String> = file.groups().unwrap().iter().map(told).collect();
    assert_eq!(
        groups,
        [
            "property line right half: [] 1 [0, 1]",
            "property surface 7: [0, 1] 0 [0, 1, 2, 4]",
            "property surface right half: [2, 3] 0 [0, 2, 3, 4]",
        ]
    );
    assert_eq!(between_regions(&file), [4]);
}

#[test]
fn third_coordinates_are_data_if_they_differ() {
    assert_eq!(read(&deck()).data_names(), [""; 0]);
    let packed = "GRID*   5                                             1.            1.25+\n*       1.-3            \n";
    let raised = deck()
        .replace("GRID,3,,2.,2.,0.\n", "GRID    3               2.      2.      .25\n")
        .replace("GRID,5,,1.,1.25,0.\n", packed);
    let file = read(&raised);
    assert_eq!(file.data_names(), ["z"]);
    let mut fields = file.point_fields(None).unwrap();
    let [z] = &mut fields[..] else { panic!() };
    assert_eq!(z.values(), [0.0, 0.0, 0.25, 0.0, 0.001]);
    let new = [0.0, 0.0, 1.0 / 3.0, 0.0, -1.0 / 7.0];
    z.set(new.to_vec()).unwrap();
    let folder = Folder::new(&[]);
    file.write_with_fields(&folder.path("out.bdf"), file.points(), &fields).unwrap();
    let out = folder.text("out.bdf");
    let expected = raised.replace("2.      .25\n", "2.      .3333333\n");
    assert_eq!(out, expected.replace("*       1.-3            ", "*       -.142857        "));
    let after = folder.read("out.bdf");
    let changed = after.point_fields(None).unwrap();
    assert_eq!(file.difference_ignoring(&after, [&fields, &changed]), None);
    assert_eq!(changed[0].values()[4], -0.142_857);
}

/// Each field keeps its width, even if numbers touch each other.
#[test]
fn coordinates_fit_into_their_fields() {
    let with = |card: &str| one().replace("GRID,5,,1.,1.25,0.", card);
    for (card, precision, expected) in [
        (
            "GRID           5        1.0000001.2500000.000000       0",
            Precision::Text8,
            "GRID           5        -.33333312.345680.000000       0",
        ),
        (
            "GRID           5              1.    1.25      0.       0",
            Precision::Text8,
            "GRID           5        -.33333312.34568      0.       0",
        ),
        (
            "GRID    5               1.      1.25",
            Precision::Text8,
            "GRID    5               -.33333312.34568",
        ),
        ("GRID\t5\t\t1.\t1.25\t0.", Precision::Text8, "GRID\t5\t\t-.33333312.345680."),
        (
            "GRID*                  5               0              1.            1.25+\n*                     0.",
            Precision::Text16,
            "GRID*                  5               0-.3333333333333312.3456789012346+\n*                     0.",
        ),
        ("GRID, 5, , 1. , 1.25, 0.", Precision::Text8, "GRID, 5, , -.333333 , 12.34568, 0."),
        (
            "GRID,5,,1.000000000,1.25,0.",
            Precision::Text16,
            "GRID,5,,-.33333333333333,12.3456789012346,0.",
        ),
        (
            "GRID,5,,1.000000000000000000,1.25,0.",
            Precision::Double,
            "GRID,5,,-0.3333333333333333,12.345678901234567,0.",
        ),
    ] {
        // Free field uses the precision of its longest number for all nodes.
        let others = match precision {
            Precision::Text8 => with(card),
            _ => with(card).replace("GRID,1,,0.", "GRID,1,,0.0000000000"),
        };
        assert_eq!(read(&others).precision(), precision, "{card}");
        let out = moved(&others, [-1.0 / 3.0, 12.345_678_901_234_567]);
        assert_eq!(out, others.replace(card, expected), "{card}");
    }
    // Shorter numbers keep the alignment of the old numbers in their fields.
    for (card, expected) in [
        (
            "GRID           5              1.    1.25      0.",
            "GRID           5             0.5    -2.5      0.",
        ),
        (
            "GRID    5               1.      1.25    0.",
            "GRID    5               0.5     -2.5    0.",
        ),
        ("GRID\t5\t\t1.\t1.25\t0.", "GRID\t5\t\t0.5     -2.5    0."),
    ] {
        assert_eq!(moved(&with(card), [0.5, -2.5]), with(expected));
    }
    // Numbers that need an exponent, written without a letter, in fields that were blank.
    let blank = "GRID    5                               0.";
    let out = moved(&with(blank), [-1.234_567e-5, 1e-9 / 7.0]);
    assert_eq!(out, with(blank).replace(blank, "GRID    5               -1.235-5.14286-90."));
}

/// Programs read no more of a number than its field holds, so the narrowest field gives the precision of all nodes.
#[test]
fn the_smallest_field_gives_the_precision() {
    let small = "GRID    5               1.      1.25    0.";
    let large = "GRID*   4                               0.12345678901   2.\n*       0.";
    let text = one().replace("GRID,5,,1.,1.25,0.", small).replace("GRID,4,,0.,2.,0.", large);
    let file = read(&text);
    assert_eq!(file.precision(), Precision::Text8);
    assert_eq!(file.points()[3], [0.123_456_8, 2.0]);
    let note = "1 node has coordinates of more than 8 characters, beside fields of 8: they count as rounded to 8";
    assert_eq!(remarks(&file), [note]);
    assert_eq!(written(&file, file.points()), text);
    assert!(remarks(&read(&one())).is_empty());
}

/// Once, every comment counted as a row, and searched all later comments for a continuation.
#[test]
fn many_comments_take_no_time() {
    let start = std::time::Instant::now();
    let comments = "$ 1.0\n \n".repeat(200_000);
    let text = one().replace("GRID,2", &format!("{comments}GRID,2"));
    assert_eq!(read(&text).points().len(), 5);
    assert!(start.elapsed().as_secs() < 20);
}
