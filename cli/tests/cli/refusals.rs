//! Meshes that cannot be smoothed: exit code 1, one line with file, line and remedy, and OUT unchanged. An indented
//! list follows if several triangles are inverted or flat.

use super::{Folder, assert_holds, output::INVERTED, plate_path};
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

const NODE: &str = "5 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n5 0.25 0.5\n";
const ELE: &str = INVERTED[1];
const GMSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 1 1 0\n\
40 0 1 0\n50 0.25 0.5 0\n$EndNodes\n$Elements\n4\n7 2 2 0 1 10 20 50\n8 2 2 0 1 20 30 50\n\
9 2 2 0 1 30 40 50\n11 2 2 0 1 40 10 50\n$EndElements\n";
const TRIANGULATED: [(&str, &str); 2] = [("in.node", NODE), ("in.ele", ELE)];

/// Checks that smoothing `input` fails with all parts in the message, both without and with an existing OUT, which
/// must not change.
#[track_caller]
fn assert_refused(files: &[(&str, &str)], input: &str, parts: &[&str]) {
    let gmsh = input.ends_with(".msh");
    for old in [true, false] {
        let folder = Folder::new(files);
        let out = if gmsh { "out.msh" } else { "out.node" };
        if old {
            for name in [out, "out.ele", "r.json"] {
                fs::write(folder.path(name), "old\n").unwrap();
            }
        }
        let before = folder.content();
        // Existing files without a mesh are replaced only with --force.
        folder.run([input, out, "--engine", "cpu", "--force"]).refused(parts);
        assert!(folder.content() == before, "files have changed");
        let args = [input, out, "--engine", "cpu", "--force", "--report", "r.json"];
        let run = folder.run(args).refused(parts);
        // Only bad triangles are reported in several lines.
        let is_list = run.err.contains("inverted") || run.err.contains("flat");
        let others = |content: Vec<(PathBuf, Vec<u8>)>| -> Vec<_> {
            content.into_iter().filter(|(path, _)| !path.ends_with("r.json") || !is_list).collect()
        };
        assert!(others(folder.content()) == others(before), "files have changed");
        assert!(!is_list || folder.json("r.json")["triangles"].is_array());
    }
}

#[track_caller]
fn assert_triangle_refused(node: &str, ele: &str, parts: &[&str]) {
    assert_refused(&[("in.node", node), ("in.ele", ele)], "in.node", parts);
}

#[track_caller]
fn assert_gmsh_refused(from: &str, to: &str, parts: &[&str]) {
    assert!(GMSH.contains(from), "{from}");
    assert_refused(&[("in.msh", &GMSH.replacen(from, to, 1))], "in.msh", parts);
}

#[test]
fn meshes_of_these_tests_are_smoothed_before_they_are_spoiled() {
    let folder = Folder::new(&TRIANGULATED);
    let summary = folder.line("in.node out.node --engine cpu").clean().out;
    assert_holds(&summary, &["5 vertices (1 free, 1 color), 4 triangles\n"]);
    fs::write(folder.path("in.msh"), GMSH).unwrap();
    folder.line("in.msh out.msh --engine cpu").clean();
}

#[test]
fn missing_files_are_errors() {
    assert_refused(&TRIANGULATED[..1], "in.node", &["in.ele: not found", "put it beside in.node"]);
    assert_refused(&TRIANGULATED[1..], "in.ele", &["in.node: not found", "put it beside in.ele"]);
    assert_refused(&[], "none.msh", &["none.msh: ", "Check the name"]);
    assert_refused(&[], ".", &[".: ", "Name a mesh file, not a directory"]);
}

#[test]
fn truncated_files_are_errors() {
    assert_triangle_refused(
        &NODE[..20],
        ELE,
        &["in.node:3: the file ends after 2 of 5", "The file is cut off"],
    );
    assert_triangle_refused(
        NODE,
        &ELE[..22],
        &["in.ele:3: the file ends after 2 of 4 triangles", "The file is cut off"],
    );
    assert_triangle_refused("", ELE, &["in.node: the file is empty. Write the mesh again"]);
    let cut = GMSH.find("9 2 2").unwrap();
    assert_gmsh_refused(
        &GMSH[cut..],
        "",
        &["in.msh:15: the file ends after 2 of 4 elements", "The file is cut off"],
    );
    assert_gmsh_refused("$EndNodes\n", "", &["in.msh:4: $Nodes has no $EndNodes", "cut off"]);
}

#[test]
fn numbers_that_make_no_sense_are_errors() {
    assert_triangle_refused(
        NODE,
        &ELE.replace("2 2 3 5", "2 2 6 5"),
        &["in.ele:3: triangle 2 has vertex 6", "in.node has vertices 1 to 5"],
    );
    assert_triangle_refused(
        NODE,
        &ELE.replace("3 3 4 5", "3 3 3 5"),
        &["in.ele:4: triangle 3 lists vertex 3 twice", "Remove"],
    );
    assert_gmsh_refused(
        "20 30 50",
        "20 31 50",
        &["in.msh:15: triangle 8 has node 31, which $Nodes does not list"],
    );
    for nan in ["nan", "NaN", "inf", "1e999", "0,5"] {
        assert_triangle_refused(
            &NODE.replace("4 0 1", &format!("4 0 {nan}")),
            ELE,
            &[&format!("in.node:5: y of vertex 4 is `{nan}`, not a finite number"), "Correct"],
        );
    }
    assert_gmsh_refused("40 0 1", "40 0 nan", &["in.msh:9: y of node 40 is `nan`", "Correct"]);
}

#[test]
fn inverted_and_flat_triangles_are_counted_and_the_first_is_named() {
    let untangle = "Untangle the mesh first";
    let moved = |to: &str| NODE.replace("0.25 0.5", to);
    assert_triangle_refused(
        &moved("1.5 0.5"),
        ELE,
        &["in.ele:3: triangle 2 (vertices 2, 3, 5) is inverted. ", untangle],
    );
    assert_triangle_refused(
        &moved("1 0.5"),
        ELE,
        &["in.ele:3: triangle 2 (vertices 2, 3, 5) is flat. ", untangle],
    );
    assert_triangle_refused(
        &moved("1.5 1.25"),
        ELE,
        &[
            "error: in.ele: 2 triangles are inverted or flat. ",
            untangle,
            "\n  in.ele:3: triangle 2 (vertices 2, 3, 5) is inverted\n  in.ele:4: triangle 3 (vertices 3, 4, 5) is inverted\n",
        ],
    );
    // Vertices numbered from zero.
    let zero = "5 2\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n4 1.5 .5\n";
    let ele = "4 3\n0 0 1 4\n1 1 2 4\n2 2 3 4\n3 3 0 4\n";
    assert_triangle_refused(zero, ele, &["in.ele:3: triangle 1 (vertices 1, 2, 4) is inverted"]);
    assert_gmsh_refused(
        "50 0.25 0.5",
        "50 1.5 0.5",
        &["in.msh:15: triangle 8 (vertices 20, 30, 50) is inverted", untangle],
    );
    // All triangles are clockwise except one, which therefore counts as inverted.
    let clockwise = "4 3\n1 2 1 5\n2 3 2 5\n3 4 3 5\n4 1 4 5\n";
    assert_triangle_refused(&moved("0.5 -1"), clockwise, &["triangle 1 (vertices 2, 1, 5) is inv"]);
}

/// Returns a strip two squares wide, as a Triangle mesh and a gmsh mesh. In every eighth row, the middle vertex is
/// moved across its neighbors, which inverts triangles. In the rows halfway between, the middle vertex coincides with
/// a neighbor, which makes triangles flat.
fn folded(rows: usize) -> Folder {
    let mut mesh = support::lattice(2, rows);
    for row in (1..rows).step_by(4) {
        let middle = 3 * row + 1;
        let [x, y] = mesh.points[middle];
        mesh.points[middle] = if row % 8 == 1 { [x, y + 1.8] } else { mesh.points[middle + 1] };
    }
    let [node, ele] = support::triangle_text(&mesh, "folded");
    Folder::new(&[("in.node", &node), ("in.ele", &ele), ("in.msh", &support::write_msh22(&mesh))])
}

#[test]
fn all_inverted_and_flat_triangles_are_listed() {
    let folder = folded(60);
    let mesh = folder.mesh("in.node");
    let signs = support::orientations(&mesh);
    let bad: Vec<usize> = (0..signs.len()).filter(|&t| signs[t] != 1).collect();
    assert!(bad.len() > 20 && bad.len() < signs.len() / 2);
    assert!(signs.contains(&0) && signs.contains(&-1));

    for (input, out, list) in [("in.node", "out.node", "in.ele"), ("in.msh", "out.msh", "in.msh")] {
        let text = folder.text(list);
        let lines: Vec<Vec<u64>> = text
            .lines()
            .map(|line| line.split_whitespace().map_while(|word| word.parse().ok()).collect())
            .collect();
        // In both formats, the vertices are the last three numbers of a row.
        let row_of = |t: usize| {
            let vertices = mesh.triangles[t].map(|v| u64::from(v) + 1);
            lines.iter().position(|row| row.len() > 3 && row.ends_with(&vertices)).unwrap()
        };
        let report = |t: &usize| {
            let row = row_of(*t);
            let problem = if signs[*t] == 0 { "flat" } else { "inverted" };
            let vertices = mesh.triangles[*t].map(|v| v + 1);
            json!({
                "triangle": lines[row][0], "file": list, "line": row + 1, "vertices": vertices,
                "problem": problem,
            })
        };
        let expected: Vec<Value> = bad.iter().map(report).collect();
        let told: String = expected[..10]
            .iter()
            .map(|bad| {
                let [a, b, c] = [0, 1, 2].map(|i| &bad["vertices"][i]);
                let (triangle, line) = (&bad["triangle"], &bad["line"]);
                let problem = bad["problem"].as_str().unwrap();
                format!(
                    "\n  {list}:{line}: triangle {triangle} (vertices {a}, {b}, {c}) is {problem}"
                )
            })
            .collect();
        let more = bad.len() - 10;

        let run = folder.run([input, out, "--engine", "cpu", "--report", "r.json"]);
        let count = format!("error: {list}: {} triangles are inverted or flat. ", bad.len());
        let rest = format!("{told}\n  and {more} more; gpu-smooth quality --json lists all\n");
        let err = run.refused(&[&count, &rest]).err;
        let written = folder.json("r.json");
        let first_line = err.lines().next().unwrap().strip_prefix("gpu-smooth: error: ");
        assert_eq!(written["error"].as_str(), first_line);
        assert_eq!(written["triangles"], Value::from(expected.clone()));
        assert!(!folder.path(out).exists());

        let text = folder.run(["quality", input]).clean().out;
        let rest = format!(" {}{told}\n  and {more} more; --json lists all\n", bad.len());
        assert!(text.ends_with(&rest), "{text}");
        let json: Value =
            serde_json::from_str(&folder.run(["quality", input, "--json"]).clean().out).unwrap();
        assert_eq!(json["bad_triangles"], Value::from(expected));
    }
}

#[test]
fn meshes_without_a_free_vertex_are_errors() {
    assert_refused(
        &[("in.node", "3 2\n1 0 0\n2 1 0\n3 0 1\n"), ("in.ele", "1 3\n1 1 2 3\n")],
        "in.node",
        &["in.node: none of the 3 vertices is free to move", "nothing to smooth"],
    );
    assert_gmsh_refused(
        "4\n7 2 2",
        "5\n1 15 2 0 1 50\n7 2 2",
        &["in.msh: none of the 5 vertices is free to move"],
    );
}

#[test]
fn a_mesh_file_with_an_edge_of_three_triangles_is_an_error() {
    assert_triangle_refused(
        &NODE.replace("5 2 0 0", "6 2 0 0").replace("5 0.25 0.5", "5 0.25 0.5\n6 2 -1"),
        "6 3 0\n1 1 2 5\n2 2 3 5\n3 3 4 5\n4 4 1 5\n# two more\n5 2 1 6\n6 6 5 1\n",
        &["in.ele:8: the edge between vertices 1 and 5 belongs to 3 triangles (1, 4, 6)", "remove"],
    );
    assert_gmsh_refused(
        "4\n7 2 2",
        "5\n70 2 2 0 1 10 50 30\n7 2 2",
        &["the edge between vertices 10 and 50 belongs to 3 triangles (70, 7, 11)"],
    );
    assert_gmsh_refused(
        "4\n7 2 2 0 1 10 20 50",
        "5\n70 2 2 0 2 50 10 20\n7 2 2 0 1 10 20 50",
        &["Some of them have the same vertices: remove these"],
    );
}

#[test]
fn files_of_other_kinds_are_errors() {
    let elements = GMSH.find("4\n7 2 2").unwrap();
    assert_gmsh_refused(
        &GMSH[elements..],
        "1\n7 1 2 0 1 10 20\n$EndElements\n",
        &["in.msh: 5 vertices", "but no triangle. "],
    );
    assert_gmsh_refused(
        "2.2 0 8",
        "2.2 1 8",
        &["in.msh, byte 20: the byte-order mark is not the number 1 in either byte order. "],
    );
    assert_gmsh_refused("2 2 0 1 10", "4 2 0 1 10", &["in.msh:14: ", "makes this a volume mesh"]);
    assert_refused(&[("in.txt", "hello\n")], "in.txt", &["in.txt: the format is not recognized. "]);
    assert_refused(&[("in.stl", "solid part\n")], "in.stl", &["in.stl: an STL lists", "--weld"]);
    let deck = [("in.k", "*KEYWORD\n")];
    assert_refused(&deck, "in.k", &["in.k: LS-DYNA is not read. Export "]);
    let step = [("in.stp", "ISO-10303-21;\nHEADER;\n")];
    assert_refused(&step, "in.stp", &["is not read. Mesh it first, with gmsh for example"]);
    let upright = "v 0 5 0\nv 2 5 0\nv 1 5 3\nv 1 5 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let folder = Folder::new(&[("in.obj", upright)]);
    let remedy = "add --z coordinate if z is a coordinate";
    folder.line("in.obj out.obj --z data").refused(&["y of all vertices is 5, ", remedy]);
}

/// On a closed surface, untangling would take long and fail.
#[test]
fn closed_surfaces_are_refused_without_advice_to_untangle() {
    let vertices = "v 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n";
    let above = "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    let below = "f 2 1 6\nf 3 2 6\nf 4 3 6\nf 1 4 6\n";
    let sphere = format!("{vertices}{above}{below}");
    let folder = Folder::new(&[("in.obj", &sphere), ("cup.obj", &sphere.replace("f 1 4 6\n", ""))]);
    for arguments in ["in.obj out.obj --z data", "in.obj out.obj --z data --untangle"] {
        let run = folder.line(arguments).refused(&[
            "in.obj:7: triangle 1 belongs to a part of the mesh without boundary: a closed surface",
            "Only meshes of the plane of x and y are smoothed",
        ]);
        assert!(!run.err.contains("--untangle"), "{}", run.err);
    }
    // An open surface may also be a tangled mesh with heights.
    let hint = "But if this is a surface in space that folds over itself";
    folder.line("cup.obj out.obj --z data").refused(&["Untangle the mesh first: --untangle", hint]);
}

#[test]
fn quality_refuses_broken_files_with_the_same_messages() {
    let folder = Folder::new(&[("in.node", NODE), ("in.txt", "hello\n")]);
    folder.line("quality in.node").refused(&["in.ele: not found"]);
    folder.line("quality in.txt --json").refused(&["in.txt: the format is not recognized"]);
    folder.line("quality none").refused(&["none: ", "Check the name"]);
    let outline = plate_path().with_extension("outline");
    folder.run(["quality".as_ref(), outline.as_os_str()]).refused(&["plate.outline: "]);
}
