//! The commands in README.md and docs/.

use super::{Folder, assert_holds, finish};
use gpu_smooth::Mesh;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Returns the lines of every `sh` block of a document, one list for each block. Comments are left out.
fn blocks(document: &str) -> Vec<Vec<String>> {
    let mut blocks: Vec<Vec<String>> = Vec::new();
    let mut is_inside = false;
    for line in document.lines().map(str::trim) {
        match line {
            "```sh" => {
                blocks.push(Vec::new());
                is_inside = true;
            }
            "```" => is_inside = false,
            _ if is_inside => {
                let command = line.split(" #").next().unwrap_or_default().trim();
                if !command.is_empty() && !command.starts_with('#') {
                    blocks.last_mut().unwrap().push(command.to_owned());
                }
            }
            _ => {}
        }
    }
    blocks
}

/// Returns README.md and the files of docs/ with the lines of their `sh` blocks.
fn documents() -> Vec<(PathBuf, Vec<Vec<String>>)> {
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let is_text = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "md");
    let mut paths: Vec<PathBuf> = docs.filter(is_text).collect();
    paths.push(root().join("README.md"));
    paths.sort();
    paths
        .into_iter()
        .map(|path| (path.clone(), blocks(&fs::read_to_string(path).unwrap())))
        .collect()
}

/// Vertices of a lattice: columns and rows.
const COUNTS: [usize; 2] = [9, 7];

/// Returns a lattice of squares, each cut in two, whose inner vertices are displaced by `share` of an edge.
fn lattice(share: f64) -> Mesh {
    let [columns, rows] = COUNTS;
    let mut rng = support::SplitMix64::new(3);
    let mut point = |v: usize| {
        let (column, row) = (v % columns, v / columns);
        let is_inside = (1..columns - 1).contains(&column) && (1..rows - 1).contains(&row);
        let mut coordinate = |at: usize| match is_inside {
            true => at as f64 + rng.range(-share, share),
            false => at as f64,
        };
        [coordinate(column), coordinate(row)]
    };
    let points = (0..columns * rows).map(&mut point).collect();
    let squares = (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |k| columns * row + k));
    let halves = |a: usize| [[a, a + 1, a + columns + 1], [a, a + columns + 1, a + columns]];
    let triangles = squares.flat_map(halves).map(|t| t.map(|v| v as u32)).collect();
    Mesh { points, triangles, ..Mesh::default() }
}

/// Returns a lattice as a file of gmsh with the groups and the data that the documented commands name.
fn gmsh(mesh: &Mesh) -> String {
    let [columns, rows] = COUNTS;
    let side = |from: usize, step: usize, count: usize| {
        (0..count).map(move |k| [from + k * step, from + (k + 1) * step])
    };
    let lines = [
        ("inlet", side(0, columns, 2).collect::<Vec<_>>()),
        ("airfoil", side(2 * columns, columns, rows - 3).collect()),
        ("farfield", side(columns - 1, columns, rows - 1).collect()),
        ("lower", side(0, 1, columns - 1).collect()),
        ("upper", side(columns * (rows - 1), 1, columns - 1).collect()),
    ];
    let mut text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n7\n2 3 \"steel\"\n2 4 \"air\"\n"
            .to_owned();
    for (tag, (name, _)) in (5..).zip(&lines) {
        writeln!(text, "1 {tag} \"{name}\"").unwrap();
    }
    writeln!(text, "$EndPhysicalNames\n$Nodes\n{}", mesh.points.len()).unwrap();
    for (tag, [x, y]) in (1..).zip(&mesh.points) {
        writeln!(text, "{tag} {x:?} {y:?} 0").unwrap();
    }
    let edges: usize = lines.iter().map(|(_, edges)| edges.len()).sum();
    writeln!(text, "$EndNodes\n$Elements\n{}", edges + mesh.triangles.len()).unwrap();
    let mut element = 0;
    for (tag, (_, edges)) in (5..).zip(&lines) {
        for [a, b] in edges {
            element += 1;
            writeln!(text, "{element} 1 2 {tag} {tag} {} {}", a + 1, b + 1).unwrap();
        }
    }
    for (t, [a, b, c]) in mesh.triangles.iter().enumerate() {
        let tag = if t < mesh.triangles.len() / 2 { 3 } else { 4 };
        writeln!(text, "{} 2 2 {tag} {tag} {} {} {}", element + t + 1, a + 1, b + 1, c + 1)
            .unwrap();
    }
    text += "$EndElements\n$NodeData\n1\n\"depth\"\n1\n0\n3\n0\n1\n";
    writeln!(text, "{}", mesh.points.len()).unwrap();
    for (tag, [x, y]) in (1..).zip(&mesh.points) {
        writeln!(text, "{tag} {:?}", x + 2.0 * y).unwrap();
    }
    text + "$EndNodeData\n"
}

/// Returns a square of 8 times 8 quadrilaterals as a legacy VTK file. The vertex in the middle is off by `share` of an edge
/// in both directions.
fn quadrilaterals(share: f64) -> String {
    let mut text =
        "# vtk DataFile Version 3.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 81 double\n"
            .to_owned();
    for v in 0..81 {
        let off = if v == 40 { share } else { 0.0 };
        writeln!(text, "{} {} 0", f64::from(v % 9) + off, f64::from(v / 9) + off).unwrap();
    }
    text += "CELLS 64 320\n";
    for k in 0..64 {
        let a = k / 8 * 9 + k % 8;
        writeln!(text, "4 {a} {} {} {}", a + 1, a + 10, a + 9).unwrap();
    }
    text + "CELL_TYPES 64\n" + &"9\n".repeat(64)
}

/// Makes a folder with all files that the documented commands name.
fn original() -> Folder {
    // Commands for coasts improve bad triangles; thresholds need a mesh without bad triangles.
    let (mild, strong) = (gmsh(&lattice(0.1)), gmsh(&lattice(0.45)));
    let folder = Folder::new(&[
        ("in.msh", &mild),
        ("part.msh", &mild),
        ("coast.msh", &strong),
        ("gauges.txt", "20\n21\n"),
    ]);
    for (from, to) in [
        ("part.msh", "part.mesh"),
        ("part.msh", "wing.su2"),
        ("part.msh", "sector.su2"),
        ("coast.msh", "coast.gr3"),
        ("part.msh", "part.vtk"),
    ] {
        let run = folder.line(&format!("convert {from} {to} --lossy"));
        assert_eq!(run.code, Some(0), "{}", run.err);
    }
    let count = COUNTS[0] * COUNTS[1];
    let fixed = "0\n".repeat(count - 1) + "1\n";
    let mut vtk = folder.text("part.vtk");
    let data =
        vtk.find("POINT_DATA").map_or(vtk.len(), |at| vtk[at..].find('\n').unwrap() + at + 1);
    let scalars = format!("SCALARS fixed int 1\nLOOKUP_TABLE default\n{fixed}");
    match data == vtk.len() {
        true => vtk += &format!("POINT_DATA {count}\n{scalars}"),
        false => vtk.insert_str(data, &scalars),
    }
    fs::write(folder.path("part.vtk"), vtk).unwrap();
    fs::write(folder.path("block.vtk"), quadrilaterals(0.3)).unwrap();
    fs::write(folder.path("tangled.vtk"), quadrilaterals(0.8)).unwrap();
    folder
}

#[test]
fn every_documented_command_of_the_program_succeeds() {
    let original = original();
    let bin = Path::new(env!("CARGO_BIN_EXE_gpu-smooth")).parent().unwrap().to_owned();
    let path = std::env::join_paths(
        [bin].into_iter().chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
    )
    .unwrap();
    let mut count = 0;
    for (document, blocks) in documents() {
        for block in blocks {
            let folder = original.copy();
            for line in block.iter().filter(|line| line.starts_with("gpu-smooth ")) {
                let out = if line.starts_with("gpu-smooth convert") { "out.e" } else { "out.msh" };
                let line = line
                    .replace("IN OUT", &format!("in.msh {out}"))
                    .replace("[MESH]", "in.msh")
                    .replace("MESH...", "in.msh part.msh")
                    .replace("MESH", "in.msh");
                let mut command = Command::new("sh");
                command.current_dir(folder.path(".")).env("PATH", &path);
                command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
                let run = finish(command.args(["-c", &line]));
                assert_eq!(run.code, Some(0), "{}: {line}\n{}", document.display(), run.err);
                count += 1;
            }
        }
    }
    assert!(count > 30, "only {count} commands");
}

/// Returns the word after `option` in a command line.
fn argument<'a>(line: &'a str, option: &str) -> Option<&'a str> {
    line.split_whitespace().skip_while(|word| *word != option).nth(1)
}

#[test]
fn every_documented_command_of_a_clone_names_a_target_or_a_file_of_the_clone() {
    let mut count = 0;
    for (document, blocks) in documents() {
        for line in blocks.iter().flatten().filter(|line| !line.starts_with("gpu-smooth ")) {
            let place = format!("{}: {line}", document.display());
            let program = line.split_whitespace().next().unwrap();
            match program {
                "cargo" => {
                    let package = argument(line, "-p").map(|package| match package {
                        "gpu-smooth-cli" => "cli",
                        "mesh-io" => "mesh-io",
                        other => panic!("{place}: no package {other}"),
                    });
                    for (option, own) in [("--bench", "benches"), ("--example", "examples")] {
                        if let Some(name) = argument(line, option) {
                            let manifest = root().join(package.unwrap_or(own)).join("Cargo.toml");
                            let manifest = fs::read_to_string(manifest).unwrap();
                            assert_holds(&manifest, &[&format!("name = \"{name}\"")]);
                        }
                    }
                }
                // Standard programs, and a compiler's target that is installed on demand.
                "rustup" | "python3" => {}
                "node" => {
                    assert!(root().join(argument(line, "node").unwrap()).is_file(), "{place}")
                }
                "pip" => {
                    let folder = root().join(argument(line, "install").unwrap());
                    assert!(folder.join("pyproject.toml").is_file(), "{place}");
                }
                _ => assert!(root().join(program).is_file(), "{place}"),
            }
            count += 1;
        }
    }
    assert!(count > 10, "only {count} commands");
}
