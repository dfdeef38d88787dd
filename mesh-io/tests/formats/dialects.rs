//! Layouts of formats that programs write and that the formats' manuals do not have.

use super::Folder;
use super::errors::assert_error;
use super::facts::{fixed, remarks};
use super::made::base;
use super::made::binary::selafin;
use mesh_io::{Format, MeshFile, Precision};

/// Reads a file, and checks that unmoved vertices give the same bytes, and that moved vertices change no other word.
#[track_caller]
fn read(name: &str, text: &str) -> MeshFile {
    let folder = Folder::new(&[(name, text)]);
    let file = folder.read(name);
    let out = format!("out-{name}");
    file.write(&folder.path(&out), file.points()).unwrap();
    assert_eq!(folder.text(&out), text);
    file
}

#[test]
fn the_length_of_records_decides_the_precision_of_a_selafin_whatever_its_title() {
    let mesh = base();
    for precision in [Precision::Single, Precision::Double] {
        for big in [false, true] {
            for title in ["SERAFIN ", "SERAFIND", "        ", "written"] {
                let mut made = selafin(&mesh, precision, big, 1);
                made.bytes[76..84].copy_from_slice(format!("{title:<8}").as_bytes());
                let folder = Folder::new(&[]);
                folder.put("in.slf", &made.bytes);
                let file = folder.read("in.slf");
                assert_eq!((file.precision(), file.points()), (precision, &made.points()[..]));
                file.write(&folder.path("out.slf"), file.points()).unwrap();
                assert!(std::fs::read(folder.path("out.slf")).unwrap() == made.bytes);
            }
        }
    }
}

#[test]
fn versions_of_gmsh_are_numbers_in_any_spelling() {
    let text = |version: &str| super::GMSH22.replacen("2.2 0 8", &format!("{version} 0 8"), 1);
    for version in ["2", "2.0", "2.1", "2.2", "2.200000", "2.20", "+2.2e0"] {
        assert_eq!(read("a.msh", &text(version)).format(), Format::Gmsh22, "{version}");
    }
    let text = |version: &str| super::GMSH41.replacen("4.1 0 8", &format!("{version} 0 8"), 1);
    for version in ["4.10", "4.100000"] {
        assert_eq!(read("a.msh", &text(version)).format(), Format::Gmsh41, "{version}");
    }
    for version in ["1", "2.3", "3", "4.2", "40", "nan", "x"] {
        let problem = format!("gmsh's format version {version} is not read");
        assert_error(&[("a.msh", &text(version))], &["a.msh:2: ", &problem]);
    }
}

/// A square of four triangles around node 10, with a point, two lines and a quadrilateral beside the square.
const GMSH1: &str = "$NOD\n7\n1 0 0 5\n2 1 0 5\n3 1 1 5\n4 0 1 5\n10 .25 .5 5\n6 2 0 5\n7 2 1 5\n$ENDNOD\n$ELM\n8\n\
1 15 0 1 1 1\n2 1 7 1 2 1 2\n3 1 7 2 2 2 3\n4 2 5 1 3 1 2 10\n5 2 5 1 3 2 3 10\n6 2 6 2 3 3 4 10\n7 2 6 2 3 4 1 10\n\
8 3 5 1 4 2 6 7 3\n$ENDELM\n";

#[test]
fn gmsh_1_is_read_and_rewritten() {
    for text in [GMSH1.to_owned(), GMSH1.replace('\n', "\r\n"), format!("\n{GMSH1}\n\n")] {
        let file = read("a.msh", &text);
        assert_eq!(file.format(), Format::Gmsh1);
        assert_eq!(file.triangles(), [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
        assert_eq!(file.regions(), Some(&[0, 0, 1, 1][..]));
        assert_eq!(fixed(&file), [0, 0, 1, 1, 2, 1, 5, 6, 2, 4]);
        assert_eq!(remarks(&file), ["1 quadrilateral"]);
        assert_eq!((file.vertex_location(4).id, file.triangle_location(2).id), (10, 6));
    }
    let folder = Folder::new(&[("a.msh", GMSH1)]);
    let file = folder.read("a.msh");
    let groups = file.groups().unwrap();
    let names: Vec<_> = groups.iter().map(|group| group.to_string()).collect();
    assert_eq!(
        names,
        [
            "entity point 1",
            "entity line 1",
            "entity line 2",
            "entity surface 1",
            "entity surface 2",
            "physical line 7",
            "physical surface 5",
            "physical surface 6"
        ]
    );
    let mut moved = file.points().to_vec();
    moved[4] = [0.5, 0.375];
    file.write(&folder.path("out.msh"), &moved).unwrap();
    assert_eq!(folder.text("out.msh"), GMSH1.replace("10 .25 .5 5", "10 0.5 0.375 5"));
}

#[test]
fn damaged_files_of_gmsh_1_are_errors_with_a_line() {
    let refused = |from: &str, to: &str, parts: &[&str]| {
        assert!(GMSH1.contains(from), "{from}");
        assert_error(&[("a.msh", &GMSH1.replacen(from, to, 1))], parts);
    };
    refused("4 2 5 1 3 1", "4 2 5 1 4 1", &["a.msh:16: element 4 is a triangle of 4 nodes"]);
    refused("4 2 5 1 3 1", "4 4 5 1 4 1", &["a.msh:16: element type 4 makes this a volume mesh"]);
    refused("4 2 5 1 3 1", "4 9 5 1 6 1", &["a.msh:16: element type 9 is of higher order"]);
    refused("$ENDELM\n", "", &["a.msh:11: $ELM has no $ENDELM"]);
    refused("$ENDNOD\n", "$EndNodes\n", &["$NOD has no $ENDNOD"]);
    refused("$ELM\n8\n", "$ELM\n9\n", &["the section ends after 8 of 9 elements"]);
    refused("$ELM\n8\n", "$ELM\n7\n", &["$ELM goes on after the 7 elements it announces"]);
    refused("2 3 10\n", "2 3 11\n", &["a.msh:17: triangle 5 has node 11"]);
    refused("$ENDNOD\n", "$ENDNOD\n$NOD\n0\n$ENDNOD\n", &["this is the second $NOD section"]);
    let at = GMSH1.find("$ELM").unwrap();
    let (nodes, elements) = GMSH1.split_at(at);
    assert_error(&[("a.msh", nodes)], &["a.msh: it has no $Elements section"]);
    let swapped = format!("$Comments\n$EndComments\n{elements}{nodes}");
    assert_error(&[("a.msh", &swapped)], &["a.msh:3: $ELM stands before the nodes"]);
}

/// Squares of two triangles, of which the second is a quadrilateral that repeats a corner in place of the fourth.
#[test]
fn quadrilaterals_that_repeat_a_corner_as_the_fourth_are_triangles() {
    let gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
                $Elements\n3\n1 2 2 1 2 1 2 3\n2 3 2 1 2 1 3 4 4\n3 3 2 3 2 1 3 4 4\n$EndElements\n";
    let vtk = "# vtk DataFile Version 3.0\nm\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 1 1 0 0 1 0\n\
               CELLS 2 9\n3 0 1 2\n4 0 2 3 3\nCELL_TYPES 2\n5\n9\n";
    for (name, text, repeated) in [
        ("a.msh", gmsh, "1 3 4 4"),
        ("a.vtk", vtk, "0 2 3 3"),
        ("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 2 3 3\n", "0 2 3 3"),
        (
            "a.su2",
            "NDIME= 2\nNELEM= 2\n5 0 1 2\n9 0 2 3 3\nNPOIN= 4\n0 0\n1 0\n1 1\n0 1\n",
            "0 2 3 3",
        ),
        (
            "a.2dm",
            "MESH2D\nE3T 1 1 2 3 1\nE4Q 2 1 3 4 4 1\nND 1 0 0 0\nND 2 1 0 0\nND 3 1 1 0\nND 4 0 1 0\n",
            "1 3 4 4",
        ),
        (
            "a.inp",
            "*NODE\n1, 0., 0.\n2, 1., 0.\n3, 1., 1.\n4, 0., 1.\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n\
                   *ELEMENT, TYPE=CPS4\n2, 1, 3, 4, 4\n",
            "1, 3, 4, 4",
        ),
    ] {
        assert!(text.contains(repeated), "{name}");
        let first = if repeated.contains(',') { "1, 3, 4, 1" } else { "1 3 4 1" };
        let first = if repeated.starts_with('0') { "0 2 3 0" } else { first };
        for text in [text.to_owned(), text.replace(repeated, first)] {
            let file = read(name, &text);
            assert_eq!(file.triangles(), [[0, 1, 2], [0, 2, 3]], "{text}");
            assert_eq!(remarks(&file), <[String; 0]>::default(), "{text}");
            let id = 2 - u64::from(first.starts_with('0'));
            assert_eq!(file.triangle_location(1).id, id, "{name}");
        }
        // A quadrilateral whose second corner repeats the first stays a quadrilateral.
        let other = match first {
            "0 2 3 0" => "0 0 2 3",
            "1 3 4 1" => "1 1 3 4",
            _ => "1, 1, 3, 4",
        };
        let file = read(name, &text.replace(repeated, other));
        assert_eq!(
            (file.triangles().len(), remarks(&file)),
            (1, vec!["1 quadrilateral".to_owned()]),
            "{other}"
        );
    }
    let folder = Folder::new(&[("a.msh", gmsh)]);
    let groups = folder.read("a.msh").groups().unwrap();
    let sizes: Vec<_> =
        groups.iter().map(|group| (group.to_string(), group.triangles().len())).collect();
    assert_eq!(
        sizes,
        [
            ("physical surface 1".to_owned(), 2),
            ("physical surface 3".to_owned(), 1),
            ("entity surface 2".to_owned(), 2)
        ]
    );
}
