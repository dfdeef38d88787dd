//! Thresholds of edges and vertices, and profiles of solvers.

use super::{Folder, Run, assert_holds, finish, number};
use serde_json::Value;

/// A quadrilateral around a vertex of four triangles, with an obtuse triangle at its lower edge. Triangles are elements 1 to
/// 4 of the file, and vertex `n` is on line 2 + `n`.
const QUADRILATERAL: &str = "flat
4 5
1 0 0 1
2 4 0 1
3 4 3 1
4 0 3 1
5 2 0.5 1
1 3 1 2 5
2 3 2 3 5
3 3 3 4 5
4 3 4 1 5
0
0
0
0
";

fn quadrilateral() -> Folder {
    Folder::new(&[("in.14", QUADRILATERAL)])
}

fn quality(folder: &Folder, options: &[&str]) -> Run {
    finish(folder.command().args(["quality", "in.14"]).args(options))
}

#[test]
fn a_threshold_of_edges_counts_edges_and_names_the_ends_of_the_worst() {
    let folder = quadrilateral();
    let run = quality(&folder, &["--threshold", "orthogonality>0.3", "--summary"]);
    assert_eq!(run.code, Some(1));
    // The center of the lower triangle is the middle of the lower edge, (2, 0), and that of the right triangle is (3, 1.5)
    // moved into the triangle: both edges from the bottom to vertex 5 are equally far from orthogonal.
    let told = "in.14: failed: 2 of 4 edges have orthogonality>0.3; the worst is the edge between vertices ";
    assert_holds(&run.out, &[told, "and 5 (lines ", " of in.14), orthogonality 0."]);
    let told: Value =
        serde_json::from_str(&quality(&folder, &["--threshold", "flow-link<9", "--json"]).out)
            .unwrap();
    let threshold = &told["thresholds"][0];
    assert_eq!((&threshold["threshold"], &threshold["edges"]), (&"flow-link<9".into(), &4.into()));
    assert!(threshold["triangles"].is_null(), "{threshold}");
    let worst = &threshold["worst"];
    let ends: Vec<u64> =
        worst["vertices"].as_array().unwrap().iter().map(|v| v.as_u64().unwrap()).collect();
    assert!(ends[0] < ends[1] && ends[1] == 5, "{worst}");
    assert_eq!(worst["lines"], Value::from(vec![ends[0] + 2, ends[1] + 2]));
    assert!(number(&worst["value"]) < 9.0);
}

#[test]
fn a_threshold_of_neighbors_counts_vertices_and_leaves_out_the_boundary_for_small_numbers() {
    let folder = quadrilateral();
    let run = quality(&folder, &["--threshold", "neighbors<5", "--threshold", "neighbors>3"]);
    assert_eq!(run.code, Some(1));
    let place = "the worst is vertex 5 (in.14:7), neighbors 4";
    let few = format!("in.14: failed: 1 of 1 vertices have neighbors<5; {place}\n");
    let many = format!("in.14: failed: 1 of 5 vertices have neighbors>3; {place}\n");
    assert_holds(&run.out, &[&few, &many]);
    quality(&folder, &["--threshold", "neighbors<4", "--threshold", "neighbors>4"]).clean();
    let json = quality(&folder, &["--threshold", "neighbors<5", "--json"]).out;
    let told: Value = serde_json::from_str(&json).unwrap();
    let threshold = &told["thresholds"][0];
    assert_eq!((&threshold["vertices"], &threshold["worst"]["vertex"]), (&1.into(), &5.into()));
}

#[test]
fn a_threshold_of_boundary_corners_finds_triangles_with_all_corners_on_the_boundary() {
    let folder = quadrilateral();
    quality(&folder, &["--threshold", "boundary-corners>=3"]).clean();
    let cut = QUADRILATERAL.replace("3 3 3 4 5\n4 3 4 1 5\n", "3 3 3 1 5\n4 3 4 1 3\n");
    let folder = Folder::new(&[("in.14", &cut)]);
    let run = quality(&folder, &["--threshold", "boundary-corners>=3", "--summary"]);
    let told = "1 of 4 triangles have boundary-corners>=3; the worst is triangle 4 (in.14:11), boundary-corners 3";
    assert_holds(&run.out, &[told]);
}
