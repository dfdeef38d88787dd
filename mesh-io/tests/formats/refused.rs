//! Unsupported files of other programs, and the remedy in each error message.

use super::made::binary::selafin;
use super::made::{Made, PROBED, base};
use super::others::{folder, for_each};
use super::{Folder, Path};
use mesh_io::Precision;
use mesh_io::{Format, MeshFile};
use std::fs;

/// Checks that a file with these bytes is refused with a message of one line that contains all `parts`.
#[track_caller]
fn assert_refused(name: &str, bytes: impl AsRef<[u8]>, parts: &[&str]) {
    let folder = Folder::new(&[]);
    fs::write(folder.path(name), bytes).unwrap();
    let error = match MeshFile::read(&folder.path(name)) {
        Ok(file) => panic!("{file:?} is read, not refused for {parts:?}"),
        Err(error) => error.to_string(),
    };
    for part in parts.iter().chain(&[name]) {
        assert!(error.contains(part), "no {part:?} in {error:?}");
    }
    assert_eq!(error.lines().count(), 1, "{error}");
}

const OF_THE_PLANE: &str = "Only meshes of the plane are read";

#[test]
fn meshes_of_a_volume_are_refused() {
    let volume = |name: &str, text: &str, at: &str| {
        assert_refused(name, text, &[at, "this a volume mesh. ", OF_THE_PLANE]);
    };
    volume("a.su2", "% by hand\nNDIME= 3\nNELEM= 0\n", "a.su2:2: three dimensions (NDIME= 3)");
    volume("a.su2", "NDIME= 2\nNPOIN= 1\n0 0\nNELEM= 1\n10 0 1 2 3\n", "a.su2:5: ");
    let head = "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\n";
    for keyword in ["Tetrahedra", "Hexahedra", "Prisms", "Pyramids"] {
        let text = format!("{head}{keyword}\n1\n1 2 3 4 0\nEnd\n");
        volume("a.mesh", &text, &format!("a.mesh:7: {keyword} make"));
    }
    volume("a.vtk", &vtk_of_one_cell(4, 10), "a.vtk:");
    assert_refused(
        "a.2dm",
        "MESH2D\nND 1 0 0 0\nE4T 1 1 2 3 4 1\n",
        &["a.2dm:3: ", "elements of a volume", OF_THE_PLANE],
    );
    for precision in [Precision::Single, Precision::Double] {
        for big in [false, true] {
            let made = selafin(&base(), precision, big, 5);
            assert_refused("a.slf", made.bytes, &["several planes make", OF_THE_PLANE]);
        }
    }
}

/// Returns a legacy VTK file with one cell of type `cell_type` with `points` points.
fn vtk_of_one_cell(points: usize, cell_type: usize) -> String {
    let rows: String = (0..points).map(|i| format!("{i} {} 0\n", i * i)).collect();
    let corners: String = (0..points).map(|i| format!(" {i}")).collect();
    format!(
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {points} double\n\
         {rows}CELLS 1 {}\n{points}{corners}\nCELL_TYPES 1\n{cell_type}\n",
        points + 1
    )
}

#[test]
fn elements_of_higher_order_are_refused() {
    for (points, cell_type) in [(6, 22), (6, 69), (3, 21)] {
        let type_of = format!("cell 0 is of type {cell_type}, not of first order");
        let text = vtk_of_one_cell(points, cell_type);
        assert_refused("a.vtk", text, &["a.vtk:", &type_of, "linear triangles (type 5)"]);
    }
    let nodes = "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 0 1 0\n";
    for keyword in ["E6T", "E8Q", "E9Q", "E3L"] {
        let text = format!("{nodes}{keyword} 1 1 2 3 1 2 3 1\n");
        let parts = ["a.2dm:5: ", "nodes on their sides", "Save linear elements (E3T, E4Q)"];
        assert_refused("a.2dm", text, &parts);
    }
    let six = "% six nodes\nNDIME= 2\nNPOIN= 1\n0 0\nNELEM= 1\n22 0 1 2 3 4 5\n";
    assert_refused("a.su2", six, &["a.su2:6: element type 22", "triangles (5)"]);
}

#[test]
fn other_contents_of_known_formats_are_refused() {
    let vtk = |rest: &str, parts: &[&str]| {
        assert_refused("a.vtk", format!("# vtk DataFile Version 3.0\nt\n{rest}"), parts);
    };
    for kind in ["STRUCTURED_POINTS", "STRUCTURED_GRID", "RECTILINEAR_GRID", "FIELD"] {
        let named = format!("a.vtk:4: datasets of kind {kind} have no triangles");
        vtk(
            &format!("ASCII\nDATASET {kind}\nDIMENSIONS 2 2 1\n"),
            &[&named, "Save as an unstructured grid"],
        );
    }
    vtk("HEX\nDATASET POLYDATA\n", &["a.vtk:3: `HEX` is neither ASCII nor BINARY"]);
    let points = "ASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0\n0 1 0\n";
    let strips = format!("{points}TRIANGLE_STRIPS 1 4\n3 0 1 2\n");
    vtk(&strips, &["a strip of triangles", "Save strips as triangles"]);
    vtk(&points.replace("double", "int"), &["a.vtk:5: points are of the type `int`", "float"]);
    vtk(&format!("{points}{}", &points[23..]), &["a.vtk:8: this is the second list of POINTS"]);
    vtk(points, &["3 vertices, but no triangle. Meshes are read by their triangles"]);
    vtk("ASCII\nDATASET POLYDATA\n", &["it has no POINTS"]);
    assert_refused("a.vtk", vtk_of_one_cell(4, 6), &["strip of triangles", "as triangles"]);
    assert_refused("a.vtk", vtk_of_one_cell(4, 5), &["cell 0, a triangle, has 4 points"]);

    assert_refused("a.off", "OFF BINARY\n\0\0\0\x03", &["binary OFF is not read", "Save as text"]);
    let five = "OFF\n1 1 0\n0 0 0\n5 0 1 2 3 4\n";
    assert_refused("a.off", five, &["a.off:4: a face has 5 vertices", "Split it into triangles"]);
    let medit = "MeshVersionFormatted 2\nDimension 4\n";
    assert_refused("a.mesh", medit, &["a.mesh:2: the dimension is 4", "It is 2, or 3"]);
    let two = "MeshVersionFormatted 2\nDimension 2\nVertices 1\n0 0 0\nVertices 1\n0 0 0\n";
    assert_refused(
        "a.mesh",
        two,
        &["a.mesh:5: this is the second list of Vertices", "separate file"],
    );
    assert_refused("a.obj", "v 0 0 0\nf 1 2/x b\n", &["a.obj:2: a vertex is `b`"]);
    assert_refused("a.obj", "v 0 0 0\nf 1 -2 1\n", &["a.obj:2: "]);
    let grid = "bay\n1 1\n1 0 0 0\n1 5 1 1 1 1 1\n";
    assert_refused("a.gr3", grid, &["a.gr3:4: element 1 has 5 nodes", "three and four nodes"]);
    let other = "MESH2D\nND 1 0 0 0\nNS 1 0 -1\n";
    assert_refused("a.2dm", other, &["a.2dm:3: a node string has node 0"]);
}

#[test]
fn files_without_a_vertex_are_refused_as_no_mesh() {
    for name in ["a.2dm", "a.su2", "a.obj"] {
        let parts =
            ["a.", ": neither vertices nor triangles were found. Check that the file is a mesh"];
        assert_refused(name, "minutes of the meeting\n", &parts);
    }
}

#[test]
fn damaged_meshes_of_coasts_are_refused_with_place_and_reason() {
    let head = "100079 1000 4 UTM-32\n1 0 0 0 1\n2 1 0 0 1\n3 1 1 0 1\n4 0 1 0 1\n";
    let mike =
        |rest: &str, parts: &[&str]| assert_refused("a.mesh", format!("{head}{rest}"), parts);
    mike("2 5 25\n1 1 2 3 4 0\n", &["a.mesh:6: elements have up to 5 nodes. Elements of three"]);
    mike("2 3 21\n1 1 2 9\n", &["a.mesh:7: triangle 1 has node 9, which the list of nodes "]);
    mike("2 3 21\n1 1 2\n", &["a.mesh:7: a vertex of a triangle is missing. "]);
    mike("", &["a.mesh:5: the file ends after 0 of 1 lines of the count of elements. "]);
    let fvcom = |text: &str, parts: &[&str]| assert_refused("a_grd.dat", text, parts);
    fvcom("Node Number = 4\n1 1 2 3 1\n", &["a_grd.dat:2: the row `Cell Number = ` with a number"]);
    fvcom("1 2 3\n", &["a_grd.dat:1: the row `Node Number = ` with a number is missing. "]);
    let cells = "Node Number = 4\nCell Number = 1\n1 1 2 3 1\n1 0 0\n2 1 0\n3 1 1\n";
    fvcom(cells, &["a_grd.dat:6: the file ends after 3 of 4 nodes. The file is cut off"]);
    let mfem = |rest: &str, parts: &[&str]| {
        assert_refused("a.mesh", format!("MFEM mesh v1.0\ndimension\n{rest}"), parts);
    };
    mfem("3\n", &["a.mesh:3: three dimensions make this a volume mesh"]);
    mfem("2\nelements\n1\n1 9 0 1 2\n", &["a.mesh:6: 9 is no geometry"]);
    mfem("2\nelements\n1\n1 4 0 1 2 3\n", &["a.mesh:6: elements of a volume make this"]);
    mfem("2\nelements\n0\nknots\n", &["a.mesh:6: a section `knots` is not read. "]);
    let space = "2\nvertices\n3\n\nnodes\nFiniteElementSpace\nFiniteElementCollection: ";
    let nodes = |rest: &str, parts: &[&str]| mfem(&format!("{space}{rest}"), parts);
    mfem("2\nvertices\n3\nknots\n", &["a.mesh:6: `knots` stands in place of coordinates"]);
    nodes("H1_2D_P2\nVDim: 2\n", &["a.mesh:9: the points", "space H1_2D_P2", "SetCurvature(1)"]);
    nodes("L2_T1_2D_P1\n", &["a.mesh:9: the points are those of the finite element space L2_T1_"]);
    nodes("Linear\nOrdering: 1\n", &["a.mesh:10: `Ordering:` stands in place of VDim:. "]);
    nodes("Linear\nVDim: 4\nOrdering: 1\n", &["a.mesh:11: the vertices have 4 coordinates"]);
    nodes("Linear\nVDim: 2\nOrdering: 0\n", &["a.mesh:11: the x of all points", "byVDIM"]);
    nodes("Linear\nVDim: 2\nOrdering: 1\n0 0\n", &["a.mesh:12: the file ends after 1 of 3 v"]);
    nodes("", &["a.mesh:9: the points are those of the finite element space ,"]);
    mfem("2\nelements\n0\n", &["a.mesh: it has no vertices. Save the mesh again"]);
    let jigsaw = |text: &str, parts: &[&str]| assert_refused("a.msh", text, parts);
    jigsaw(
        "MSHID=3;EUCLIDEAN-GRID\n",
        &["a.msh:1: meshes of kind EUCLIDEAN-GRID are not supported"],
    );
    jigsaw("MSHID=3\nPOINT=four\n", &["a.msh:2: POINT= is followed by `four`, not a whole number"]);
    jigsaw("MSHID=3\nNDIMS=4\nPOINT=1\n", &["a.msh:3: the points have 4 coordinates. Those of 2"]);
    jigsaw("MSHID=3\nPOINT=1\n0;x;0\n", &["a.msh:3: y of a point is `x`, not a finite number"]);
    jigsaw("MSHID=3\nPOINT=0\nPOINT=0\n", &["a.msh:3: this is the second list of POINT"]);
    jigsaw("MSHID=3\nTRIA4=1\n0;1;2;3;0\n", &["a.msh:2: TRIA4 make this a volume mesh. "]);
    jigsaw("MSHID=3\nTRIA3=1\n0;1;2;0\n", &["a.msh: it has no POINT. Save the mesh again"]);
    let points = "MSHID=3\nPOINT=3\n0;0;0\n1;0;0\n0;1;0\n";
    jigsaw(
        &format!("{points}TRIA3=1\n0;1;3;0\n"),
        &["a.msh:7: triangle 0 has node 3, which POINT "],
    );
}

/// Returns the name that messages use for a format's list of vertices.
fn list_of(made: &Made) -> &'static str {
    match made.format {
        Format::Vtk | Format::VtkBinary => "POINTS",
        Format::Su2 => "NPOIN",
        Format::Jigsaw => "POINT",
        Format::Medit | Format::MeditBinary => "Vertices",
        Format::Obj => "the list of v rows",
        Format::Adcirc | Format::Mike | Format::Fvcom | Format::Ugrid => "the list of nodes",
        Format::Sms2dm => "the list of ND rows",
        Format::Gmsh1 | Format::Gmsh40 | Format::Gmsh40Binary => "$Nodes",
        Format::Selafin => "the list of points",
        Format::Xdmf => "Geometry",
        Format::Exodus => "the list of coordinates",
        Format::Abaqus => "*NODE",
        Format::Nastran => "GRID",
        _ => "the list of vertices",
    }
}

fn error(made: &Made) -> String {
    let error = MeshFile::read(&folder(made, &made.bytes).path(made.name)).unwrap_err().to_string();
    assert!(error.contains(made.name) && error.lines().count() == 1, "{error}");
    error
}

#[test]
fn vertices_that_are_not_there_are_errors_that_name_the_list() {
    let mut mesh = base();
    mesh.triangles[PROBED.1][1] = 99;
    for_each(&mesh, |made| {
        let error = error(made);
        let triangle = format!("triangle {} has node ", made.triangle.0);
        let is_told = error.contains(&triangle) || (made.lists_edges() && error.contains("edge "));
        let list = format!("which {} does not list. ", list_of(made));
        assert!(is_told, "{error}");
        let list_of = "a format whose list has another name needs a row of `list_of`";
        assert!(error.contains(&list), "{error}: not {list}; {list_of}");
    });
}

#[test]
fn triangles_of_one_vertex_twice_are_errors() {
    let mut mesh = base();
    let [a, ..] = mesh.triangles[PROBED.1];
    mesh.triangles[PROBED.1][2] = a;
    // The edges of such a triangle are those of a valid net.
    for_each(&mesh, |made| {
        if made.lists_edges() {
            return;
        }
        let error = error(made);
        let triangle = format!("triangle {} lists node ", made.triangle.0);
        assert!(error.contains(&triangle) && error.contains(" twice. Remove "), "{error}");
    });
}

#[test]
fn coordinates_that_are_not_finite_are_errors() {
    for (axis, value) in [(0, f64::NAN), (1, f64::INFINITY), (1, f64::NEG_INFINITY)] {
        let mut mesh = base();
        mesh.points[PROBED.0 as usize][axis] = value;
        for_each(&mesh, |made| {
            let error = error(made);
            assert!(error.contains("finite number"), "{error}");
        });
    }
}

#[test]
fn coordinates_beyond_the_precision_of_the_file_are_errors() {
    let mut mesh = base();
    mesh.points[PROBED.0 as usize][1] = 1e39;
    for_each(&mesh, |made| {
        if made.precision == Precision::Single {
            error(made);
        }
    });
}

#[test]
fn points_beyond_the_precision_of_the_file_are_not_written() {
    for_each(&base(), |made| {
        let folder = folder(made, &made.bytes);
        let file = folder.read(made.name);
        let mut points = file.points().to_vec();
        points[PROBED.0 as usize][0] = -1e39;
        let written = file.write(&folder.path("out"), &points);
        assert_eq!(written.is_err(), made.precision == Precision::Single);
        assert_eq!(folder.path("out").exists(), written.is_ok());
    });
}

/// The endings are those of formats whose readers skip unknown rows.
#[test]
fn files_that_are_no_meshes_are_named_whatever_their_ending() {
    let lfs = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n";
    let page = "\n<!DOCTYPE html>\n<html><body>404</body></html>\n";
    let text = "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 0 1 0\nE3T 1 1 2 3 1\n";
    let units: Vec<u16> = text.encode_utf16().collect();
    let little = units.iter().flat_map(|unit| unit.to_le_bytes()).collect::<Vec<u8>>();
    let big = units.iter().flat_map(|unit| unit.to_be_bytes()).collect::<Vec<u8>>();
    let utf16 = ["a text in UTF-16", "iconv"];
    for ending in ["2dm", "su2", "gr3", "mesh", "inp", "msh", "txt"] {
        let name = format!("a.{ending}");
        assert_refused(&name, lfs, &["a pointer of Git LFS", "git lfs pull"]);
        assert_refused(&name, page, &["an HTML page", "Download"]);
        assert_refused(&name, format!("\u{feff}{page}"), &["an HTML page", "Download"]);
        assert_refused(&name, little.clone(), &utf16);
        assert_refused(&name, big.clone(), &utf16);
        assert_refused(&name, [&[0xFF, 0xFE][..], &little].concat(), &utf16);
        assert_refused(&name, [&[0xFE, 0xFF][..], &big].concat(), &utf16);
    }
}

/// A former defect: a count that was too small left elements out of the mesh without a word.
#[test]
fn further_elements_after_the_announced_ones_are_errors() {
    let points = "0 0\n1 0\n0 1\n1 1\n";
    let off = format!("OFF\n4 1 0\n{}3 0 1 2\n3 1 3 2\n", points.replace('\n', " 0\n"));
    assert_refused("a.off", off, &["a.off:8:", "further faces follow the 1", "Correct the count"]);
    let su2 = format!("NDIME= 2\nNELEM= 1\n5 0 1 2\n5 1 3 2\nNPOIN= 4\n{points}");
    assert_refused("a.su2", su2, &["a.su2:4:", "further elements follow the 1"]);
    let su2 = format!("NDIME= 2\nNPOIN= 3\n{points}NELEM= 1\n5 0 1 2\n");
    assert_refused("a.su2", su2, &["a.su2:6:", "further points follow the 3"]);
    let numbered = points.lines().zip(1..).map(|(at, k)| format!("{k} {at} 0\n"));
    let nodes = numbered.collect::<String>();
    let adcirc = format!("grid\n1 4\n{nodes}1 3 1 2 3\n2 3 2 4 3\n0\n0\n0\n0\n");
    assert_refused("a.14", adcirc, &["a.14:8:", "further elements follow the 1"]);
    let freefem = format!("4 1 0\n{}1 2 3 0\n2 4 3 0\n", points.replace('\n', " 0\n"));
    assert_refused("a.msh", freefem, &["a.msh:7:", "further edges follow the 0"]);
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n{points}3 0 1 2\n3 1 3 2\n"
    );
    assert_refused("a.ply", ply, &["a.ply:14:", "further items follow the 5"]);
}

/// A former defect: the first triangle was said to be wrong.
#[test]
fn an_su2_that_is_cut_off_before_its_points_is_named_so() {
    let su2 = "NDIME= 2\nNELEM= 3\n5 0 1 2\n5 1 3 2\n5 2";
    assert_refused("a.su2", su2, &["before its points (NPOIN)", "cut off"]);
}

/// A former defect: zero bytes, which a crash may leave in a file, made two numbers of one.
#[test]
fn zero_bytes_within_numbers_are_errors() {
    let off = "OFF\n3 1 0\n0 0 0\n1.09\x00\x0079 1 0\n0 1 0\n3 0 1 2\n";
    assert_refused("a.off", off, &["a.off:4: "]);
    // Zero bytes after the last line are no row.
    let off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\0\0\0";
    let file = MeshFile::from_bytes(Path::new("a.off"), off.into()).unwrap();
    assert_eq!(file.triangles().len(), 1);
}

/// Text of other kinds may follow the lists.
#[test]
fn other_text_after_a_list_is_no_element() {
    let points = "0 0 0\n1 0 0\n0 1 0\n";
    for end in ["", "\n\n# made by hand\n", "end of the file\n", "3 0\n"] {
        let off = format!("OFF\n3 1 0\n{points}3 0 1 2\n{end}");
        let file = MeshFile::from_bytes(Path::new("a.off"), off.into_bytes()).unwrap();
        assert_eq!(file.triangles().len(), 1, "{end:?}");
    }
    // One open boundary with three nodes, whose numbers would read as those of an element.
    let boundaries = "1\n3\n3 0\n1\n2\n3\n0\n0\n";
    let adcirc = format!("grid\n1 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n1 3 1 2 3\n{boundaries}");
    let file = MeshFile::from_bytes(Path::new("a.14"), adcirc.into_bytes()).unwrap();
    assert_eq!(file.triangles().len(), 1);
}

/// A former defect: the message blamed the `Dimensions`, which are right.
#[test]
fn computed_points_and_elements_of_an_xdmf_are_refused_by_name() {
    let item = |kind: &str, dimensions: &str, numbers: &str| {
        format!(
            "<DataItem ItemType=\"{kind}\" Function=\"$0\" Dimensions=\"{dimensions}\">\
             <DataItem Dimensions=\"{dimensions}\">{numbers}</DataItem></DataItem>"
        )
    };
    for kind in ["HyperSlab", "Function", "Coordinates"] {
        let plain = "<DataItem ItemType=\"Uniform\" Dimensions=\"3 2\">0 0 1 0 0 1</DataItem>";
        let triangle = "<DataItem NumberType=\"Int\">0 1 2</DataItem>";
        for (section, points, triangles) in [
            ("Geometry", item(kind, "3 2", "0 0 1 0 0 1"), triangle.to_owned()),
            ("Topology", plain.to_owned(), item(kind, "3", "0 1 2")),
        ] {
            let text = format!(
                "<Xdmf>\n<Domain><Grid>\n<Geometry GeometryType=\"XY\">{points}</Geometry>\n\
                 <Topology TopologyType=\"Triangle\">{triangles}</Topology>\n</Grid></Domain></Xdmf>"
            );
            let line = if section == "Geometry" { 3 } else { 4 };
            let expected = format!(
                "a.xdmf:{line}: a {section} of a DataItem of the type {kind} is not read. "
            );
            let folder = Folder::new(&[("a.xdmf", &text)]);
            let error = MeshFile::read(&folder.path("a.xdmf")).unwrap_err().to_string();
            assert!(error.contains(&expected), "{error}");
        }
    }
}
