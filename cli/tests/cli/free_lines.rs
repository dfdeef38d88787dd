//! Files that list all edges of a mesh as lines, and `--free-lines`.

use super::dry_run::count;
use super::{Folder, assert_holds, disturbed};
use gpu_smooth::Mesh;
use std::fmt::Write;
use support::check;

/// Returns a mesh as a gmsh file, with all edges as lines without a group if `has_lines`.
pub(super) fn msh(mesh: &Mesh, has_lines: bool) -> String {
    let text = support::write_msh22(mesh);
    if !has_lines {
        return text;
    }
    let edges = check::edge_uses(mesh);
    let (nodes, triangles) = text.split_once("$Elements\n").unwrap();
    let (count, triangles) = triangles.split_once('\n').unwrap();
    let count: usize = count.parse().unwrap();
    let mut lines = String::new();
    for (number, [a, b]) in (count + 1..).zip(edges.keys()) {
        writeln!(lines, "{number} 1 0 {} {}", a + 1, b + 1).unwrap();
    }
    format!("{nodes}$Elements\n{}\n{lines}{triangles}", count + edges.len())
}

fn folder() -> Folder {
    let mesh = disturbed();
    Folder::new(&[("in.msh", &msh(&mesh, true)), ("bare.msh", &msh(&mesh, false))])
}

#[test]
fn a_file_with_all_edges_as_lines_is_refused_with_the_reasons_and_the_option() {
    let folder = folder();
    let inner = support::mover_count(&disturbed());
    let reasons = format!(
        "in.msh: none of the 99 vertices is free to move: {} on the boundary, {inner} on lines of the file. \
         Let vertices on lines move: --free-lines",
        99 - inner
    );
    for options in ["", "--dry-run"] {
        let run = folder.line(&format!("in.msh out.msh --engine cpu {options}"));
        run.refused(&[&reasons]);
    }
    let sliding = folder.line("in.msh out.msh --engine cpu --slide");
    sliding.refused(&[", and no vertex can slide", &format!("{inner} on lines"), "--free-lines"]);
    let text = folder.line("in.msh out.msh --engine cpu --dry-run --free-lines").clean().out;
    assert_holds(&text, &[&format!("up to {inner} vertices would move")]);
    assert_eq!(count(&text, "on the boundary"), 99 - inner);
    assert!(!text.contains("on lines"), "{text}");
}

#[test]
fn freed_lines_move_as_if_the_file_had_none() {
    for options in ["", "--slide", "--only-bad 1.2", "--fix-box -1,-1,5,9"] {
        let folder = folder();
        let line = |input: &str, more: &str| {
            let run = folder.line(&format!(
                "{input}.msh {input}-out.msh --engine cpu --quiet {options} {more}"
            ));
            assert_eq!(run.code, Some(0), "{options}: {}", run.err);
            folder.mesh(&format!("{input}-out.msh")).points
        };
        let (bare, freed) = (line("bare", ""), line("in", "--free-lines"));
        assert_eq!(bare, freed, "{options}");
        assert_ne!(freed, folder.mesh("in.msh").points);
        let compare = format!("compare in.msh in-out.msh {options}");
        folder.line(&format!("{compare} --free-lines --quiet")).clean();
        let run = folder.line(&compare);
        assert_eq!(run.code, Some(1), "{options}: {}", run.err);
        assert_holds(&run.err, &["moved that must not", "give --free-lines here too"]);
    }
}

#[test]
fn a_dry_run_counts_vertices_on_lines_on_points_and_in_layers_apart() {
    let mesh = disturbed();
    // A line of two edges, with a point in its middle, which is the vertex 38.
    let text = support::write_msh22(&mesh).replace("$Elements\n160\n", "$Elements\n163\n");
    let lines = "161 1 2 7 7 37 38\n162 1 2 7 7 38 39\n163 15 2 8 8 38\n$EndElements\n";
    let folder = Folder::new(&[("in.msh", &text.replace("$EndElements\n", lines))]);
    let run = |options: &str| {
        folder.line(&format!("in.msh out.msh --dry-run --engine cpu {options}")).out
    };
    let plain = run("");
    assert_eq!(count(&plain, "on lines of the file (--free-lines lets them move)"), 2);
    assert_eq!(count(&plain, "on points or elements of the file other than lines"), 1);
    assert!(!plain.contains("in boundary layers"), "{plain}");
    let freed = run("--free-lines");
    assert!(!freed.contains("on lines"), "{freed}");
    assert_eq!(count(&freed, "on points or elements of the file other than lines"), 1);
    let kept = run("--free-lines --keep-layers within=0.7 --fix-box -9,-9,2,9");
    let counts = ["in boundary layers (--keep-layers none", "by options such as --fix"];
    let [layers, options] = counts.map(|words| count(&kept, words));
    let boundary = count(&kept, "on the boundary");
    assert!(layers > 0 && options > 0, "{kept}");
    assert_eq!(count(&kept, "vertices are not free:"), boundary + 1 + layers + options, "{kept}");
}
