//! Single details of the formats of other programs.

use super::Folder;
use super::facts::{fixed, remarks};
use super::made::{all, base};
use mesh_io::{Format, MeshFile};
use std::fs;

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
const HALVES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

#[track_caller]
fn read(name: &str, text: &str) -> MeshFile {
    let folder = Folder::new(&[(name, text)]);
    match MeshFile::read(&folder.path(name)) {
        Ok(file) => file,
        Err(error) => panic!("{error}"),
    }
}

/// Checks that the text gives a square of two triangles in the given format.
#[track_caller]
fn assert_square(name: &str, text: &str, format: Format) -> MeshFile {
    let file = read(name, text);
    assert_eq!(file.format(), format);
    assert_eq!((file.points(), file.triangles()), (&SQUARE[..], &HALVES[..]));
    file
}

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
const OFF: &str = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
const MEDIT: &str = "MeshVersionFormatted 2\nDimension 2\nVertices\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\
Triangles\n2\n1 2 3 0\n1 3 4 0\nEnd\n";
const SU2: &str = "NDIME= 2\nNELEM= 2\n5 0 1 2\n5 0 2 3\nNPOIN= 4\n0 0\n1 0\n1 1\n0 1\n";
const GRID: &str =
    "2 4\n1 0.0 0.0 1\n2 1.0 0.0 1\n3 1.0 1.0 1\n4 0.0 1.0 1\n1 3 1 2 3\n2 3 1 3 4\n";
const SMS: &str = "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 1 1 0\nND 4 0 1 0\nE3T 1 1 2 3 1\n\
E3T 2 1 3 4 1\n";
const VTK: &str = "POINTS 4 float\n0 0 0\n1 0 0\n1 1 0\n0 1 0\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\n";

#[test]
fn comments_may_come_before_the_first_words() {
    for (name, text, format) in
        [("a.obj", OBJ, Format::Obj), ("a.off", OFF, Format::Off), ("a.mesh", MEDIT, Format::Medit)]
    {
        assert_square(name, &format!("# by hand\n#\n\n{text}"), format);
    }
    assert_square("a.su2", &format!("% by hand\n%\n\n{SU2}"), Format::Su2);
}

#[test]
fn the_content_tells_the_format_whatever_the_ending() {
    for made in all(&base()) {
        for name in ["in.dat", "in", "in.node", "in.stl"] {
            // Rows of plain numbers could also be the vertices of a Triangle mesh.
            if name == "in.node" && matches!(made.format, Format::Adcirc | Format::FreeFem) {
                continue;
            }
            let folder = Folder::new(&[]);
            std::fs::write(folder.path(name), &made.bytes).unwrap();
            let format = MeshFile::read(&folder.path(name)).map(|file| file.format());
            assert_eq!(format.map_err(|e| e.to_string()), Ok(made.format), "{}", made.what);
        }
    }
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_text() {
    for made in all(&base()).into_iter().filter(|made| made.is_text()) {
        let text = String::from_utf8(made.bytes).unwrap();
        let file = read(made.name, &format!("\u{feff}{text}"));
        assert_eq!((file.format(), file.points().len()), (made.format, made.mesh.points.len()));
    }
}

#[test]
fn lines_and_points_of_an_obj_are_no_faces() {
    // Lines along three or all four corners, points, and a negative vertex number.
    for row in ["l 1 2 3", "l 2 3 4 1", "p 1 2 3", "p 1 2", "l 1 -1"] {
        let file = assert_square("a.obj", &format!("{OBJ}{row}\n"), Format::Obj);
        let numbers = row.split_whitespace().skip(1);
        let corners = numbers.map(|n| n.replace("-1", "4").parse::<u32>().unwrap() - 1);
        let (mut fixed, mut expected) = (fixed(&file), corners.collect::<Vec<_>>());
        fixed.sort_unstable();
        expected.sort_unstable();
        assert_eq!(fixed, expected, "{row}");
        assert!(!remarks(&file).join("").contains("quadrilateral"), "{:?}", remarks(&file));
    }
}

#[test]
fn polygons_keep_their_vertices_fixed() {
    let more = "v 2 0 0\nv 3 0 0\nv 3 1 0\nv 2.5 2 0\nv 2 1 0\nf 5 6 7 8 9\n";
    let file = read("a.obj", &format!("{OBJ}{more}"));
    assert_eq!((file.triangles().len(), fixed(&file)), (2, vec![4, 5, 6, 7, 8]));
}

#[test]
fn a_grid_may_have_any_title_or_none() {
    for title in ["bay", "", "  ", "# bay", "% bay", "2024", "12 7", "4 2 1", "5 2 0 1", "1 3 1"] {
        for name in ["fort.14", "a.gr3"] {
            assert_square(name, &format!("{title}\n{GRID}"), Format::Adcirc);
        }
    }
}

#[test]
fn the_title_of_a_grid_may_start_as_other_formats_do() {
    for title in ["OFF shore", "g 7", "v 2 of the bay", "NELEM, NPOIN", "solid ground"] {
        for name in ["fort.14", "a.gr3"] {
            assert_square(name, &format!("{title}\n{GRID}"), Format::Adcirc);
        }
    }
}

#[test]
fn an_element_of_one_zone_has_none_of_the_vertices_of_another() {
    let zone = |number: usize, corner: usize| {
        format!("IZONE= {number}\n{}", SU2.replace("5 0 2 3", &format!("5 0 2 {corner}")))
    };
    let file = read("a.su2", &format!("NZONE= 2\n{}{}", zone(1, 3), zone(2, 3)));
    assert_eq!(file.triangles(), [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
    for (first, second, line) in [(4, 3, 6), (3, 4, 16)] {
        let folder = Folder::new(&[]);
        let text = format!("NZONE= 2\n{}{}", zone(1, first), zone(2, second));
        std::fs::write(folder.path("a.su2"), text).unwrap();
        let error = MeshFile::read(&folder.path("a.su2")).map(|file| file.triangles().to_vec());
        let error = error.unwrap_err().to_string();
        assert!(error.contains(&format!("a.su2:{line}: ")), "{error}");
    }
}

#[test]
fn data_of_a_vtk_field_may_be_described_one_by_one() {
    let described = "METADATA\nCOMPONENT_NAMES\nseconds\n\n";
    let field = format!(
        "FIELD FieldData 3\nTIME 1 1 double\n0.5\n{described}NAMES 1 2 string\nbay\nshore%20line\n\
         CYCLE 1 1 int\n7\n{described}"
    );
    for field in [field.clone(), field.replace(described, "")] {
        let head = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\n";
        assert_square("a.vtk", &format!("{head}{field}{VTK}"), Format::Vtk);
    }
}

#[test]
fn regions_of_a_vtk_are_found_among_other_data() {
    let described = "METADATA\nCOMPONENT_NAMES\nshape\n\n";
    let regions = "1 2 int\n7 -3\n";
    let field = |name: &str| {
        format!("FIELD FieldData 2\nquality 1 2 double\n1 2\n{described}{name} {regions}")
    };
    for data in [
        "SCALARS quality double 1\nLOOKUP_TABLE default\n1 2\nSCALARS MaterialIds int\n4 5\n"
            .into(),
        format!("VECTORS wind float\n0 0 0 1 1 1\n{}", field("region")),
        field("gmsh:physical"),
        field("medit:ref").replace(described, ""),
    ] {
        let text = format!(
            "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\n{VTK}POINT_DATA 4\n\
             SCALARS region int 1\nLOOKUP_TABLE default\n1 2 3 4\nCELL_DATA 2\n{data}"
        );
        let file = assert_square("a.vtk", &text, Format::Vtk);
        assert_eq!(file.regions(), Some(&[0, 1][..]), "{data}");
    }
}

/// Positive and negative zero are equal numbers, so they name one region.
#[test]
fn a_negative_zero_is_the_region_of_zero() {
    for (kind, zeros) in [
        ("float", [0.0_f32.to_be_bytes().to_vec(), (-0.0_f32).to_be_bytes().to_vec()].concat()),
        ("double", [0.0_f64.to_be_bytes().to_vec(), (-0.0_f64).to_be_bytes().to_vec()].concat()),
        ("int", [0_i32.to_be_bytes(), i32::MIN.to_be_bytes()].concat()),
    ] {
        let mut bytes =
            b"# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 4 double\n".to_vec();
        for [x, y] in [[0.0_f64, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            bytes.extend([x, y, 0.0].iter().flat_map(|x| x.to_be_bytes()));
        }
        bytes.extend(b"\nPOLYGONS 2 8\n");
        bytes.extend([3_i32, 0, 1, 2, 3, 0, 2, 3].iter().flat_map(|n| n.to_be_bytes()));
        bytes.extend(
            format!("\nCELL_DATA 2\nSCALARS region {kind} 1\nLOOKUP_TABLE default\n").bytes(),
        );
        bytes.extend(zeros);
        bytes.extend(b"\n");
        let folder = Folder::new(&[]);
        fs::write(folder.path("in.vtk"), bytes).unwrap();
        let file = folder.read("in.vtk");
        let regions = if kind == "int" { Some(&[0, 1][..]) } else { None };
        assert_eq!(file.regions(), regions, "{kind}");
        assert_eq!(file.groups().unwrap().len(), if kind == "int" { 2 } else { 1 }, "{kind}");
    }
}

/// Points may be broken into lines anywhere, even if all other points have a line each.
#[test]
fn points_of_a_vtk_may_begin_on_the_line_of_the_keyword() {
    let head = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\n";
    for between in [" ", "\t", "\x0b", " 0 0 0\n1 0 0 1 1 0 ", "\n\n"] {
        let text = match between.contains('0') {
            true => VTK.replace("\n0 0 0\n1 0 0\n1 1 0\n", between),
            false => VTK.replace("float\n", &format!("float{between}")),
        };
        let file = assert_square("a.vtk", &format!("{head}{text}"), Format::Vtk);
        assert_eq!(file.difference(&file), None, "{between:?}");
    }
}

#[test]
fn text_between_x_and_y_is_kept() {
    let head = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\n";
    for between in ["  ", "\t", "\n", " \r\n\r\n ", " # x\n", "# x\n# y\n\n"] {
        let text = format!("{head}{}", VTK.replace("\n1 0 0", &format!("\n1{between}0 0")));
        let folder = Folder::new(&[("a.vtk", &text)]);
        // A reader may refuse the comment; if the file is read, a rewrite keeps the comment.
        let Ok(file) = MeshFile::read(&folder.path("a.vtk")) else { continue };
        let mut points = file.points().to_vec();
        points[1] = [1.5, 0.25];
        file.write(&folder.path("out.vtk"), &points).unwrap();
        let expected = text.replace(&format!("\n1{between}0 0"), &format!("\n1.5{between}0.25 0"));
        assert_eq!(folder.text("out.vtk"), expected);
    }
}

#[test]
fn keywords_of_vtk_may_be_lowercase() {
    let text = format!("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n{VTK}");
    assert_square("a.vtk", &text, Format::Vtk);
    let small = text.to_lowercase().replace("# vtk datafile version", "# vtk DataFile Version");
    assert_square("a.vtk", &small, Format::Vtk);
}

#[test]
fn off_has_several_headers() {
    for header in ["OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCNOFF", "OFF # of the plane"] {
        assert_square("a.off", &OFF.replacen("OFF", header, 1), Format::Off);
    }
}

#[test]
fn only_the_mesh_of_an_sms_file_is_read() {
    let rows = "MAT 1 \"sea\"\n  # by hand\nNS 1 3 -2 7 \"1 2 3\"\n\nGE 1 1 2 3\nE3TX 9 9 9 9\n";
    let file = assert_square("a.2dm", &format!("{SMS}{rows}"), Format::Sms2dm);
    assert_eq!(fixed(&file), [0, 2, 1]);
    assert_eq!(remarks(&file), ["3 nodes of node strings"]);
}
