//! Text of gmsh, PLY and OFF, which programs read word by word across line ends, and rows with missing numbers.

use super::Folder;
use super::layouts::{assert_refused, assert_same};

const GMSH_2: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1.25 0\n\
4 0 1 0\n$EndNodes\n$Elements\n3\n1 1 2 4 5 1 2\n2 2 2 7 8 1 2 3\n3 2 2 7 9 1 3 4\n$EndElements\n";

const GMSH_4: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 0 0 0 1 1 0 1 7 0\n\
$EndEntities\n$Nodes\n2 4 1 4\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n1 1.25 0\n2 1 0 1\n4\n0 1 0\n\
$EndNodes\n$Elements\n1 2 1 2\n2 1 2 2\n1 1 2 3\n2 1 3 4\n$EndElements\n";

const GMSH_40: &str = "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n2 4\n1 2 0 3\n1 0 0 0\n2 1 0 0\n\
3 1 1.25 0\n1 2 0 1\n4 0 1 0\n$EndNodes\n$Elements\n1 2\n1 2 2 2\n1 1 2 3\n2 1 3 4\n$EndElements\n";

/// Returns the text with the content of one section changed.
fn within(text: &str, section: &str, change: impl Fn(&str) -> String) -> String {
    let (open, close) = (format!("${section}\n"), format!("\n$End{section}"));
    let start = text.find(&open).unwrap() + open.len();
    let end = text.find(&close).unwrap();
    format!("{}{}{}", &text[..start], change(&text[start..end]), &text[end..])
}

#[test]
fn lists_of_gmsh_are_read_word_by_word_wherever_lines_end() {
    for plain in [GMSH_2, GMSH_4, GMSH_40] {
        for section in ["Nodes", "Elements"] {
            for (from, to) in
                [("\n", " "), (" ", "\n"), ("\n", "\t\r\n\n"), (" 0\n", " 0 "), ("1.25 ", "1.25\n")]
            {
                let odd = within(plain, section, |list| list.replace(from, to));
                if odd != plain {
                    assert_same("a.msh", plain, &odd);
                }
            }
        }
        // A single row of the list lacks a number.
        let broken = plain.replace("1.25 0\n", "1.25\n");
        assert_refused("a.msh", &broken, &["z of node 3 is missing"]);
    }
}

#[test]
fn parameters_of_nodes_stay_at_the_ends_of_their_rows() {
    let parametric = |text: &str| {
        text.replace("2 1 0 3\n", "2 1 1 3\n")
            .replace("0 0 0\n1 0 0\n1 1.25 0\n", "0 0 0 .5 .5\n1 0 0 .5 .5\n1 1.25 0 .5 .5\n")
            .replace("1 2 0 3\n", "1 2 1 3\n")
            .replace("1 0 0 0\n2 1 0 0\n3 1 1.25 0\n", "1 0 0 0 1 1\n2 1 0 0 2 2\n3 1 1.25 0 3 3\n")
    };
    for plain in [GMSH_4, GMSH_40] {
        assert_same("a.msh", plain, &parametric(plain));
        let joined = within(&parametric(plain), "Elements", |list| list.replace('\n', " "));
        assert_same("a.msh", plain, &joined);
    }
}

const PLY: &str = "ply\nformat ascii 1.0\ncomment of the plane\nelement vertex 4\nproperty double x\nproperty double y\n\
property double z\nproperty float q\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
0 0 0 1\n1 0 0 1\n1 1.25 0 2\n0 1 0 1\n3 0 1 2\n3 0 2 3\n";

#[test]
fn items_of_ply_are_read_word_by_word_wherever_lines_end() {
    for (from, to) in [
        ("\n", " "),
        (" ", "\n"),
        ("1 1.25 0 2\n", "1 1.25 0 2 "),
        ("1.25 0", "1.25\n0"),
        ("3 0 1 2", "3\n0 1 2"),
        ("1\n3", "1 3"),
    ] {
        let (head, list) = PLY.split_once("end_header\n").unwrap();
        let odd = format!("{head}end_header\n{}\n", list.replace(from, to));
        let file = assert_same("a.ply", PLY, &odd);
        assert_eq!(file.data_names(), ["q"]);
    }
    // Elements without properties take no bytes, so a file may announce any number of elements.
    let many = "element nothing 18446744073709551615\n";
    assert_same("a.ply", PLY, &PLY.replace("element face", &format!("{many}element face")));
    assert_same("a.ply", PLY, &PLY.replace("end_header", &format!("{many}end_header")));
    let broken = PLY.replace("0 1 0 1\n", "0 1 0\n");
    assert_refused("a.ply", &broken, &["a.ply:15: a number of an item is missing"]);
}

#[test]
fn vertices_of_an_off_share_rows_anywhere() {
    const OFF: &str = "OFF\n4 2 5\n0 0 0\n1 0 0\n1 1.25 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
    for joined in ["1 0 0 1 1.25 0\n", "1 0 0\n1 1.25 0 ", "1 0 0 1 1.25 0 "] {
        assert_same("a.off", OFF, &OFF.replace("1 0 0\n1 1.25 0\n", joined));
        let spaced =
            OFF.replace("1 0 0\n1 1.25 0\n", joined).replace("OFF\n", "OFF\n\n# seven\n\n");
        assert_same("a.off", OFF, &spaced);
    }
}

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1.25 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
const SMS: &str = "MESH2D\nE3T 1 1 2 3 5\nE3T 2 1 3 4 7\nND 1 0 0 0\nND 2 1 0 0\nND 3 1 1.25 0\nND 4 0 1 0\n\
NS 1 2 -3 1\nE2L 3 1 4\nMAT 5 \"mud\"\n";

#[test]
fn vertices_may_have_no_third_coordinate() {
    for (name, plain) in [("a.obj", OBJ), ("a.2dm", SMS)] {
        let file = assert_same(name, plain, &plain.replace("1.25 0\n", "1.25\n"));
        assert!(file.data_names().is_empty());
        let points = plain.replace(" 0\n", "\n");
        let file = assert_same(name, plain, &points);
        assert!(file.point_fields(Some(&["z".into()])).is_err(), "there is no z");
        // If only some vertices have z, the values are data, and only existing values can be replaced.
        let some = points.replace("1.25\n", "1.25 3\n");
        let folder = Folder::new(&[(name, &some)]);
        assert_eq!(folder.read(name).data_names(), ["z"]);
        assert_refused(name, &points.replace("1.25\n", "1.25 x\n"), &["is `x`, not a number"]);
    }
}

#[test]
fn keywords_of_sms_may_be_lowercase() {
    for keyword in ["MESH2D", "E3T", "ND", "NS", "E2L", "MAT"] {
        assert_same("a.2dm", SMS, &SMS.replace(keyword, &keyword.to_ascii_lowercase()));
    }
    let small = SMS.to_ascii_lowercase();
    assert_same("a.2dm", SMS, &small);
    assert_refused(
        "a.2dm",
        &small.replace("e3t 2 1 3 4 7", "e6t 2 1 3 4 7"),
        &["nodes on their sides"],
    );
}

#[test]
fn line_ends_of_old_systems_are_refused_with_a_remedy() {
    let told = "its lines end in carriage returns alone, as on old Macintosh systems. Make them line feeds first";
    for (name, text) in
        [("a.msh", GMSH_2), ("a.ply", PLY), ("a.obj", OBJ), ("a.2dm", SMS), ("a.dat", "1 2\n3 4\n")]
    {
        assert_refused(name, &text.replace('\n', "\r"), &[name, told]);
    }
    let folder =
        Folder::new(&[("a.node", "3 2 0 0\r1 0 0\r2 1 0\r3 0 1\r"), ("a.ele", "1 3 0\n1 1 2 3\n")]);
    let error = mesh_io::MeshFile::read(&folder.path("a.ele")).unwrap_err().to_string();
    assert!(error.contains("a.node") && error.contains(told), "{error}");
    // Formats that are read word by word allow any line ends.
    const MEDIT: &str = "MeshVersionFormatted 2\nDimension 2\nVertices\n4\n0 0 3\n1 0 0\n1 1.25 0\n0 1 0\n\
                         Triangles\n2\n1 2 3 5\n1 3 4 5\nEnd\n";
    assert_same("a.mesh", MEDIT, &MEDIT.replace('\n', "\r"));
}

const MFEM: &str = "MFEM mesh v1.0\ndimension\n2\nelements\n2\n5 2 0 1 2\n5 2 0 2 3\nboundary\n1\n7 1 0 1\nvertices\n4\n2\n0 0\n1 0\n\
1 1.25\n0 1\n";

#[test]
fn a_mesh_of_mfem_is_read_word_by_word_wherever_lines_end() {
    let (head, body) = MFEM.split_once('\n').unwrap();
    for (from, to) in
        [("\n", " "), (" ", "\n"), ("\n", "\t\r\n\n"), ("\n", " # a comment\n"), ("2 0 ", "2\n0 ")]
    {
        assert_same("a.mesh", MFEM, &format!("{head}\n{}", body.replace(from, to)));
    }
    // The points of a space of order 1 are the vertices.
    let space = "vertices\n4\n\nnodes\nFiniteElementSpace\nFiniteElementCollection: H1_2D_P1\nVDim: 2\nOrdering: 1\n\n";
    let nodes = MFEM.replace("vertices\n4\n2\n", space);
    assert_same("a.mesh", MFEM, &nodes);
    assert_same("a.mesh", MFEM, &nodes.replace("H1_2D_P1", "Linear").replace("\n", "  \n"));
    let broken = MFEM.replace("5 2 0 2 3\n", "5 2 0 2\n");
    assert_refused("a.mesh", &broken, &["a.mesh:7: a vertex of a triangle is `boundary`"]);
}
