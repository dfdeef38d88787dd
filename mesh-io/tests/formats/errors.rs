//! Error messages, which name the file, the line, the wrong text and a remedy.

use super::{ELE, Folder, GMSH22, GMSH41, NODE, POLY, triangle};
use mesh_io::{Format, MeshFile};
use std::fs;
use std::path::Path;

/// Checks that the first file is refused with a message of one line that contains all `parts`.
pub(crate) fn assert_error(files: &[(&str, &str)], parts: &[&str]) {
    let folder = Folder::new(files);
    let error = MeshFile::read(&folder.path(files[0].0)).unwrap_err().to_string();
    for part in parts {
        assert!(error.contains(part), "no {part:?} in {error:?}");
    }
    assert_eq!(error.lines().count(), 1, "{error}");
}

fn assert_gmsh_error(text: &str, parts: &[&str]) {
    assert_error(&[("a.msh", text)], parts);
}

#[test]
fn triangle_errors_name_line_and_remedy() {
    let node =
        |text: &str, parts: &[&str]| assert_error(&[("m.node", text), ("m.ele", ELE)], parts);
    let changed = |from: &str, to: &str| NODE.replacen(from, to, 1);
    node(
        &changed("1 0 0", "2 0 0"),
        &["m.node:4: the first vertex has number 2", "from 0 or from 1"],
    );
    node(
        &changed("3 1 1 ", "4 1 1 "),
        &["m.node:6: vertex 4 stands where vertex 3", "consecutively"],
    );
    node(&changed("4 0. ", "4 nan "), &["m.node:7: x of vertex 4 is `nan`", "Correct the line"]);
    node(&changed("4 0. ", "4 1e999 "), &["m.node:7: x of vertex 4 is `1e999`, not a finite"]);
    node(&changed("4 0. 1 7.5 1", "4 0."), &["m.node:7: y of vertex 4 is missing"]);
    node(&changed("4 0. ", "4 0,5 "), &["m.node:7: x of vertex 4 is `0,5`, not a finite"]);
    node(&changed("4 0. ", "-4 0. "), &["m.node:7: the number of a vertex is `-4`, not a whole"]);
    node(&changed("5 2 1 1", "9 2 1 1"), &["m.node:10: the file ends after 5 of 9", "cut off"]);
    node(&changed("5 2 1 1", "5 4 1 1"), &["m.node:3: the dimension is 4, not 2 or 3"]);
    node(&changed("5 2 1 1", "5000000000 2"), &["m.node:3: 5000000000 vertices", "4294967295"]);
    node(&changed("5 2 1 1", "0 2"), &["m.node:3: no vertices"]);
    node("# nothing\n", &["m.node:1: the file ends before the number of vertices"]);
    node(" \n", &["m.node: the file is empty. Write the mesh again"]);

    let ele =
        |text: &str, parts: &[&str]| assert_error(&[("m.ele", text), ("m.node", NODE)], parts);
    let changed = |from: &str, to: &str| ELE.replacen(from, to, 1);
    ele(
        &changed("4 3 1", "4 6 1"),
        &["m.ele:1:", "6 nodes", "Make the mesh with 3-node triangles"],
    );
    // No group is made, and no memory reserved, for attributes that the file has no room for.
    for count in ["400000000", "1000000000000", "18446744073709551615"] {
        ele(
            &changed("4 3 1", &format!("4 3 {count}")),
            &[&format!("m.ele:1: {count} attributes per triangle do not fit"), "Correct the line"],
        );
    }
    ele(&changed("4 3 1", "4 4 1"), &["m.ele:1: the elements have 4 nodes: tetrahedra", "plane"]);
    ele(&changed("4 3 1", "5 3 1"), &["m.ele:6: the file ends after 4 of 5 triangles", "cut off"]);
    ele(&changed("2 2 3 5", "2 2 2 5"), &["m.ele:3: triangle 2 lists vertex 2 twice", "Remove"]);
    ele(
        &changed("2 2 3 5", "2 2 6 5"),
        &["m.ele:3: triangle 2 has vertex 6", "m.node has vertices 1 to 5"],
    );
    ele(&changed("2 2 3 5", "2 0 3 5"), &["m.ele:3: triangle 2 has vertex 0"]);
    ele(&changed("2 2 3 5", "2 x 3 5"), &["m.ele:3: a vertex of triangle 2 is `x`"]);
    ele("0 3 0\n", &["5 vertices, but no triangle. Meshes are read by their triangles"]);

    let poly = |text: &str, parts: &[&str]| {
        assert_error(&[("m.node", NODE), ("m.ele", ELE), ("m.poly", text)], parts);
    };
    poly(&POLY.replace("2 2 5", "2 2 6"), &["m.poly:4: segment 2 has vertex 6"]);
    poly("0 2 0 1\n3 1\n1 1 2 1\n", &["m.poly:3: the file ends after 1 of 3 segments", "cut off"]);
    poly("0 2\n", &["m.poly:1: the file ends before the number of segments"]);
    let own = "6 2\n1 0 0\n2 0 0\n3 0 0\n4 0 0\n5 0 0\n6 0 0\n0\n";
    poly(own, &["m.poly:7: more vertices than the 5 of m.node", "files of one mesh"]);
    poly("0 3 0 1\n1 1\n", &["m.poly:1: the vertices have 3 coordinates", "TetGen"]);
}

#[test]
fn half_a_triangle_mesh_is_an_error() {
    let two = "A Triangle mesh is two files: put it beside";
    for (there, named) in [("m.node", "m.node"), ("m.node", "m.ele"), ("m.node", "m")] {
        let folder = Folder::new(&[(there, NODE)]);
        let error = MeshFile::read(&folder.path(named)).unwrap_err().to_string();
        assert!(error.contains("m.ele: not found. ") && error.contains(two), "{error}");
    }
    for named in ["m.node", "m.ele", "m"] {
        let folder = Folder::new(&[("m.ele", ELE)]);
        let error = MeshFile::read(&folder.path(named)).unwrap_err().to_string();
        assert!(error.contains("m.node: not found. ") && error.contains(two), "{error}");
    }
    assert_error(&[("m.txt", NODE)], &["m.txt: ", "without its triangles. Put m.ele beside it"]);
    assert_error(&[("m.poly", POLY)], &["m.poly: ", "Name the mesh itself"]);
}

#[test]
fn gmsh_errors_name_line_and_remedy() {
    let v2 = |from: &str, to: &str, parts: &[&str]| {
        assert!(GMSH22.contains(from), "{from}");
        assert_gmsh_error(&GMSH22.replacen(from, to, 1), parts);
    };
    v2(
        "2.2 0 8",
        "2.2 1 8",
        &["a.msh, byte 20: the byte-order mark is not the number 1 in either"],
    );
    v2("2.2 0 8", "2.2 2 8", &["a.msh:2: the file type is 2, neither 0 nor 1"]);
    v2("2.2 0 8", "3 0 8", &["a.msh:2: gmsh's format version 3 is not read. Save as version 4.1"]);
    v2(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat",
        "$Comments\n$EndComments",
        &["a.msh:7: no $MeshFormat"],
    );
    v2("$EndNodes\n", "", &["a.msh:8: $Nodes has no $EndNodes", "cut off"]);
    v2("$EndNodeData", "", &["a.msh:27: $NodeData has no $EndNodeData", "cut off"]);
    v2("$Nodes\n6", "$Nodes\n7", &["a.msh:16: the section ends after 6 of 7 nodes", "Correct"]);
    v2("$Nodes\n6", "$Nodes\n5", &["a.msh:15: $Nodes goes on after the 5 nodes it announces"]);
    v2("$Nodes\n6", "$Nodes\n99999999999", &["a.msh:9: 99999999999 vertices", "4294967295"]);
    v2("3 1 1 5\n", "4 1 1 5\n", &["a.msh:12: node 4 is listed a second time", "different tag"]);
    v2("3 1 1 5\n", "3 1 inf 5\n", &["a.msh:12: y of node 3 is `inf`, not a finite number"]);
    v2("3 1 1 5\n", "3 1 1\n", &["a.msh:12: z of node 3 is missing"]);
    v2("3 70 5\n", "3 71 5\n", &["a.msh:23: triangle 5 has node 71, which $Nodes does not list"]);
    v2("3 70 5\n", "3 5 5\n", &["a.msh:23: triangle 5 lists node 5 twice", "Remove"]);
    v2("5 2 2", "5 9 2", &["a.msh:23: element type 9 is of higher order", "Mesh.ElementOrder=1"]);
    v2("5 2 2", "5 4 2", &["a.msh:23: element type 4 makes this a volume mesh", "gmsh -2"]);
    v2("5 2 2", "5 99 2", &["a.msh:23: element type 99 is not known"]);
    v2("5 2 2 0 1", "5 2 2 0 sea", &["a.msh:23: a tag of element 5 is `sea`, not a whole number"]);
    v2("5 2 2", "5 2 999999999999", &["a.msh:23: element 5 announces 999999999999 tags"]);
    v2("$Elements\n7", "$Elements\n8", &["a.msh:26: the section ends after 7 of 8 elements"]);
    v2("$Elements\n7", "$Elements\nseven", &["a.msh:18: the number of elements is `seven`"]);
    v2("$NodeData", "$Nodes", &["a.msh:27: this is the second $Nodes section"]);
    let elements = GMSH22.find("$Elements").unwrap();
    assert_gmsh_error(
        &GMSH22[..elements],
        &["a.msh: it has no $Elements section", "save it again"],
    );
    let cut = |bytes: usize, part: &str| {
        assert_gmsh_error(&GMSH22[..elements + bytes], &[part, "The file is cut off"]);
    };
    cut(25, "a.msh:19: the file ends after 1 of 7 elements");
    cut(26, "a.msh:20: the type of element 2 is missing");

    let v4 = |from: &str, to: &str, parts: &[&str]| {
        assert!(GMSH41.contains(from), "{from}");
        assert_gmsh_error(&GMSH41.replacen(from, to, 1), parts);
    };
    v4("2 1 1 4", "2 1 1 5", &["a.msh:14: a block of 5 nodes where", "leaves 4"]);
    v4("2 1 1 4", "2 1 1 3", &["a.msh:18: y of node 9 is missing"]);
    v4("2 5 1 9", "2 6 1 9", &["a.msh:22: the blocks hold 5 of the 6 nodes"]);
    v4("2 5 1 9", "3 5 1 9", &["a.msh:23: the section ends after 2 of 3 node blocks"]);
    v4("9\n8\n", "9\n9\n", &["a.msh:20: node 9 is listed a second time"]);
    v4("2 1 2 4\n", "2 1 3 4\n", &["a.msh:29: a node of element 2 is missing"]);
    v4("2 1 2 4\n", "2 1 20 4\n", &["a.msh:28: element type 20 is of higher order"]);
    v4("2 1 2 4\n", "2 a 2 4\n", &["a.msh:28: the entity of an element block is `a`, not a whole"]);
    v4("$EndEntities", "", &["a.msh:4: $Entities has no $EndEntities", "cut off"]);
    v4("4 8 7 6", "4 8 8 6", &["a.msh:31: triangle 4 lists node 8 twice"]);
}

#[test]
fn files_of_formats_that_are_not_read_are_refused_by_name() {
    let formats = "Formats read: Triangle .node/.ele, gmsh, legacy VTK, ";
    assert_error(
        &[("a.stl", "solid part\n")],
        &["a.stl: an STL lists corners", "ReadOptions::weld"],
    );
    assert_error(&[("a.k", "*KEYWORD\n")], &["LS-DYNA is not read. Export the mesh "]);
    assert_error(&[("a.dat", "hello\n")], &["a.dat: the format is not recognized. ", formats]);
    let folder = Folder::new(&[("a.dat", "hello\n")]);
    let told = MeshFile::read(&folder.path("a.dat")).unwrap_err().to_string();
    for format in Format::ALL {
        assert!(told.contains(format.family()), "{format}: {told}");
    }
    let of = |path: &Path| MeshFile::read(path).unwrap_err().to_string();
    assert!(of(&folder.path("none.msh")).contains("none.msh: "));
    assert!(of(&folder.path("none.msh")).ends_with("Check the name"));
    assert!(of(folder.0.path()).ends_with("Name a mesh file, not a directory"));
}

#[test]
fn destinations_that_cannot_work_are_refused_and_left_alone() {
    let folder = triangle();
    fs::write(folder.path("a.msh"), GMSH41).unwrap();
    fs::write(folder.path("old.node"), "old").unwrap();
    fs::create_dir(folder.path("old.ele")).unwrap();
    fs::write(folder.path("locked"), "old").unwrap();
    let mut permissions = fs::metadata(folder.path("locked")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(folder.path("locked"), permissions).unwrap();
    let before = folder.count();
    let refused = |name: &str, out: &str, parts: &[&str]| {
        let file = folder.read(name);
        let check = file.check_destination(&folder.path(out)).unwrap_err().to_string();
        let write = file.write(&folder.path(out), file.points()).unwrap_err().to_string();
        assert_eq!(check, write);
        for part in parts {
            assert!(write.contains(part), "no {part:?} in {write:?}");
        }
    };
    let converted = "The format is kept: end the name in .node, or convert the mesh";
    refused("la.1", "out.msh", &["out.msh: ", "belongs to gmsh", "mesh is Triangle", converted]);
    refused("la.1", "out.vtk", &["belongs to legacy VTK", converted]);
    refused("la.1", "old.node", &["old.ele: is a directory", "Give the name of a file"]);
    refused("la.1", "", &["not the name of a file", "out.node"]);
    refused("a.msh", "out.ele", &["belongs to Triangle", "end the name in .msh"]);
    refused("a.msh", "none/out.msh", &["none: no such directory", "Create the directory first"]);
    refused("a.msh", "locked", &["locked: the file is read-only", "Make the file writable"]);
    assert_eq!(folder.text("old.node"), "old");
    assert_eq!(folder.text("locked"), "old");

    let file = folder.read("a.msh");
    let mut points = file.points().to_vec();
    points[3][1] = f64::NAN;
    let error = file.write(&folder.path("locked"), &points).unwrap_err().to_string();
    assert!(error.contains("vertex index 3 is (0, NaN)"), "{error}");
    let error = file.write(&folder.path("locked"), &points[1..]).unwrap_err().to_string();
    assert!(error.contains("4 points given for 5 vertices"), "{error}");
    assert_eq!(folder.count(), before);
}
