//! Options that select movable vertices: groups, lists, arrays, boxes, regions, and neighborhoods of bad triangles.

use super::{Folder, assert_holds, assert_smoothed, disturbed};
use gpu_smooth::Mesh;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::fs;

type Set = BTreeSet<usize>;

/// Returns whether a triangle is in the left half of the small mesh.
fn is_left(mesh: &Mesh, triangle: usize) -> bool {
    // Each square is two triangles, and each row has ten squares.
    assert_eq!(mesh.triangles.len(), 160);
    triangle / 2 % 10 < 5
}

/// Returns the small mesh as a .2dm file, with materials `land` on the left and `mud` on the right.
fn sms(mesh: &Mesh) -> String {
    let mut text = "MESH2D\n".to_owned();
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|v| v + 1);
        let material = if is_left(mesh, t) { 7 } else { 9 };
        writeln!(text, "E3T {} {a} {b} {c} {material}", t + 1).unwrap();
    }
    for (v, [x, y]) in mesh.points.iter().enumerate() {
        writeln!(text, "ND {} {x:?} {y:?} 2.5", v + 1).unwrap();
    }
    text + "MAT 7 \"land\"\nMAT 9 \"mud\"\nMAT 11 \"rock\"\n"
}

fn folder() -> (Folder, Mesh) {
    let mesh = disturbed();
    (Folder::new(&[("in.2dm", &sms(&mesh))]), mesh)
}

/// Returns the vertices of the triangles for which `holds` is true.
fn vertices_of(mesh: &Mesh, holds: impl Fn(usize) -> bool) -> Set {
    let triangles = (0..mesh.triangles.len()).filter(|&t| holds(t));
    triangles.flat_map(|t| mesh.triangles[t]).map(|v| v as usize).collect()
}

fn interior(mesh: &Mesh) -> Set {
    let on_boundary = support::boundary(mesh);
    (0..mesh.points.len()).filter(|&v| !on_boundary[v]).collect()
}

/// Returns the vertices whose coordinates differ in any bit.
fn moved(before: &Mesh, after: &Mesh) -> Set {
    let bits = |mesh: &Mesh, v: usize| mesh.points[v].map(f64::to_bits);
    (0..before.points.len()).filter(|&v| bits(before, v) != bits(after, v)).collect()
}

/// Checks that a run with `options` moves exactly `movers`, prints `note`, and passes `compare` with equal options. A
/// run without the options must move further vertices, which `compare` with the options must report.
#[track_caller]
fn assert_moves(folder: &Folder, input: &str, options: &str, movers: &Set, note: &str) {
    let output = input.replace("in", "out");
    let line = format!("{input} {output} --engine cpu {options}");
    let run = folder.line(&line);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.err.lines().any(|line| line == format!("gpu-smooth: {note}")), "{}", run.err);
    // `fixed` is emptied because `options` may free vertices between regions. `movers` is compared below.
    let [before, after] = [input, &output].map(|name| Mesh { fixed: vec![], ..folder.mesh(name) });
    assert_smoothed(&before, &after);
    assert_eq!(moved(&before, &after), *movers, "{options}");
    assert_holds(&run.out, &[&format!("99 vertices ({} free", movers.len())]);

    let told = folder.line(&format!("compare {input} {output} {options}"));
    assert_eq!(told.code, Some(0), "{}", told.err);
    assert_holds(&told.out, &[&format!("{} of 99 vertices have moved", movers.len())]);
    let all =
        format!("{input} {} --engine cpu --free-interfaces --quiet", input.replace("in", "all"));
    folder.line(&all).clean();
    let surplus = 63 - movers.len();
    let found =
        folder.line(&format!("compare {input} {} {options} --quiet", input.replace("in", "all")));
    let verb = if surplus == 1 { "vertex has" } else { "vertices have" };
    found.refused(&[&format!("{surplus} {verb} moved that must not")]);
}

#[test]
fn named_groups_stay() {
    let (folder, mesh) = folder();
    let mud = vertices_of(&mesh, |t| !is_left(&mesh, t));
    let inside = interior(&mesh);
    let movers = &inside - &mud;
    let free = inside.len() - 7;
    let note = format!(
        "--fix mud (material surface mud): 54 vertices stay fixed; {} of them would be free",
        free - movers.len()
    );
    assert_moves(&folder, "in.2dm", "--fix mud", &movers, &note);
    let by_tag = note.replace("--fix mud", "--fix 9");
    assert_moves(&folder, "in.2dm", "--fix 9", &movers, &by_tag);
    let in_full = note.replace("--fix mud", "--fix material:surface:mud");
    assert_moves(
        &folder,
        "in.2dm",
        "--fix material:surface:mud --free-interfaces",
        &movers,
        &in_full.replace("28", "35"),
    );
    for options in ["--fix mud,land", "--fix mud --fix land"] {
        let run = folder.line(&format!("in.2dm out.2dm --engine cpu {options} --quiet"));
        run.refused(&[
            "in.2dm: none of the 99 vertices is free to move: ",
            ". --fix, --only and the like leave nothing",
        ]);
    }
}

#[test]
fn only_the_inside_of_named_regions_moves() {
    let (folder, mesh) = folder();
    let inside = interior(&mesh);
    let land = &inside - &vertices_of(&mesh, |t| !is_left(&mesh, t));
    let note = "--only land (material surface land): 28 of 56 free vertices may move";
    assert_moves(&folder, "in.2dm", "--only land", &land, note);
    let free = note.replace("of 56", "of 63");
    assert_moves(&folder, "in.2dm", "--only land --free-interfaces", &land, &free);
    // With both materials selected and interfaces free, vertices between the materials move too.
    let both = "--only land (material surface land), 9 (material surface mud): 63 of 63 free vertices may move";
    for options in ["--only land,9 --free-interfaces", "--only land --only 9 --free-interfaces"] {
        let run = folder.line(&format!("in.2dm out.2dm --engine cpu {options}"));
        assert_holds(&run.err, &[both]);
        assert_eq!(moved(&mesh, &folder.mesh("out.2dm")), inside);
    }
}

/// Groups of every format can be fixed, by the tags that `gpu-smooth groups` prints.
#[test]
fn groups_of_every_format_stay() {
    let mesh = disturbed();
    let regions: Vec<_> = (0..160).map(|t| [if is_left(&mesh, t) { 1 } else { 2 }, 4]).collect();
    let left = vertices_of(&mesh, |t| is_left(&mesh, t));
    let movers = &interior(&mesh) - &left;
    for files in support::write_regions(&mesh, &regions) {
        let folder = Folder::new(&[]);
        for (name, bytes) in &files {
            fs::write(folder.path(name), bytes).unwrap();
        }
        let input = files[0].0;
        let told = folder.line(&format!("groups {input} --json")).clean().out;
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        let is_of_left = |group: &&serde_json::Value| {
            group["triangles"] == 80 && group["vertices"] == left.len()
        };
        let group = told["groups"].as_array().unwrap().iter().find(is_of_left).unwrap();
        let spelling = group["group"].as_str().unwrap();
        let output = input.replace("in", "out");
        let run = folder
            .line(&format!("{input} {output} --engine cpu --free-interfaces --fix {spelling}"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_eq!(moved(&mesh, &folder.mesh(&output)), movers, "{}", told["format"]);
    }
}

#[test]
fn listed_vertices_stay() {
    let (folder, mesh) = folder();
    // The file numbers vertices from 1. The second of the three vertices is on the boundary.
    fs::write(folder.path("list.txt"), "37 # in the middle\n\n1\t49\n").unwrap();
    let movers = &interior(&mesh) - &Set::from([36, 48]);
    let note = "--fix-vertices list.txt: 3 vertices stay fixed; 2 of them would be free";
    let options = "--free-interfaces --fix-vertices list.txt";
    assert_moves(&folder, "in.2dm", options, &movers, note);
    fs::write(folder.path("list.txt"), "37\n100\n").unwrap();
    let run = folder.line("in.2dm out.2dm --fix-vertices list.txt --engine cpu");
    run.refused(&["list.txt:2: in.2dm has no vertex 100. Its vertices are numbered from 1 to 99"]);
    let run = folder.line("in.2dm out.2dm --fix-vertices none.txt --engine cpu");
    run.refused(&["none.txt: ", "Check the name"]);
}

#[test]
fn vertices_in_a_box_stay() {
    let (folder, mesh) = folder();
    let within = |[x, y]: [f64; 2]| (-1.0..=4.5).contains(&x) && (2.0..=3.25).contains(&y);
    let inside = interior(&mesh);
    let held: Set = inside.iter().copied().filter(|&v| within(mesh.points[v])).collect();
    assert!(held.len() > 3);
    let movers = &inside - &held;
    let of_box = (0..mesh.points.len()).filter(|&v| within(mesh.points[v])).count();
    for corners in ["-1,2,4.5,3.25", "4.5,2,-1,3.25"] {
        let note = format!(
            "--fix-box {corners}: {of_box} vertices stay fixed; {} of them would be free",
            held.len()
        );
        let options = format!("--free-interfaces --fix-box {corners}");
        assert_moves(&folder, "in.2dm", &options, &movers, &note);
    }
    // A box that contains no vertex is not an error, but is reported.
    let run = folder.line("in.2dm out.2dm --engine cpu --max-sweeps 1 --fix-box 50,50,60,60");
    assert_holds(&run.err, &["--fix-box 50,50,60,60: it names no vertex"]);
}

#[test]
fn vertices_marked_by_an_array_stay() {
    let mesh = disturbed();
    let mut text =
        "# vtk DataFile Version 3.0\nmade for a test\nASCII\nDATASET POLYDATA\n".to_owned();
    writeln!(text, "POINTS {} double", mesh.points.len()).unwrap();
    mesh.points.iter().for_each(|[x, y]| writeln!(text, "{x:?} {y:?} 0").unwrap());
    writeln!(text, "POLYGONS {0} {1}", 160, 4 * 160).unwrap();
    mesh.triangles.iter().for_each(|[a, b, c]| writeln!(text, "3 {a} {b} {c}").unwrap());
    text += "POINT_DATA 99\nSCALARS fixed float\nLOOKUP_TABLE default\n";
    let is_held = |v: usize| v.is_multiple_of(5);
    (0..99).for_each(|v| writeln!(text, "{}", if is_held(v) { -0.5 } else { 0.0 }).unwrap());
    let folder = Folder::new(&[("in.vtk", &text)]);
    let inside = interior(&mesh);
    let movers: Set = inside.iter().copied().filter(|&v| !is_held(v)).collect();
    let note = format!(
        "--fix-array fixed: 20 vertices stay fixed; {} of them would be free",
        inside.len() - movers.len()
    );
    assert_moves(&folder, "in.vtk", "--fix-array fixed", &movers, &note);
    folder
        .line("in.vtk out.vtk --engine cpu --fix-array fixe")
        .refused(&["in.vtk: no point data is called 'fixe'. There are fixed"]);
}

/// The inverse mean ratio, from the lengths of the edges.
fn imr(mesh: &Mesh, triangle: usize) -> f64 {
    let p = mesh.triangles[triangle].map(|v| mesh.points[v as usize]);
    let square = |a: [f64; 2], b: [f64; 2]| (b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2);
    let sum = square(p[0], p[1]) + square(p[1], p[2]) + square(p[2], p[0]);
    let doubled =
        (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
    sum / (2.0 * 3f64.sqrt() * doubled.abs())
}

#[test]
fn only_vertices_near_bad_triangles_move() {
    let (folder, mesh) = folder();
    let inside = interior(&mesh);
    let mut ratios: Vec<f64> = (0..160).map(|t| imr(&mesh, t)).collect();
    ratios.sort_by(f64::total_cmp);
    // A limit that exactly two triangles exceed.
    let limit = format!("{:.3}", 0.5 * (ratios[157] + ratios[158]));
    let q: f64 = limit.parse().unwrap();
    let mut near = vertices_of(&mesh, |t| imr(&mesh, t) > q);
    for rings in 0..3 {
        let movers: Set = near.intersection(&inside).copied().collect();
        assert!(movers.len() < 63);
        let within = match rings {
            0 => "of their vertices",
            1 => "within 1 ring of them",
            _ => "within 2 rings of them",
        };
        let note = format!(
            "--only-bad {limit}: 2 triangles above it; {within} {} of 63 free vertices may move",
            movers.len()
        );
        let options = format!("--free-interfaces --only-bad {limit} --rings {rings}");
        assert_moves(&folder, "in.2dm", &options, &movers, &note);
        if rings == 2 {
            let options = format!("--free-interfaces --only-bad {limit}");
            assert_moves(&folder, "in.2dm", &options, &movers, &note);
            // A vertex moves only if both options allow the move. Fixed vertices stay.
            let land = &movers - &vertices_of(&mesh, |t| !is_left(&mesh, t));
            let options = format!("{options} --only land --fix-box 0,0,1.5,9");
            let held = |v: &usize| mesh.points[*v][0] <= 1.5;
            let land: Set = land.into_iter().filter(|v| !held(v)).collect();
            assert!(!land.is_empty() && land.len() < movers.len());
            assert_moves(&folder, "in.2dm", &options, &land, &note);
        }
        near =
            vertices_of(&mesh, |t| mesh.triangles[t].iter().any(|&v| near.contains(&(v as usize))));
    }
}

#[test]
fn a_mesh_without_bad_triangles_is_written_as_it_was() {
    let (folder, _) = folder();
    let run =
        folder.line("in.2dm out.2dm --engine cpu --only-bad 1e6 --report r.json --fraction 0.9");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(
        &run.out,
        &["nothing to do: no triangle has an imr above 1000000; the worst has "],
    );
    assert!(folder.text("in.2dm") == folder.text("out.2dm"));
    assert_eq!(folder.json("r.json")["stop"], "nothing-to-do");
    let told = folder.line("compare in.2dm out.2dm --only-bad 1e6");
    assert_holds(&told.out, &["0 of 99 vertices have moved"]);
    folder.line("in.2dm all.2dm --engine cpu -q").clean();
    folder
        .line("compare in.2dm all.2dm --only-bad 1e6 -q")
        .refused(&["56 vertices have moved that must not"]);
}

#[test]
fn fixed_vertices_stay_while_a_mesh_is_untangled() {
    let mut mesh = disturbed();
    let mud = vertices_of(&mesh, |t| !is_left(&mesh, t));
    // A vertex in the left half moves far out of its patch.
    mesh.points[4 * 11 + 2][1] += 1.6;
    let folder = Folder::new(&[("in.2dm", &sms(&mesh))]);
    folder.line("in.2dm out.2dm --engine cpu --fix mud -q").refused(&["inverted"]);
    let run = folder.line("in.2dm out.2dm --engine cpu --fix mud --untangle");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let after = folder.mesh("out.2dm");
    assert!(support::is_ccw(&after));
    assert_eq!(moved(&folder.mesh("in.2dm"), &after), &interior(&mesh) - &mud);
}

#[test]
fn the_report_tells_what_was_chosen() {
    let (folder, _) = folder();
    folder.line("in.2dm out.2dm --engine cpu --report r.json --quiet").clean();
    assert!(folder.json("r.json").get("choices").is_none());
    folder
        .line("in.2dm out.2dm --engine cpu --report r.json --quiet --only land --fix-box 9,9,9,9")
        .clean();
    let report = folder.json("r.json");
    assert_eq!(
        report["choices"],
        serde_json::json!([
            "--fix-box 9,9,9,9: it names no vertex",
            "--only land (material surface land): 28 of 56 free vertices may move"
        ])
    );
    assert_eq!(report["mesh"]["free"], 28);
}

#[test]
fn unknown_groups_are_errors_that_list_the_known_ones() {
    let (folder, mesh) = folder();
    let refused = |options: &str, parts: &[&str]| {
        folder.line(&format!("in.2dm out.2dm --engine cpu {options}")).refused(parts);
        folder.line(&format!("compare in.2dm in.2dm {options}")).refused(parts);
    };
    refused(
        "--fix mut",
        &["in.2dm: --fix: no group is called 'mut'; there are mud, ", "`gpu-smooth groups`"],
    );
    refused("--only land,mut", &["--only: no group is called 'mut'; there are mud, "]);
    refused("--fix rock", &["--fix: material surface rock has no elements"]);
    refused("--only 11", &["--only: material surface rock has no triangles"]);
    let with_comma = sms(&mesh).replace("\"mud\"", "\"mud,wet\"");
    fs::write(folder.path("in.2dm"), with_comma).unwrap();
    for options in ["mud,wet", "surface:mud,wet", "land,9", "9"] {
        let run =
            folder.line(&format!("in.2dm out.2dm --engine cpu --only {options} --max-sweeps 1"));
        assert_eq!(run.code, Some(0), "{options}: {}", run.err);
    }
    let ambiguous = sms(&mesh).replace("\"rock\"", "\"mud\"");
    fs::write(folder.path("in.2dm"), ambiguous).unwrap();
    // One of the two groups of a name has no elements.
    let run = folder.line("in.2dm out.2dm --engine cpu --fix mud --max-sweeps 1");
    assert_eq!((run.code, run.err.matches("--fix mud").count()), (Some(0), 1), "{}", run.err);
    let [node, ele] =
        support::triangle_text(&mesh, "of no groups").map(|text| text.replace(" 1\n", " 0\n"));
    fs::write(folder.path("a.node"), node).unwrap();
    fs::write(folder.path("a.ele"), ele).unwrap();
    let run = folder.line("a.node b.node --engine cpu --fix wall");
    run.refused(&["a.node: --fix: no group is called 'wall'"]);
}
