//! Untangling: `--untangle` untangles meshes with inverted triangles, which are refused otherwise.

use super::{Folder, assert_holds, disturbed};
use gpu_smooth::{Mesh, Metric};
use std::fs;
use support::{boundaries, check};

fn folder(mesh: &Mesh) -> Folder {
    let folder = Folder::new(&[]);
    let [node, ele] = support::triangle_text(mesh, "tangled");
    fs::write(folder.path("in.node"), node).unwrap();
    fs::write(folder.path("in.ele"), ele).unwrap();
    folder
}

/// Returns the small mesh with all free vertices at one position.
pub(crate) fn tangled() -> Mesh {
    let mut mesh = disturbed();
    let held = check::held(&mesh);
    let free = mesh.points.iter_mut().zip(held).filter(|(_, held)| !held);
    free.for_each(|(p, _)| *p = [4.0, 3.0]);
    mesh
}

#[test]
fn a_tangled_mesh_is_refused_with_the_option_that_mends_it() {
    let folder = folder(&tangled());
    folder.line("in.node out.node").refused(&["inverted or flat", "--untangle"]);
    assert!(!folder.path("out.node").exists());

    let run = folder.line("in.node out.node --untangle --engine cpu --report run.json").clean();
    assert_holds(&run.out, &["\nuntangled ", " inverted or flat triangles in ", "converged"]);
    let (before, after) = (folder.mesh("in.node"), folder.mesh("out.node"));
    assert!(check::is_valid(&after));
    let held = check::held(&before);
    let all = before.points.iter().zip(&after.points).zip(held);
    assert!(all.clone().all(|((was, is), held)| !held || was == is));
    let report: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path("run.json")).unwrap()).unwrap();
    let moved = all.filter(|((was, is), _)| was != is).count();
    assert_eq!(report["untangled"]["moved"], moved);
    assert_eq!(report["after"]["inverted"], 0);
    let proof = folder.line("compare in.node out.node");
    assert_eq!(proof.code, Some(0), "{}{}", proof.out, proof.err);
}

/// The majority of the triangles then has the wrong orientation.
#[test]
fn a_mesh_with_more_than_half_of_its_triangles_inverted_is_proved_to_be_mended() {
    let mut mesh = support::lattice(14, 14);
    let held = check::held(&mesh);
    for (point, _) in mesh.points.iter_mut().zip(held).filter(|(_, held)| !held) {
        // The lattice is 14 wide; its inside is mirrored.
        point[0] = 14.0 - point[0];
    }
    let folder = folder(&mesh);
    let run = folder.line("in.node out.node --untangle --engine cpu --report run.json").clean();
    assert_holds(&run.out, &["\nuntangled ", "\ninverted ", "           0\n"]);
    let report: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path("run.json")).unwrap()).unwrap();
    let bad = report["untangled"]["bad_before"].as_u64().unwrap_or_default();
    assert!(2 * bad > mesh.triangles.len() as u64, "{report}");
    assert_eq!(report["certificate"]["inverted"], 0);
    folder.line("compare in.node out.node").clean();
}

#[test]
fn a_sound_mesh_is_smoothed_as_without_the_option() {
    let folder = folder(&disturbed());
    folder.line("in.node plain.node --engine cpu").clean();
    let run = folder.line("in.node out.node --engine cpu --untangle").clean();
    assert!(!run.out.contains("untangled"), "{}", run.out);
    let read = |name: &str| fs::read(folder.path(name)).unwrap();
    assert_eq!(read("plain.node"), read("out.node"));
}

#[test]
fn triangles_that_double_precision_cannot_judge_are_opened_with_the_option() {
    let folder = folder(&support::disturb::beyond_double_precision());
    let refused = folder.line("in.node out.node --engine cpu");
    refused.refused(&["is too flat", "for double precision", "--untangle"]);
    let run = folder.line("in.node out.node --engine cpu --untangle").clean();
    assert_holds(
        &run.out,
        &[
            "\nuntangled 1 inverted or flat triangle in ",
            "\ninverted                 0           0\n",
        ],
    );
}

/// Returns a mesh with a triangle of the given size at a corner of the unit square, with a vertex inside.
fn with_speck(size: f64) -> Mesh {
    let points = vec![
        [0.0, 0.0],
        [size, 0.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [0.5 * size, size],
        [0.5, 0.4],
    ];
    let triangles =
        vec![[0, 1, 5], [1, 2, 6], [2, 3, 6], [3, 4, 6], [4, 0, 5], [4, 5, 6], [5, 1, 6]];
    Mesh { points, triangles, ..Mesh::default() }
}

#[test]
fn a_mesh_that_a_metric_cannot_judge_is_refused_with_the_metrics_that_can() {
    let mut refused = 0;
    for mesh in
        [with_speck(1e-310), with_speck(1e-160), support::disturb::beyond_double_precision()]
    {
        let folder = folder(&mesh);
        let run = |metric: &str| {
            folder.line(&format!("in.node out.node --engine cpu --force --scheme {metric}"))
        };
        let runs: Vec<_> =
            Metric::ALL.iter().map(|metric| (metric.name(), run(metric.name()))).collect();
        let able = runs.iter().filter(|(_, run)| run.code == Some(0)).map(|(name, _)| *name);
        let able: Vec<_> = able.collect();
        for (_, run) in runs.iter().filter(|(_, run)| run.err.contains("cannot judge it")) {
            refused += 1;
            match &able[..] {
                [] => assert!(!run.err.contains("--scheme"), "{}", run.err),
                [one] => assert_holds(&run.err, &[&format!("The metric {one} can")]),
                _ => assert_holds(&run.err, &[&format!("The metrics {} can", able.join(", "))]),
            }
        }
    }
    assert!(refused > Metric::ALL.len());
}

#[test]
fn a_tangle_that_remains_is_listed_and_written_only_if_asked_for() {
    // Reverses a triangle that has no free vertex.
    let mut mesh = tangled();
    let held = check::held(&mesh);
    let lone = mesh.triangles.iter().position(|t| t.iter().all(|&v| held[v as usize])).unwrap();
    let [v, a, b] = mesh.triangles[lone].map(|v| v as usize);
    let [p, q, r] = [v, a, b].map(|v| mesh.points[v]);
    mesh.points[v] = [0, 1].map(|i| 1.05 * (q[i] + r[i]) - 1.1 * p[i]);
    let folder = folder(&mesh);
    let parts = &["1 triangle cannot be mended by moving vertices", "is inverted"];
    folder.line("in.node out.node --untangle").refused(parts);
    assert!(!folder.path("out.node").exists());

    let kept = folder.line("in.node out.node --untangle --keep-going");
    let kept =
        kept.refused(&["1 triangle cannot be mended", "The best mesh found was written: out.node"]);
    assert_eq!(kept.code, Some(1));
    let left = check::orientations(&folder.mesh("out.node"));
    let bad = left.iter().filter(|&&sign| sign <= 0).count();
    assert_eq!(bad.min(left.len() - bad), 1);
    let run = folder.line("in.node out.node --keep-going");
    assert_eq!(run.code, Some(2), "{}", run.err);
    for options in ["", " --keep-going"] {
        // An earlier report would describe another mesh.
        fs::write(folder.path("run.json"), "{\"schema_version\": 3, \"program\": \"gpu-smooth\"}")
            .unwrap();
        let run =
            folder.line(&format!("in.node out.node --untangle --report run.json --force{options}"));
        let refused = folder.json("run.json");
        assert!(run.err.contains(refused["error"].as_str().unwrap()), "{refused}");
        let listed: Vec<_> =
            refused["triangles"].as_array().unwrap().iter().map(|bad| &bad["triangle"]).collect();
        assert!(listed.contains(&&(lone + 1).into()), "{refused}");
        assert!(options.is_empty() || listed.len() == 1, "{refused}");
    }
}

/// Returns a square of twelve by twelve vertices, and the index of a vertex in the middle of its
/// lower side.
fn bed() -> (Mesh, usize) {
    let side = 12u32;
    let points = (0..side * side).map(|k| [f64::from(k % side), f64::from(k / side)]);
    let cells = (0..side * (side - 1)).filter(|k| k % side + 1 < side);
    let triangles = cells.flat_map(|k| [[k, k + 1, k + side + 1], [k, k + side + 1, k + side]]);
    let (points, triangles) = (points.collect(), triangles.collect());
    (Mesh { points, triangles, ..Mesh::default() }, side as usize / 2)
}

#[test]
fn edges_that_cross_and_cannot_move_are_listed_and_the_mesh_refused() {
    let (mut mesh, middle) = bed();
    // Two vertices of the lower side nearly exchange positions.
    mesh.points[middle] = [7.0, 2.5];
    mesh.points[middle + 1] = [6.0, 2.0];
    let folder = folder(&mesh);
    let crosses = "\n  in.node:8: the edge between vertices 6 and 7 crosses that between 8 and 9\n";
    let parts = &["triangles overlap there wherever free vertices are. Correct them", crosses];
    folder.line("in.node out.node --untangle --report run.json").refused(parts);
    assert!(!folder.json("run.json")["triangles"].as_array().unwrap().is_empty());
    assert!(!folder.path("out.node").exists());
    // No triangle stays inverted, but triangles lie over one another.
    let run = folder.line("in.node out.node --untangle --keep-going --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &[crosses]);
    assert!(check::orientations(&folder.mesh("out.node")).iter().all(|&sign| sign > 0));
}

#[test]
fn triangles_that_wind_twice_around_a_vertex_are_told_where_untangling_fails() {
    let (mut mesh, middle) = bed();
    mesh.points[middle] = [6.0, 7.5];
    mesh.points[middle + 1] = [1.5, 10.0];
    let folder = folder(&mesh);
    let parts = &[
        "no triangle is inverted, but those around vertex ",
        " wind more than once around it. Perhaps fixed vertices leave no room",
        "\n  The best mesh found was written: out.node",
    ];
    folder.line("in.node out.node --untangle --keep-going").refused(parts);
}

#[test]
fn the_time_limit_ends_untangling() {
    let folder = folder(&support::tangle::turned_hole(60, 0.5));
    let line = "in.node out.node --untangle --time-limit 0.000001";
    let parts = &[
        "--time-limit ended untangling. ",
        " stayed inverted or flat after 1 sweep of untangling",
    ];
    folder.line(line).refused(parts);
    assert!(!folder.path("out.node").exists());
    folder.line("in.node out.node --untangle --engine cpu").clean();
}

#[test]
fn a_hole_that_is_turned_over_is_refused_at_once() {
    let plate = boundaries::holes(1, 300);
    // The hole is around (1.5, 1.5).
    let mesh = boundaries::dragged(&plate, |[x, y]| {
        let is_hole = (x - 1.5).hypot(y - 1.5) < 1.0;
        if is_hole { [3.0 - x, y] } else { [x, y] }
    });
    let [node, ele] = support::triangle_text(&mesh, "");
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    let before = folder.content();
    folder.line("in out --untangle").refused(&[
        "in.node:",
        "the boundary loop of 36 vertices",
        "is turned over",
        "--keep-going",
    ]);
    assert_eq!(folder.content(), before);
    // The file is written, with fewer triangles inverted.
    let run = folder.line("in out --untangle --keep-going");
    assert!(run.code == Some(1) && folder.path("out.node").exists(), "{}", run.err);
}

/// The best mesh found was written in the format of IN alone, and not at all to another format.
#[test]
fn the_best_mesh_found_is_written_in_the_format_of_out() {
    let mut mesh = support::lattice(4, 4);
    // A vertex of the boundary on the other side of the mesh leaves no room.
    mesh.points[2] = [2.0, 9.0];
    let folder = folder(&mesh);
    folder.line("in.node out.vtu --untangle --lossy").refused(&["--keep-going"]);
    let run = folder.line("in.node out.vtu --untangle --keep-going --lossy");
    run.refused(&["The best mesh found was written: out.vtu"]);
    assert_holds(&folder.text("out.vtu"), &["<VTKFile"]);
}
