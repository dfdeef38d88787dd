//! Input files of Abaqus and CalculiX: sets and surfaces, parts, omitted and included items, and the digits of
//! coordinates.

use super::Folder;
use super::facts::{fixed, remarks};
use super::layouts::{assert_refused, assert_same};
use mesh_io::Precision;
use mesh_io::{Group, MeshFile};
use std::path::Path;

const NODES: &str = "*NODE\n1, 0., 0.\n2, 2., 0.\n3, 2., 2.\n4, 0., 2.\n5, 1., 1.\n";
const ELEMENTS: &str = "*ELEMENT, TYPE=CPS3, ELSET=Left\n1, 1, 2, 5\n2, 2, 3, 5\n*ELEMENT, TYPE=CPS3, ELSET=Right\n\
3, 3, 4, 5\n4, 4, 1, 5\n";

fn deck() -> String {
    [NODES, ELEMENTS].concat()
}

fn read(text: &str) -> MeshFile {
    MeshFile::from_bytes(Path::new("a.inp"), text.into())
        .unwrap_or_else(|error| panic!("{error} of {text}"))
}

/// Returns each group as text with its triangles, its number of lines, and its vertices.
fn groups(text: &str) -> Vec<String> {
    let told = |group: &Group| {
        format!("{group}: {:?} {} {:?}", group.triangles(), group.lines, group.vertices())
    };
    read(text).groups().unwrap().iter().map(told).collect()
}

#[test]
fn keywords_and_rows_of_an_input_file_may_be_laid_out_in_many_ways() {
    let deck = deck();
    for (from, to) in [
        ("*NODE", "*node"),
        ("*NODE", "  * Node  ,  SYSTEM = r"),
        ("*ELEMENT, TYPE=CPS3", "*Element,type = cps3"),
        ("TYPE=CPS3, ", "TYPE=CPS3,\n"),
        ("TYPE=CPS3, ", "TYPE=CPS3,\n** comment\n "),
        ("ELSET=Right", "ELSET=\"Right\""),
        ("\n", "\r\n"),
        ("\n", "\n\n** 9, 9., 9.\n  \n"),
        (", ", ","),
        (", ", "  ,\t"),
        ("1, 1, 2, 5", "1, 1,\n2,\n** comment\n 5"),
        ("2, 2, 3, 5", "2, 2, 3, 5,"),
        ("2, 2., 0.", "2, 2., 0., 0., 0., 0., 1."),
        ("2, 2., 0.", "2, .2D+1, 0."),
        ("4, 1, 5\n", "4, 1, 5"),
        ("*NODE\n", "*HEADING\n*\n 1, 2\n*NODE\n"),
    ] {
        assert_same("a.inp", &deck, &deck.replace(from, to));
    }
    assert_same("a.inp", &deck, &format!("\u{feff}{deck}"));
    assert_same("a.inp", &deck, &[ELEMENTS, NODES].concat());
    let named = read(&deck.replace("5, 1., 1.\n", "*NODE, NSET=\"in, side\"\n5, 1., 1.\n"));
    assert_eq!(named.groups().unwrap().find("in, side").unwrap().vertices(), [4]);
    let flat = read(&deck.replace("TYPE=CPS3, ELSET=Right", "TYPE=S3"));
    assert_eq!(flat.regions(), Some(&[0, 0, 1, 1][..]));
    assert_eq!(read(&deck.replace(", ELSET=Right", ", ELSET=LEFT")).regions(), None);
}

#[test]
fn what_an_input_file_leaves_out_or_makes_is_refused_with_its_place() {
    let refused = |from: &str, to: &str, parts: &[&str]| {
        let deck = deck();
        assert!(deck.contains(from), "{from}");
        assert_refused("a.inp", &deck.replacen(from, to, 1), parts);
    };
    refused(
        "4, 0., 2.",
        "4, 0.",
        &["a.inp:5: y of node 4 is left out, which stands for 0. Write the number 0"],
    );
    refused("4, 0., 2.", "4, , 2.", &["a.inp:5: x of node 4 is left out"]);
    refused("4, 0., 2.", "4, 0.,, 2.", &["a.inp:5: y of node 4 is left out"]);
    refused("4, 0., 2.", "4, 0., x", &["a.inp:5: y of node 4 is `x`, not a finite number"]);
    refused("4, 0., 2.", "3, 0., 2.", &["a.inp:5: node 3 is listed a second time"]);
    refused("1, 1, 2, 5", "1, 1, 2", &["a.inp:8: a vertex of a triangle is missing"]);
    refused("1, 1, 2, 5", "1, 1, 2, 5, 4", &["a.inp:8: triangle 1 has more nodes than 3"]);
    refused(
        "1, 1, 2, 5",
        "1, 1, 2, 7",
        &["a.inp:8: triangle 1 has node 7, which *NODE does not list"],
    );
    refused(
        "TYPE=CPS3",
        "TYPE=CPS6",
        &["a.inp:7: ", "CPS6 have nodes on their sides", "Save linear"],
    );
    refused(
        "TYPE=CPS3",
        "TYPE=C3D4",
        &["a.inp:7: elements of the type C3D4 make this a volume mesh"],
    );
    refused("TYPE=CPS3", "TYPE=TRI", &["a.inp:7: the type of elements TRI is not known", "CPS3"]);
    refused("TYPE=CPS3, ", "", &["a.inp:7: *ELEMENT has no TYPE"]);
    for keyword in ["NGEN", "nfill", "NCOPY", "NMAP", "ELGEN", "ElCopy"] {
        let parts = ["a.inp:7: *", "a row for each node and element"];
        refused("*ELEMENT", &format!("*{keyword}\n1, 2, 1\n*ELEMENT"), &parts);
    }
    refused("*NODE", "*SYSTEM\n1., 0., 0.\n*NODE", &["a.inp:1: *SYSTEM moves nodes"]);
    read(&deck().replace("*NODE", "*SYSTEM\n*NODE"));
    refused("*NODE", "*NODE, SYSTEM=C", &["a.inp:1: nodes are in the coordinates of SYSTEM=C"]);
    refused(
        "*NODE",
        "*NODE, INPUT=n.txt",
        &["a.inp:1: the rows of *NODE are in another file, n.txt"],
    );
    refused("*NODE", "*NODE PRINT", &["a.inp: the file has no *NODE card"]);
    assert_refused("a.inp", "4 2 0 0 0\n1 0 0 0\n", &["a.inp: the file has no *NODE card"]);
    assert_refused("a.txt", "** a title\n", &["a.txt: the file has no *NODE card"]);
    assert_refused("a.inp", NODES, &["5 vertices, but no triangle"]);
    assert_refused("a.inp", &deck().replace('\n', "\r"), &["carriage returns alone"]);
}

#[test]
fn elements_that_are_no_triangles_hold_their_vertices() {
    let held = |text: &str| {
        let mut held = fixed(&read(&[&deck().replace("Right", "Left"), text].concat()));
        held.sort_unstable();
        held
    };
    assert_eq!(held(""), []);
    assert_eq!(held("*ELEMENT, TYPE=B31\n7, 3, 5, 9\n"), [2, 4]);
    assert_eq!(held("*ELEMENT, TYPE=CPE4R\n7, 1, 2, 3, 5\n"), [0, 1, 2, 4]);
    assert_eq!(held("*ELEMENT, TYPE=CONN2D2\n7, , 5\n8, 1,\n\n"), [0, 4]);
    assert_eq!(held("*ELEMENT, TYPE=U12\n7, 1, 2, 3,\n4, 5\n"), [0, 1, 2, 3, 4]);
    assert_eq!(held("*SURFACE, NAME=S\n2, S2\n1, SPOS\n"), [2, 4]);
    assert_eq!(held("*SURFACE, NAME=S, TYPE=NODE\n5, 1.\n"), []);
    let notes = remarks(&read(&[&deck(), "*ELEMENT, TYPE=SPRING1\n7, 5\n"].concat()));
    assert_eq!(notes, ["1 element of the type SPRING1"]);
}

#[test]
fn sets_and_surfaces_of_an_input_file_are_groups() {
    let sets = "*ELSET, ELSET=all\nleft, RIGHT\n*Elset,elset=odd,generate\n1, 3, 2\n*ELSET, ELSET=odd\n900,\n\
        *NSET, NSET=Corners\n1, 2,\n3, 4\n*NSET, NSET=most, GENERATE\n2, 1000000000000\n*nset, nset=both\nCORNERS, 5\n\
        *NSET, NSET=own, INTERNAL\n1\n*ELSET, ELSET=loop\nloop2, 1\n*ELSET, ELSET=loop2\nloop\n*SURFACE, NAME=top\nright, S1\n";
    assert_eq!(
        groups(&[&deck(), sets].concat()),
        [
            "elset surface Left: [0, 1] 0 [0, 1, 2, 4]",
            "elset surface all: [0, 1, 2, 3] 0 [0, 1, 2, 3, 4]",
            "elset surface odd: [0, 2] 0 [0, 1, 2, 3, 4]",
            "elset surface loop: [0] 0 [0, 1, 4]",
            "elset surface loop2: [0] 0 [0, 1, 4]",
            "elset surface Right: [2, 3] 0 [0, 2, 3, 4]",
            "surface line top: [] 2 [0, 2, 3]",
            "nset point Corners: [] 0 [0, 1, 2, 3]",
            "nset point most: [] 0 [1, 2, 3, 4]",
            "nset point both: [] 0 [0, 1, 2, 3, 4]",
        ]
    );
}

/// Sections separate regions even if their sets differ from the sets of element lists.
#[test]
fn vertices_between_sections_are_held() {
    let one = deck().replace("Right", "Left");
    let between = |more: &str| read(&[&one, more].concat()).interface_vertices().to_vec();
    let section = |set: &str| format!("*SOLID SECTION, ELSET={set}, MATERIAL=M\n1.,\n");
    let sets = "*ELSET, ELSET=a\n1, 2\n*ELSET, ELSET=b, GENERATE\n3, 4\n";
    assert_eq!(between(&[sets, &section("A")].concat()), []);
    assert_eq!(between(&[sets, &section("A"), &section("B")].concat()), [4]);
    let shell = section("B").replace("SOLID", "shell");
    assert_eq!(between(&[sets, &section("Left"), &shell].concat()), [4]);
    let text = [&one[..], &section("elsewhere")].concat();
    assert!(remarks(&read(&text))[0].contains("set ELSEWHERE, which the file lacks"));
}

/// meshio writes sets without sections, and element lists without sets.
#[test]
fn sets_alone_tell_regions_apart_where_nothing_else_does() {
    let plain = deck().replace(", ELSET=Left", "").replace(", ELSET=Right", "");
    let between = |more: &str| read(&[&plain, more].concat()).interface_vertices().to_vec();
    assert_eq!(between(""), []);
    assert_eq!(between("*ELSET, ELSET=all\n1, 2, 3, 4\n"), []);
    assert_eq!(between("*ELSET, ELSET=a\n1, 2\n"), [4]);
    assert_eq!(between("*ELSET, ELSET=all, GENERATE\n1, 4\n*ELSET, ELSET=a\n1\n"), [4]);
    assert_eq!(between("*ELSET, ELSET=a, INTERNAL\n1, 2\n"), []);
    assert_eq!(between("*ELSET, ELSET=a\n1, 2\n*SOLID SECTION, ELSET=a, MATERIAL=M\n1.\n"), []);
    let regions = read(&[&plain, "*ELSET, ELSET=a\n1, 3\n*ELSET, ELSET=b\n3, 4\n"].concat());
    assert_eq!(regions.regions(), Some(&[0, 1, 2, 3][..]));
}

fn parts() -> String {
    format!(
        "*Part, name=P\n{}*Elset, elset=Set-1\n1\n*Nset, nset=mid\n5\n*End Part\n*Part, name=Q\n*Node\n1, 9., 9.\n*End Part\n*Assembly, name=A\n\
         *Instance, name=P-1, part=P\n1., 2., 0.\n*End Instance\n*Instance, name=P-2, part=P\n*End Instance\n*Instance, name=Q-1, part=Q\n\
         *End Instance\n*Node\n1, 4., 4., 0.\n*Elset, elset=Set-1, instance=P-1\n2, 3\n*Elset, elset=none, instance=Q-1\n1\n\
         *Nset, nset=inside\nP-1.mid, Q-1.1, P-2.2, 3\n*Surface, name=S\nP-1.Set-1, S1\n*Element, type=CONN2D2\n1, P-1.3, 1\n*End Assembly\n",
        deck()
    )
}

#[test]
fn one_part_of_an_assembly_is_a_mesh() {
    let text = parts();
    let file = read(&text);
    assert_eq!((file.points().len(), file.triangles().len()), (5, 4));
    assert_eq!(
        groups(&text),
        [
            "elset surface Left: [0, 1] 0 [0, 1, 2, 4]",
            "elset surface part.Set-1: [0] 0 [0, 1, 4]",
            "elset surface Set-1: [1, 2] 0 [1, 2, 3, 4]",
            "elset surface Right: [2, 3] 0 [0, 2, 3, 4]",
            "surface line S: [] 1 [0, 1]",
            "nset point mid: [] 0 [4]",
            "nset point inside: [] 0 [1, 4]",
        ]
    );
    assert!(fixed(&file).contains(&2));
    // A part without nodes; its instance contains the mesh.
    let own = format!(
        "*PART, NAME=P\n*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=P\n{}*END INSTANCE\n*ELSET, ELSET=E, INSTANCE=P-1\n4\n*END ASSEMBLY\n",
        deck()
    );
    assert!(groups(&own).contains(&"elset surface E: [3] 0 [0, 3, 4]".to_owned()));
    let of_assembly = text.replace("CONN2D2", "S3");
    assert_refused("a.inp", &of_assembly, &["an assembly has elements in addition"]);
}

/// Both parts number their nodes and elements from 1, and the second has the sets `Left` and `Right` too.
#[test]
fn several_parts_are_one_mesh() {
    let more = "*Elset, elset=Set-2\n2\n*Nset, nset=foot\n1\n";
    let second = format!(
        "*Part, name=Q\n{}{more}*End Part\n*Assembly",
        deck().replace("5, 1., 1.", "50, 1., 1.").replace(", 5\n", ", 50\n")
    );
    let text =
        parts().replacen("*Part, name=Q\n*Node\n1, 9., 9.\n*End Part\n*Assembly", &second, 1);
    assert_ne!(text, parts());
    let text = text.replace("elset=none, instance=Q-1", "elset=both, instance=Q-1");
    let text = text.replace(
        "*Nset, nset=inside\nP-1.mid, Q-1.1",
        "*Nset, nset=inside\nP-1.mid, Q-1.foot, Q-1.2",
    );
    let file = read(&text);
    assert_eq!((file.points().len(), file.triangles().len()), (10, 8));
    let shifted = file.triangles()[..4].iter().map(|corners| corners.map(|v| v + 5));
    assert_eq!(file.triangles()[4..], shifted.collect::<Vec<_>>());
    assert!(
        remarks(&file)[0]
            .starts_with("2 parts have elements (P, Q): each is read in coordinates of its own"),
        "{:?}",
        remarks(&file)
    );
    let groups = groups(&text);
    for group in [
        "elset surface P.Left: [0, 1] 0 [0, 1, 2, 4]",
        "elset surface Q.Left: [4, 5] 0 [5, 6, 7, 9]",
        "elset surface Set-2: [5] 0 [6, 7, 9]",
        "elset surface both: [4] 0 [5, 6, 9]",
        "elset surface P.Set-1: [0] 0 [0, 1, 4]",
        "elset surface Set-1: [1, 2] 0 [1, 2, 3, 4]",
        "nset point inside: [] 0 [1, 4, 5, 6]",
    ] {
        assert!(groups.contains(&group.to_owned()), "{group}: {groups:#?}");
    }
    // The connector of the assembly holds a node of the first part.
    assert!(fixed(&file).contains(&2) && !fixed(&file).contains(&7));
    let mut points = file.points().to_vec();
    points[9] = [0.25, 0.5];
    let mut moved = Vec::new();
    file.write_to(Path::new("a.inp"), &mut moved, &points).unwrap();
    let moved = String::from_utf8(moved).unwrap();
    let rows = |text: &str| text.lines().filter(|line| line.starts_with("50, ")).count();
    assert_eq!((rows(&text), rows(&moved)), (1, 1));
    assert_eq!(read(&moved).points()[9], [0.25, 0.5]);
    assert_eq!(read(&moved).points()[..9], file.points()[..9]);
}

#[test]
fn included_files_must_not_hold_a_part_of_the_mesh() {
    let main = format!("{}*INCLUDE, INPUT=more.inp\n", deck());
    let with = |more: &str| {
        let folder =
            Folder::new(&[("a.inp", &main), ("more.inp", more), ("last.inp", "*NGEN\n1, 2\n")]);
        MeshFile::read(&folder.path("a.inp"))
            .map(|file| remarks(&file))
            .map_err(|error| error.to_string())
    };
    assert_eq!(with("*MATERIAL, NAME=M\n*ELASTIC\n1., 0.3\n"), Ok(vec![]));
    assert!(
        with("*ELSET, ELSET=a\n1\n").unwrap()[0]
            .starts_with("more.inp, which is included, has sets, sections or surfaces")
    );
    for more in ["*NODE\n7, 1., 1.\n", "** rows\n9, 1, 2, 3\n", "*include, input = last.inp\n"] {
        let error = with(more).unwrap_err();
        assert!(
            error.contains("a.inp:13: more.inp, which is included here, holds nodes or elements"),
            "{error}"
        );
    }
    // Includes of one file many times, and of files that include each other.
    assert_eq!(
        with(&"*INCLUDE, INPUT=more.inp\n*INCLUDE, INPUT=a.inp\n".repeat(50)).map_err(drop),
        Err(())
    );
    assert_eq!(with(&"*INCLUDE, INPUT=more.inp\n".repeat(50)), Ok(vec![]));
    let two = read(&[&main[..], "*INCLUDE, INPUT=other.inp\n*INCLUDE, INPUT=other.inp\n"].concat());
    assert!(
        remarks(&two)[0].starts_with("2 files such as more.inp, which are included, do not exist")
    );
    assert_eq!(
        remarks(&read(&main)),
        ["more.inp, which is included, does not exist: its content is not part of the mesh"]
    );
}

#[test]
fn third_coordinates_are_data_if_they_differ() {
    let raised = deck()
        .replace("3, 2., 2.\n", "3, 2., 2., 3.D-1, 0., 0., 1.\n")
        .replace("5, 1., 1.\n", "5, 1., 1., nan\n");
    let file = read(&raised);
    assert_eq!(file.data_names(), ["z"]);
    let [z] = &file.point_fields(None).unwrap()[..] else { panic!() };
    assert_eq!(z.values()[..4], [0.0, 0.0, 0.3, 0.0]);
    assert!(z.values()[4].is_nan());
    assert_eq!(read(&deck()).data_names(), [""; 0]);
}

/// Neither Abaqus nor CalculiX reads more than the first 20 characters of a number.
#[test]
fn coordinates_are_written_in_20_characters() {
    let long =
        deck().replace("5, 1., 1.\n", "5, -1.23456789012345678e-03, 1.23456789012345678e+00\n");
    let file = read(&long);
    assert_eq!(file.precision(), Precision::Text20);
    let note = "1 node has a coordinate of more than 20 characters: CalculiX reads only the first 20 characters, which are another number";
    assert_eq!(remarks(&file), [note]);
    assert_eq!(remarks(&read(&deck())), [""; 0]);
    assert_eq!(file.points()[4], [-1.234_567_890_123_457e-3, 1.234_567_890_123_456_7]);
    let written = |points: &[[f64; 2]]| {
        let mut out = Vec::new();
        file.write_to(Path::new("out"), &mut out, points).unwrap();
        String::from_utf8(out).unwrap()
    };
    assert_eq!(written(file.points()), long);
    let mut points = file.points().to_vec();
    points[4] = [-1.0 / 300.0, 1e-9 / 7.0];
    let moved = written(&points);
    assert_eq!(
        moved,
        long.replace("-1.23456789012345678e-03", "-.003333333333333334")
            .replace("1.23456789012345678e+00", "1.42857142857143e-10")
    );
}

#[test]
fn sets_of_sets_that_would_take_forever_are_refused() {
    let mut text = [NODES, "*ELEMENT, TYPE=CPS3, ELSET=all\n"].concat();
    (0..4000).for_each(|t| text.push_str(&format!("{}, 1, 2, 5\n", t + 1)));
    assert_eq!(read(&text).groups().unwrap().len(), 1);
    (0..4000).for_each(|set| text.push_str(&format!("*ELSET,ELSET=s{set},GENERATE\n1,4000\n")));
    let error = read(&text).groups().unwrap_err().to_string();
    let of_regions =
        MeshFile::from_bytes(Path::new("a.inp"), text.replace(", ELSET=all", "").into());
    assert_eq!(of_regions.unwrap_err().to_string(), error);
    assert!(error.contains("its sets have more members than any mesh of this size"), "{error}");
}
