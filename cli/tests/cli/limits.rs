//! Thresholds of edges and vertices, and profiles of solvers.

use super::{Folder, Run, assert_holds, finish, number, small};
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
fn the_worst_edges_are_listed_with_their_ends_if_a_measure_of_edges_is_first() {
    let folder = quadrilateral();
    let text =
        quality(&folder, &["-m", "orthogonality,min-angle,flow-link,smoothness", "--worst", "3"])
            .clean()
            .out;
    let list: Vec<&str> =
        text.split("worst edges by orthogonality\n").nth(1).unwrap().lines().take(4).collect();
    assert_eq!(list[3], "");
    assert_holds(
        list[0],
        &["  the edge between vertices ", " and 5 (lines ", " of in.14): orthogonality 0."],
    );
    assert_holds(list[0], &[", flow-link ", ", smoothness "]);
    assert!(list[0].ends_with("; can move"), "{}", list[0]);
    assert!(!list[0].contains("min-angle"));
    let told: Value =
        serde_json::from_str(&quality(&folder, &["-m", "flow-link", "--worst", "9", "--json"]).out)
            .unwrap();
    let worst = told["worst"].as_array().unwrap();
    // Each of the four edges at vertex 5, the shortest link first.
    let links: Vec<f64> = worst.iter().map(|edge| number(&edge["flow-link"])).collect();
    assert!(links.len() == 4 && links.is_sorted(), "{links:?}");
    for edge in worst {
        assert_eq!(
            (&edge["vertices"][1], &edge["corners"][1]),
            (&5.into(), &vec![2.0, 0.5].into())
        );
        let end = edge["vertices"][0].as_u64().unwrap();
        assert_eq!(edge["lines"], Value::from(vec![end + 2, 7]));
        assert_eq!(edge["movable"], true);
    }
    // All vertices of the square are fixed, and none is inside.
    let cut = "flat\n2 4\n1 0 0 1\n2 4 0 1\n3 4 3 1\n4 0 3 1\n1 3 1 2 3\n2 3 1 3 4\n0\n0\n0\n0\n";
    let folder = Folder::new(&[("in.14", cut)]);
    let text = quality(&folder, &["-m", "orthogonality"]).clean().out;
    assert_holds(
        &text,
        &["vertices 1 and 3 (lines 3 and 5 of in.14)", "all vertices of its triangles are fixed"],
    );
}

#[test]
fn the_profile_of_schism_warns_of_long_triangles() {
    // The longest side is that of 4, and the area of the lowest triangle becomes 0.02: 4 / sqrt(0.02 / pi) is above 15.
    let flat = QUADRILATERAL.replace("5 2 0.5 1", "5 2 0.01 1");
    let folder = Folder::new(&[("hgrid.gr3", &flat)]);
    let run = folder.line("quality hgrid.gr3 --for schism --summary").clean();
    let told = "hgrid.gr3: warn: 1 of 4 triangles have schism-skewness>15; the worst is triangle 1 (hgrid.gr3:8), schism-skewness 50.13";
    assert_holds(&run.out, &[told]);
    folder.line("quality hgrid.gr3 --threshold schism-skewness>51").clean();
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

#[test]
fn a_threshold_of_hole_edges_counts_small_islands() {
    // A square of eight triangles around a hole of four edges.
    let mesh = "ring\n8 8\n1 0 0 1\n2 3 0 1\n3 3 3 1\n4 0 3 1\n5 1 1 1\n6 2 1 1\n7 2 2 1\n8 1 2 1\n\
                1 3 1 2 5\n2 3 2 6 5\n3 3 2 3 6\n4 3 3 7 6\n5 3 3 4 7\n6 3 4 8 7\n7 3 4 1 8\n8 3 1 5 8\n0\n0\n0\n0\n";
    let folder = Folder::new(&[("in.14", mesh)]);
    let run = quality(&folder, &["--threshold", "hole-edges<7", "--summary"]);
    assert_eq!(run.code, Some(1));
    let told = "1 of 1 holes have hole-edges<7; the worst is vertex 5 (in.14:7), hole-edges 4";
    assert_holds(&run.out, &[told]);
    quality(&folder, &["--threshold", "hole-edges<4"]).clean();
}

#[test]
fn a_profile_has_a_line_for_each_limit_and_fails_with_the_mesh() {
    let folder = quadrilateral();
    let own = "name = \"ours\"\ntitle = \"our solver\"\n[[limits]]\nquantity = \"orthogonality\"\nwarn = \"> 0.01\"\nfail = \"> 0.3\"\n\
               source = \"our experience\"\n[[limits]]\nquantity = \"neighbors\"\nfail = \"> 10\"\n[[limits]]\n\
               quantity = \"max-angle\"\nwarn = \"> 100\"\n";
    std::fs::write(folder.path("own.toml"), own).unwrap();
    let run = quality(&folder, &["--for", "own.toml"]);
    assert_eq!(run.code, Some(1));
    let table: Vec<&str> =
        run.out.lines().skip_while(|line| *line != "limits of ours: our solver").collect();
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(words(table[1]), words("quantity warn fail warned failed verdict worst"));
    let expected = [
        ("orthogonality > 0.01 > 0.3 0 2 fail 0.", ", the edge between vertices "),
        ("neighbors > 10 0 0 good 4, vertex 5 (in.14:7)", ""),
        ("max-angle > 100 1 0 warn ", ", triangle 1 (in.14:8)"),
    ];
    for (line, (start, part)) in table[2..5].iter().zip(expected) {
        assert!(words(line).join(" ").starts_with(start), "{line}");
        assert_holds(line, &[part]);
    }
    assert_holds(&run.err, &["in.14: 2 of 4 edges have orthogonality>0.3; the worst is the edge "]);
    let summary = quality(&folder, &["--for", "own.toml", "--summary"]);
    let lines: Vec<&str> = summary.out.lines().collect();
    assert_eq!(lines.len(), 3, "{}", summary.out);
    assert!(
        lines[0].starts_with("in.14: fail: 2 of 4 edges have orthogonality>0.3; the worst is ")
    );
    assert!(
        lines[1].starts_with("in.14: good: none of 5 vertices has neighbors>10; the worst is ")
    );
    assert!(
        lines[2].starts_with("in.14: warn: 1 of 4 triangles have max-angle>100; the worst is ")
    );
    let told: Value =
        serde_json::from_str(&quality(&folder, &["--for", "own.toml", "--json"]).out).unwrap();
    let profile = &told["profile"];
    assert_eq!((&profile["name"], &profile["verdict"]), (&"ours".into(), &"fail".into()));
    assert!(profile["scheme"].is_null() && profile.get("scheme").is_some(), "{profile}");
    let limit = &profile["limits"][0];
    assert_eq!(
        (&limit["edges"], &limit["failed"], &limit["warned"]),
        (&4.into(), &2.into(), &0.into())
    );
    assert_eq!((&limit["fail"], &limit["source"]), (&"> 0.3".into(), &"our experience".into()));
    assert_eq!(limit["worst"]["vertices"][1], 5);
    // A mesh that only warns passes.
    let milder = own.replace("fail = \"> 0.3\"\n", "");
    std::fs::write(folder.path("own.toml"), milder).unwrap();
    quality(&folder, &["--for", "own.toml"]).clean();
    assert_eq!(quality(&folder, &["--for", "own.toml", "-q"]).clean().out, "");
}

/// A right triangle with legs of 30 and 40, thus an altitude of 24, at depths of 0 to 9.81, and a dry triangle.
const SHORE: &str =
    "shore\n2 4\n1 0 0 9.81\n2 30 0 0\n3 0 40 -1\n4 30 40 -3\n1 3 1 2 3\n2 3 2 4 3\n0\n0\n0\n0\n";

#[test]
fn the_time_step_is_the_altitude_over_the_speed_of_waves_at_the_largest_depth() {
    let folder = Folder::new(&[("in.14", SHORE)]);
    // sqrt(9.81 * 9.81) is 9.81.
    let step = 24.0 / 9.81;
    let run = quality(&folder, &["--threshold", "time-step<3", "--summary"]);
    assert_eq!(run.code, Some(1));
    let told = "in.14: failed: 1 of 1 triangles have time-step<3; the worst is triangle 1 (in.14:7), time-step 2.4465 s";
    assert_holds(&run.out, &[told]);
    let table = quality(&folder, &["--for", "adcirc"]).clean().out;
    let line = table.lines().find(|line| line.starts_with("time-step")).unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(words.join(" "), "time-step 2.4465 s, triangle 1 (in.14:7)");
    let summary = quality(&folder, &["--for", "telemac", "--summary"]).clean().out;
    let told =
        "in.14: listed: the worst of 1 triangles is triangle 1 (in.14:7), time-step 2.4465 s";
    assert_holds(&summary, &[told]);
    let value = |folder: &Folder, options: &str| {
        let told = folder.line(&format!("quality {options} --for adcirc --json")).clean().out;
        let told: Value = serde_json::from_str(&told).unwrap();
        let limits = told["profile"]["limits"].as_array().unwrap().clone();
        limits.into_iter().find(|limit| limit["quantity"] == "time-step")
    };
    let listed = value(&folder, "in.14").unwrap();
    assert_eq!((&listed["verdict"], &listed["triangles"]), (&"listed".into(), &1.into()));
    assert!(listed["warn"].is_null() && listed["fail"].is_null());
    assert!((number(&listed["worst"]["value"]) / step - 1.0).abs() < 1e-12);
    // Heights of a 2dm have the other sign.
    folder.line("convert in.14 in.2dm").clean();
    let of_2dm = value(&folder, "in.2dm").unwrap();
    assert!((number(&of_2dm["worst"]["value"]) / step - 1.0).abs() < 1e-12);
    // In degrees at 60 degrees of latitude, a degree of longitude is half as long as one of latitude. The triangle has legs
    // of 0.008 and 0.003 degrees, in meters as 4 to 3.
    let degrees = SHORE.replace("1 0 0 ", "1 10 60 ").replace("2 30 0 ", "2 10.008 60 ");
    let degrees =
        degrees.replace("3 0 40 ", "3 10 60.003 ").replace("4 30 40 ", "4 10.008 60.003 ");
    std::fs::write(folder.path("degrees.14"), degrees).unwrap();
    let of_degrees = value(&folder, "degrees.14 --surface sphere").unwrap();
    let meters = 0.0024 * 6_371_000.0 * std::f64::consts::PI / 180.0;
    assert!((number(&of_degrees["worst"]["value"]) * 9.81 / meters - 1.0).abs() < 1e-4);
}

/// A rectangle with sides of 30 and 40, whose corner triangles have an altitude of 24.
const BASIN: &str =
    "basin\n1 4\n1 0 0 9.81\n2 30 0 0\n3 30 40 -1\n4 0 40 -3\n1 4 1 2 3 4\n0\n0\n0\n0\n";

#[test]
fn the_time_step_of_a_quadrilateral_is_by_the_least_altitude_of_its_corner_triangles() {
    let folder = Folder::new(&[("in.14", BASIN)]);
    let run = quality(&folder, &["--threshold", "time-step<3", "--summary"]);
    assert_eq!(run.code, Some(1));
    let told = "in.14: failed: 1 of 1 elements have time-step<3; the worst is quadrilateral 1 (in.14:7), time-step 2.4465 s";
    assert_holds(&run.out, &[told]);
    for profile in ["adcirc", "schism"] {
        let json = quality(&folder, &["--for", profile, "--json"]).out;
        let told: Value = serde_json::from_str(&json).unwrap();
        let limits = told["profile"]["limits"].as_array().unwrap();
        let listed = limits.iter().find(|limit| limit["quantity"] == "time-step").unwrap();
        assert_eq!(listed["elements"], 1, "{profile}: {listed}");
        assert_eq!(listed["worst"]["quadrilateral"], 1);
        assert!((number(&listed["worst"]["value"]) * 9.81 / 24.0 - 1.0).abs() < 1e-12);
    }
    let own = "name = \"ours\"\n[[limits]]\nquantity = \"time-step\"\nelements = \"quadrilaterals\"\nfail = \"< 3\"\n";
    std::fs::write(folder.path("own.toml"), own).unwrap();
    let run = quality(&folder, &["--for", "own.toml", "--summary"]);
    assert_eq!(run.code, Some(1));
    assert_holds(
        &run.out,
        &["1 of 1 quadrilaterals have time-step<3; the worst is quadrilateral 1"],
    );
    // The wave is slow on the triangle at the upper edge, at a depth of 0.0981.
    let mixed =
        BASIN.replace("1 4\n", "2 5\n").replace("\n4 0 40 -3", "\n4 0 40 0.0981\n5 0 400 -1");
    let mixed = mixed.replace("\n1 4 1 2 3 4", "\n1 3 4 3 5\n2 4 1 2 3 4");
    std::fs::write(folder.path("in.14"), mixed).unwrap();
    let run = quality(&folder, &["--threshold", "time-step<3", "--summary"]);
    assert_holds(&run.out, &["1 of 2 elements have time-step<3; the worst is quadrilateral 2"]);
}

#[test]
fn a_threshold_of_triangles_is_refused_for_a_mesh_without_triangles() {
    let folder = Folder::new(&[("in.14", BASIN)]);
    for (threshold, name) in
        [("boundary-corners>=3", "boundary-corners"), ("schism-skewness>9", "schism-skewness")]
    {
        let told = format!("in.14: no element is a triangle, which {name} needs");
        quality(&folder, &["--threshold", threshold, "--summary"]).refused(&[&told]);
    }
    quality(&folder, &["--threshold", "edge-ratio>2", "--summary"]).clean();
}

#[test]
fn a_mesh_without_depths_has_no_time_step() {
    let folder = small();
    folder
        .line("quality in --threshold time-step<1")
        .refused(&["in.node: no vertex has a positive depth", "--z data"]);
    let table = folder.line("quality in --for adcirc");
    assert!(!table.out.contains("time-step"), "{}", table.out);
    let own = "name = \"ours\"\n[[limits]]\nquantity = \"time-step\"\nwarn = \"< 1\"\n";
    std::fs::write(folder.path("own.toml"), own).unwrap();
    // Depths of the wrong sign.
    std::fs::write(folder.path("dry.14"), SHORE.replace("9.81", "-9.81")).unwrap();
    folder
        .line("quality dry.14 --threshold time-step<1")
        .refused(&["no vertex has a positive depth", "signs"]);
    folder.line("quality in --for own.toml").refused(&["no vertex has a positive depth"]);
}

#[test]
fn a_run_lists_the_time_step_at_the_depths_that_it_writes() {
    // The vertex inside moves to the middle. Its depth is interpolated or kept.
    let deep = QUADRILATERAL.replace("5 2 0.5 1", "5 2 0.5 100");
    let folder = Folder::new(&[("in.14", &deep)]);
    let step = |state: &Value| {
        let limits = state["limits"].as_array().unwrap();
        let listed = limits.iter().find(|limit| limit["quantity"] == "time-step").unwrap();
        number(&listed["worst"]["value"])
    };
    for options in ["", "--interpolate depth"] {
        let line =
            format!("in.14 out.14 --force --engine cpu --for adcirc --report r.json {options}");
        let run = folder.line(&line);
        assert_holds(&run.out, &["\ntime-step "]);
        let profile = &folder.json("r.json")["profile"];
        for (mesh, state) in [("in.14", "before"), ("out.14", "after")] {
            let told = folder.line(&format!("quality {mesh} --for adcirc --json")).out;
            let told: Value = serde_json::from_str(&told).unwrap();
            assert_eq!(step(&told["profile"]), step(&profile[state]), "{mesh} {options}");
        }
    }
}

#[test]
fn a_profile_that_cannot_be_read_is_refused_with_its_line_or_with_the_names() {
    let folder = quadrilateral();
    let run = quality(&folder, &["--for", "dflowfn"]);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""));
    let told = "no profile is called 'dflowfn'; there are adcirc, dflowfm, ";
    assert_holds(&run.err, &[told, "Did you mean dflowfm?"]);
    quality(&folder, &["--for", "none.toml"]).refused(&["none.toml: ", "Check the name"]);
    let own = "name = \"ours\"\n[[limits]]\nquantity = \"orthogonality\"\nfail = \"< 0.5\"\n";
    std::fs::write(folder.path("own.toml"), own).unwrap();
    let told = ["own.toml:4: fail of orthogonality: ", "write 'orthogonality>0.5'"];
    quality(&folder, &["--for", "own.toml"]).refused(&told);
}

#[test]
fn edges_beyond_a_limit_are_counted_by_the_reason_that_keeps_them() {
    // The vertex inside has four triangles, one of which is obtuse there.
    let folder = quadrilateral();
    let own = "name = \"ours\"\n[[limits]]\nquantity = \"orthogonality\"\nfail = \"> 0.3\"\n";
    std::fs::write(folder.path("own.toml"), own).unwrap();
    let run = quality(&folder, &["--for", "own.toml"]);
    let told = "edges beyond the limits, by reason\n        2 fail        0 warn  a vertex inside with three or four triangles: ";
    assert_holds(&run.out, &[told]);
    let told: Value =
        serde_json::from_str(&quality(&folder, &["--for", "own.toml", "--json"]).out).unwrap();
    let reasons = told["profile"]["reasons"].as_array().unwrap();
    assert_eq!(reasons.len(), 1);
    assert_eq!(
        (&reasons[0]["reason"], &reasons[0]["failed"]),
        (&"few-triangles".into(), &2.into())
    );
    assert_eq!(reasons[0]["remedies"], Value::from(vec!["swap", "refine"]));
}

#[test]
fn a_run_for_a_solver_takes_its_metric_and_ends_with_its_limits_before_and_after() {
    let folder = small();
    let run = folder.line("in out --for dflowfm --engine cpu --report r.json").clean();
    assert_holds(&run.out, &["\nacute on cpu (", "\nlimits of dflowfm "]);
    let table = run.out.split("\nlimits of dflowfm ").nth(1).unwrap();
    let row: Vec<&str> = table
        .lines()
        .find(|line| line.starts_with("flow-link"))
        .unwrap()
        .split_whitespace()
        .collect();
    let report = folder.json("r.json");
    assert_eq!(report["options"]["scheme"], "acute");
    let counts = |state: &str| {
        let limit = &report["profile"][state]["limits"][1];
        assert_eq!(limit["quantity"], "flow-link");
        ["warned", "failed", "verdict"].map(|key| limit[key].to_string().replace('"', ""))
    };
    // The quantity and both ranges are five words, and the worst value is before the numbers.
    assert_eq!([row[6], row[7], row[8]], counts("before").each_ref().map(String::as_str));
    assert_eq!([row[10], row[11], row[12]], counts("after").each_ref().map(String::as_str));
    // The table is that of the written files.
    for (mesh, state) in [("in", "before"), ("out", "after")] {
        let told: Value =
            serde_json::from_str(&folder.line(&format!("quality {mesh} --for dflowfm --json")).out)
                .unwrap();
        let failed = |limits: &Value, k: usize| limits[k]["failed"].clone();
        for k in 0..2 {
            let of_run = &report["profile"][state]["limits"];
            assert_eq!(failed(&told["profile"]["limits"], k), failed(of_run, k), "{mesh}");
        }
    }
    // A given scheme or target takes precedence.
    let scheme = |options: &str| {
        let line = format!("in out2 --force --for dflowfm --engine cpu {options} --report r.json");
        folder.line(&line).clean();
        folder.json("r.json")["scheme"].clone()
    };
    assert_eq!([scheme("--scheme imr"), scheme("--target keep-size")], ["imr", "tmop-94"]);
    folder.line("in out3 --for none.toml").refused(&["none.toml: ", "Check the name"]);
}
