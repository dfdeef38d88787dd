//! The command `gpu-smooth compare`: statements proved from two files, and differences found.

use super::{Folder, assert_holds, disturbed, small};
use std::fs;

/// Returns the words in the row of a vertex in a `.node`.
fn words(text: &str, vertex: usize) -> Vec<&str> {
    let is_vertex = |row: &&str| !row.starts_with('#') && !row.trim().is_empty();
    text.lines().filter(is_vertex).nth(vertex + 1).unwrap().split_whitespace().collect()
}

/// Returns the text with a new x for one vertex. Blanks in the row are kept.
fn with_x(text: &str, vertex: usize, x: &str) -> String {
    let old = words(text, vertex)[1];
    let row = text.lines().find(|row| row.split_whitespace().eq(words(text, vertex))).unwrap();
    text.replacen(row, &row.replacen(old, x, 1), 1)
}

#[test]
fn a_smoothed_mesh_differs_in_coordinates_only() {
    let folder = small();
    folder.line("in.node out.node --engine cpu").clean();
    let told = folder.line("compare in.node out.node").clean().out;
    assert_holds(
        &told,
        &[
            "only coordinates differ: 63 of 99 vertices have moved\n",
            "every vertex that must stay has the same bits; none of 160 triangles is inverted or flat\n",
            "the farthest has moved by ",
            "out.node:",
        ],
    );
    let told = folder.line("compare in.node in.node").clean().out;
    assert_holds(&told, &["0 of 99 vertices have moved\n"]);
}

#[test]
fn compare_finds_any_other_change() {
    let folder = small();
    let [node, ele] = ["in.node", "in.ele"].map(|name| folder.text(name));
    let changed = |node: &str, ele: &str| {
        fs::write(folder.path("b.node"), node).unwrap();
        fs::write(folder.path("b.ele"), ele).unwrap();
        folder.line("compare in.node b.node")
    };
    let comment = node.replace("made for a test", "made for the test");
    changed(&comment, &ele).refused(&["in.node:", "differ in more than coordinates", "for the"]);
    changed(&format!("{node}# end\n"), &ele).refused(&["the end of the file"]);
    let turned = ele.lines().last().unwrap();
    let row: Vec<_> = turned.split_whitespace().collect();
    let other = format!("{} {} {} {}", row[0], row[2], row[3], row[1]);
    changed(&node, &ele.replace(turned, &other)).refused(&["the triangles are not the same"]);
}

#[test]
fn vertices_that_must_stay_and_inverted_triangles_are_found() {
    let folder = small();
    let [node, ele] = ["in.node", "in.ele"].map(|name| folder.text(name));
    fs::write(folder.path("b.ele"), ele).unwrap();
    // A corner of the lattice moves by the smallest amount that a double can hold.
    let x: f64 = words(&node, 0)[1].parse().unwrap();
    let next = f64::from_bits(x.to_bits() + 1);
    fs::write(folder.path("b.node"), with_x(&node, 0, &format!("{next:?}"))).unwrap();
    let label = words(&node, 0)[0];
    folder.line("compare in.node b.node").refused(&[
        "b.node: 1 vertex has moved that must not\n",
        "b.node:",
        &format!(": vertex {label}"),
    ]);
    // A vertex inside moves far out of its patch.
    let inner = 4 * 11 + 5;
    fs::write(folder.path("b.node"), with_x(&node, inner, "1000.5")).unwrap();
    let run = folder.line("compare in.node b.node");
    run.refused(&["b.node: ", "triangles are inverted or flat\n", "b.ele:", ": triangle "]);
}

#[test]
fn compare_lets_interfaces_move_with_the_option_for_it() {
    let mesh = disturbed();
    let half = mesh.triangles.len() / 2;
    let regions: Vec<_> = (0..mesh.triangles.len()).map(|t| [i32::from(t < half), 7]).collect();
    for files in support::write_regions(&mesh, &regions) {
        let folder = Folder::new(&[]);
        for (name, bytes) in &files {
            fs::write(folder.path(name), bytes).unwrap();
        }
        let input = files[0].0;
        let output = input.replace("in", "out");
        folder.run([input, &output, "--engine", "cpu", "--free-interfaces"]).clean();
        folder.run(["compare", input, &output]).refused(&["9 vertices have moved that must not"]);
        folder.run(["compare", input, &output, "--free-interfaces"]).clean();
    }
}

/// A terminal would execute control characters.
#[cfg(unix)]
#[test]
fn control_characters_of_names_are_escaped_on_standard_output() {
    let folder = super::small();
    let name = "a\u{1b}]0;title\u{7}.node";
    for ending in ["node", "ele"] {
        let from = folder.path(&format!("in.{ending}"));
        fs::copy(from, folder.path(&name.replace("node", ending))).unwrap();
    }
    let runs = [
        folder.run(["quality", name]),
        folder.run(["quality", name, "in.node"]),
        folder.run(["compare", name, "in.node"]),
        folder.run(["groups", name]),
        folder.run(["convert", name, "out\u{1b}[2J.vtk"]),
    ];
    for run in runs {
        assert_eq!(run.code, Some(0), "{}", run.err);
        let is_escaped = !run.out.contains(['\u{1b}', '\u{7}']);
        assert!(is_escaped && run.out.contains("\\u{1b}"), "{:?}", run.out);
    }
}

/// In a pipe, data for programs contain the names unchanged.
#[cfg(target_os = "linux")]
#[test]
fn control_characters_of_names_in_a_table_for_programs_are_escaped_on_a_terminal() {
    let folder = super::small();
    let name = "a\u{1b}[31mb.node";
    for ending in ["node", "ele"] {
        let from = folder.path(&format!("in.{ending}"));
        fs::copy(from, folder.path(&name.replace("node", ending))).unwrap();
    }
    let program = env!("CARGO_BIN_EXE_gpu-smooth");
    for line in [format!("quality {name} --csv"), format!("{name} --out-dir d --csv --engine cpu")]
    {
        let in_pipe = folder.run(line.split(' '));
        assert!(in_pipe.out.contains(name), "{:?}", in_pipe.out);
        let shell = format!("{program} {} 2>/dev/null", line.replace(name, &format!("'{name}'")));
        let mut command = std::process::Command::new("script");
        command.args(["-qec", &shell, "/dev/null"]).current_dir(&folder.0);
        let output = command.stdin(std::process::Stdio::null()).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(!text.contains('\u{1b}') && text.contains("a\\u{1b}[31mb"), "{text:?}");
    }
}

#[test]
fn files_of_two_formats_are_compared_by_positions_and_triangles() {
    let folder = small();
    for name in ["same.msh", "same.vtk"] {
        folder.line(&format!("convert in.node {name} --lossy -q")).clean();
        let told = folder.line(&format!("compare in.node {name}")).clean().out;
        assert_holds(&told, &["neither groups nor other data", "0 of 99 vertices have moved"]);
    }
    folder.line("in.node out.vtk --engine cpu --quiet").clean();
    for pair in ["in.node out.vtk", "same.msh out.vtk", "out.vtk in.node"] {
        let told = folder.line(&format!("compare {pair}")).clean().out;
        assert_holds(
            &told,
            &["the elements are the same", "of 99 vertices have moved", "farthest"],
        );
    }
    // A vertex of the boundary moves, and then a triangle is missing.
    let text = folder.text("same.vtk");
    let first = text.lines().position(|line| line.starts_with("POINTS")).unwrap() + 1;
    let mut lines: Vec<&str> = text.lines().collect();
    lines[first] = "0.001 0.002 0";
    fs::write(folder.path("other.vtk"), lines.join("\n")).unwrap();
    let run = folder.line("compare in.node other.vtk");
    assert_eq!(run.code, Some(1), "{}", run.err);
    assert_holds(&run.err, &["1 vertex has moved that must not"]);
    let mesh = folder.mesh("in.node");
    let fewer = gpu_smooth::Mesh { triangles: mesh.triangles[1..].to_vec(), ..mesh };
    fs::write(folder.path("fewer.msh"), support::write_msh22(&fewer)).unwrap();
    let run = folder.line("compare in.node fewer.msh");
    assert_eq!(run.code, Some(1), "{}", run.err);
    assert_holds(&run.err, &["the triangles are not the same"]);
}
