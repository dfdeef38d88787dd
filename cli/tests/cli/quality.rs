//! The command `gpu-smooth quality`: text, JSON and CSV.

use super::output::INVERTED;
use super::{Folder, assert_holds, disturbed, finish, number, small};
use gpu_smooth::{
    Topology,
    measure::{Measure, Measured},
};
use mesh_io::MeshFile;
use serde_json::Value;
use std::fs;

/// Returns the numbers in a row of text.
fn numbers(row: &str) -> Vec<f64> {
    row.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

fn json(folder: &Folder, line: &str) -> Value {
    serde_json::from_str(&folder.line(line).clean().out).unwrap()
}

#[test]
fn all_forms_tell_the_same_statistics() {
    let folder = small();
    let unnamed = folder.line("quality in").clean().out;
    let all: Vec<&str> = Measure::ALL.iter().map(|measure| measure.name()).collect();
    let text = folder.line(&format!("quality in -m {}", all.join(","))).clean().out;
    // The table of statistics is between the sizes of the mesh and the histograms.
    let text = text.split("\n\n").nth(1).unwrap();
    let told = json(&folder, "quality in --json");
    let csv = folder.line("quality in --csv").clean().out;
    let mut rows = csv.lines();
    assert_eq!(rows.next(), Some("file,region,measure,triangles,min,mean,max,sd,p5,p50,p95"));
    let file = MeshFile::read(&folder.path("in")).unwrap();
    let mesh = support::mesh_of(&file);
    let topology = Topology::new(&mesh).unwrap();
    let measured = Measured::new(file.points(), &topology).unwrap();
    for &measure in Measure::ALL {
        let mut values = measured.values(measure);
        values.sort_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / 160.0;
        // 5 % of 160 values are 8.
        let expected = [values[0], mean, values[159], values[7], values[79], values[151]];
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * b.abs();

        let of_json = &told["measures"][measure.name()];
        let keys = ["min", "mean", "max", "p5", "p50", "p95"];
        assert!(keys.iter().zip(expected).all(|(key, x)| close(number(&of_json[key]), x)));
        let deviation = number(&of_json["sd"]);

        let row = rows.next().unwrap();
        assert!(row.starts_with(&format!("in,,{measure},160,")), "{row}");
        let of_csv: Vec<f64> = row.split(',').skip(4).map(|field| field.parse().unwrap()).collect();
        assert!(close(of_csv[3], deviation));
        assert!(
            [0, 1, 2, 4, 5, 6].iter().zip(expected).all(|(&i, x)| close(of_csv[i], x)),
            "{row}"
        );

        if matches!(measure, Measure::Metric(_)) {
            let told = "Not listed: the metrics of runs (-m edge,area,";
            assert!(unnamed.contains(told), "{unnamed}");
            let has_row = unnamed.contains(&format!("\n{measure}   "));
            assert!(!has_row || measure.name() == "area", "{unnamed}");
        }
        let row = text.lines().find(|row| row.split(' ').next() == Some(measure.name()));
        // A measure with the values of another has no row of its own in a table for people.
        let Some(row) = row else {
            let twin = measure.equal_to().unwrap();
            assert_holds(text, &[&format!("{measure} equals {twin}")]);
            continue;
        };
        assert_eq!(measure.equal_to(), None, "{row}");
        let [min, mean, max, low, median, high] = expected;
        let expected = [min, low, median, mean, high, max, deviation];
        let of_text = numbers(row);
        assert_eq!(of_text.len(), 7, "{row}");
        // Numbers that are rounding errors, as the least orthogonality, have two digits.
        let rough = |(a, b): (&f64, f64)| (a - b).abs() <= 1e-3 * b.abs() + 1e-15;
        assert!(of_text.iter().zip(expected).all(rough), "{row}: {expected:?}");
    }
    assert_eq!(rows.next(), None);
}

#[test]
fn histograms_count_every_triangle() {
    let folder = small();
    let line = "quality in -m size-ratio,min_angle -m condition";
    let text = folder.line(line).clean().out;
    let told = json(&folder, &format!("{line} --json"));
    for (i, name) in ["size-ratio", "min-angle", "condition"].iter().enumerate() {
        let histogram = &told["histograms"][i];
        assert_eq!(&histogram["measure"], name);
        let counts: Vec<u64> =
            histogram["counts"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
        assert_eq!(counts.iter().sum::<u64>(), 160);
        assert_eq!(histogram["edges"].as_array().unwrap().len(), counts.len() + 1);
        let title =
            if *name == "min-angle" { "\nmin-angle \u{b0}\n" } else { &format!("\n{name}\n") };
        let block = text.split(title).nth(1).unwrap().split("\n\n").next().unwrap();
        let drawn: Vec<u64> = block
            .lines()
            .map(|row| numbers(row).into_iter().rev().nth(1).unwrap() as u64)
            .collect();
        let first = counts.iter().position(|&n| n > 0).unwrap();
        assert_eq!(drawn, counts[first..first + drawn.len()], "{block}");
        assert_eq!(drawn.iter().sum::<u64>(), 160);
        // Histograms have no block characters if the output is not a terminal.
        assert!(block.is_ascii() && block.contains('#'), "{block}");
    }
    let ascii = folder.line("quality in --ascii").clean().out;
    assert!(ascii.is_ascii() && ascii.contains("\nmin-angle (deg) "), "{ascii}");
}

#[test]
fn the_worst_triangles_are_listed_with_their_place() {
    let folder = small();
    let mesh = folder.mesh("in");
    let told = json(&folder, "quality in --json --worst 7 -m min-angle,shape");
    let worst = told["worst"].as_array().unwrap();
    assert_eq!(worst.len(), 7);
    let topology = Topology::new(&mesh).unwrap();
    let angles = Measured::new(&mesh.points, &topology).unwrap().values(Measure::MinAngle);
    let mut order: Vec<usize> = (0..angles.len()).collect();
    order.sort_by(|&a, &b| angles[a].total_cmp(&angles[b]));
    let ele = folder.text("in.ele");
    for (told, &t) in worst.iter().zip(&order) {
        assert!((number(&told["min-angle"]) / angles[t] - 1.0).abs() < 1e-12);
        let line = told["line"].as_u64().unwrap() as usize;
        let row: Vec<u64> =
            ele.lines().nth(line - 1).unwrap().split(' ').map(|n| n.parse().unwrap()).collect();
        assert_eq!(told["triangle"], row[0]);
        assert_eq!(told["vertices"], Value::from(row[1..4].to_vec()));
        let corners = mesh.triangles[t].map(|v| mesh.points[v as usize].to_vec());
        assert_eq!(told["corners"], Value::from(corners.map(Value::from).to_vec()));
        let movable = mesh.triangles[t].iter().any(|&v| topology.free()[v as usize]);
        assert_eq!(told["movable"], movable);
    }
    let text = folder.line("quality in --worst 7 -m min-angle,shape").clean().out;
    let (line, triangle) = (&worst[0]["line"], &worst[0]["triangle"]);
    let first =
        format!("worst triangles by min-angle\n  triangle {triangle} (in.ele:{line}): min-angle ");
    assert_holds(&text, &[&first]);
    assert_eq!(
        text.matches(" can move\n").count(),
        worst.iter().filter(|w| w["movable"] == true).count()
    );
    assert!(!folder.line("quality in --worst 0").clean().out.contains("worst triangles"));
}

#[test]
fn a_threshold_fails_where_triangles_pass_it() {
    let folder = small();
    let angles = json(&folder, "quality in --json")["measures"]["min-angle"].clone();
    let (least, most) = (number(&angles["min"]), number(&angles["max"]));
    let run = |threshold: &str| {
        finish(folder.command().args(["quality", "in", "--threshold", threshold]))
    };
    let all = run(&format!("min-angle<={most}"));
    assert_eq!(all.code, Some(1));
    assert_holds(
        &all.err,
        &["in: 160 of 160 triangles have min-angle<=", "the worst is triangle ", "(in.ele:"],
    );
    assert_holds(&all.out, &["\ninverted or flat"]);
    let last = run(&format!("min-angle <= {least}"));
    assert_holds(&last.err, &["in: 1 of 160 triangles have min-angle<="]);
    for passed in [format!("min-angle<{least}"), "max-angle>180".into(), "size_ratio>=1e300".into()]
    {
        let told = run(&passed).clean().out;
        let line = told.lines().last().unwrap();
        assert!(line.starts_with("in: passed: none of 160 triangles has "), "{line}");
        assert_holds(line, &["; the worst is triangle ", " (in.ele:"]);
    }
    // A log of checks has a line for each threshold alone, or for violated thresholds alone.
    let line =
        format!("quality in --threshold min-angle<{least} --threshold max-angle>0 --summary");
    let log = finish(folder.command().args(line.split(' ')));
    assert_eq!((log.code, log.out.lines().count(), log.err.lines().count()), (Some(1), 2, 1));
    assert_holds(&log.out, &["in: passed: none of ", "in: failed: 160 of 160 triangles have "]);
    let quiet = finish(folder.command().args(line.replace("--summary", "-q").split(' ')));
    assert_eq!((quiet.code, quiet.out.as_str(), quiet.err), (Some(1), "", log.err));
    let short = folder.line("quality in --summary").clean().out;
    assert!(short.starts_with("in: 160 triangles, min-angle "), "{short}");
    assert!(short.lines().count() == 1 && short.contains("0 inverted or flat"), "{short}");
    // Standard error has a line for each mesh and each violated threshold, also with `--json`.
    let line = "quality in in.ele --json --threshold min-angle<60 --threshold condition>=1 --threshold shape<0";
    let run = folder.line(line);
    assert_eq!((run.code, run.err.lines().count()), (Some(1), 4), "{}", run.err);
    let told: Value = serde_json::from_str(&run.out).unwrap();
    let counts: Vec<_> = (0..3).map(|i| &told[1]["thresholds"][i]["triangles"]).collect();
    assert_eq!(counts, [160, 160, 0]);
    assert!(told[1]["thresholds"][2]["worst"].is_null());
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let folder = small();
    for (options, part) in [
        ("--threshold min-angle>20", "low values of min-angle are bad"),
        ("--threshold condition<2", "write 'condition>2'"),
        ("--threshold min-angle", "a measure, < or >, and a number"),
        ("--threshold min-angle<<20", "a number"),
        ("--threshold min-angle<==20", "a measure, < or >, and a number"),
        ("--threshold min-angle<nan", "'nan' is not a number"),
        ("--threshold angle<20", "no measure is called 'angle'; there are "),
        ("--threshold flow-link>0.1", "write 'flow-link<0.1'"),
        ("-m roundness", "no measure is called 'roundness'"),
        ("--json --csv", "--csv"),
        ("--worst -1", "-1"),
    ] {
        let run = folder.line(&format!("quality in {options}"));
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{options}");
        assert_holds(&run.err, &[part]);
    }
}

#[test]
fn several_meshes_stand_in_one_table() {
    let folder = small();
    folder.line("in a-long-name-of-a-mesh --engine cpu").clean();
    let text = folder.line("quality in a-long-name-of-a-mesh.node").clean().out;
    let rows: Vec<&str> = text.lines().skip_while(|row| *row != "shape").take(3).collect();
    assert!(rows[1].starts_with("  in  ") && rows[2].starts_with("  ...-a-mesh.node "), "{text}");
    let means = [1, 2].map(|i| numbers(rows[i])[3]);
    assert!(means[1] > means[0], "{text}");
    assert_holds(&text, &["\n== in\n", "\n== a-long-name-of-a-mesh.node\n"]);
    let told = json(&folder, "quality in a-long-name-of-a-mesh --json");
    assert_eq!(
        (&told[0]["file"], &told[1]["file"]),
        (&"in".into(), &"a-long-name-of-a-mesh".into())
    );
    let csv = folder.line("quality in a-long-name-of-a-mesh --csv").clean().out;
    assert_eq!(csv.lines().count(), 1 + 2 * Measure::ALL.len());
    let run = folder.line("quality in none");
    assert_eq!(run.code, Some(3));
    assert!(run.out.starts_with("in: Triangle"), "{}", run.out);
    assert_holds(&run.err, &["none: "]);
}

#[test]
fn regions_have_statistics_of_their_own() {
    let mesh = disturbed();
    let regions: Vec<[i32; 2]> = (0..160).map(|t| if t < 60 { [4, 7] } else { [2, 7] }).collect();
    let files = support::write_regions(&mesh, &regions);
    let folder = Folder::new(&[]);
    for (name, bytes) in &files[0] {
        fs::write(folder.path(name), bytes).unwrap();
    }
    let input = files[0][0].0;
    let told = json(&folder, &format!("quality {input} --by-region --json"));
    let counts: Vec<_> =
        told["regions"].as_array().unwrap().iter().map(|r| &r["triangles"]).collect();
    assert_eq!(counts, [60, 100]);
    let file = MeshFile::read(&folder.path(input)).unwrap();
    let topology = Topology::new(&mesh).unwrap();
    let shapes = Measured::new(file.points(), &topology).unwrap().values(Measure::Shape);
    for (i, range) in [0..60, 60..160].into_iter().enumerate() {
        let first = file.triangle_location(range.start);
        let list = first.path.file_name().unwrap().display();
        let region = &told["regions"][i];
        assert_eq!(region["first_triangle"], first.id);
        let least = shapes[range.clone()].iter().copied().fold(1.0, f64::min);
        assert!((number(&region["measures"]["shape"]["min"]) / least - 1.0).abs() < 1e-12);
        // The group's name in the spelling for `--only`.
        let groups = file.groups().unwrap();
        let names = region["groups"].as_array().unwrap().iter().map(|name| name.as_str().unwrap());
        let mut found = names.map(|name| (name, groups.find(name).unwrap()));
        let (group, found) =
            found.find(|(_, found)| found.triangles().len() == range.len()).unwrap();
        let only = folder.line(&format!("{input} out --only {group} --engine cpu"));
        assert_holds(&only.err, &[&format!("--only {group} (")]);
        let text = folder.line(&format!("quality {input} --by-region")).clean().out;
        assert_holds(
            &text,
            &[
                "\nshape by region\n",
                &format!("\n{group} "),
                &format!("\nregion {}: ", i + 1),
                &format!(" {group} ({} {})", found.kind, found.dimension_name()),
                &format!("; {} triangles, the first at ", range.len()),
                &format!("the first at {list}{}\n", first.location),
            ],
        );
    }
    let csv = folder.line(&format!("quality {input} --by-region --csv")).clean().out;
    assert_eq!(
        csv.lines().filter(|row| row.starts_with(&format!("{input},2,"))).count(),
        Measure::ALL.len()
    );
    assert_holds(csv.lines().next().unwrap(), &[",p95,groups"]);
    // A group with a name is listed by name, not by tag.
    let named = support::write_msh22(&mesh)
        .replace("$Nodes", "$PhysicalNames\n1\n2 1 \"outer wall\"\n$EndPhysicalNames\n$Nodes");
    fs::write(folder.path("named.msh"), named).unwrap();
    let text = folder.line("quality named.msh --by-region").clean().out;
    let rows = ["\nouter wall ", "\nregion 1: outer wall (physical surface)"];
    assert_holds(&text, &rows);
    // A mesh without regions is one region.
    let folder = small();
    assert_holds(
        &folder.line("quality in --by-region").clean().out,
        &["\nregion 1: 160 triangles"],
    );
}

/// Two regions of one group cannot both have its name.
#[test]
fn each_row_of_regions_has_a_name_that_selects_the_region() {
    let mesh = disturbed();
    let regions: Vec<[i32; 2]> = (0..160).map(|t| if t < 60 { [4, 7] } else { [4, 8] }).collect();
    let files = support::write_regions(&mesh, &regions);
    let msh = files.iter().find(|files| files[0].0.ends_with(".msh")).unwrap();
    let folder = Folder::new(&[]);
    fs::write(folder.path("in.msh"), &msh[0].1).unwrap();
    let text = folder.line("quality in.msh --by-region -m shape").clean().out;
    let rows: Vec<&str> = text.split("shape by region\n").nth(1).unwrap().lines().collect();
    for (row, triangles) in rows[1..3].iter().zip([60, 100]) {
        let name = row.split_whitespace().next().unwrap();
        let groups = json(&folder, "groups in.msh --json");
        let named = |group: &&Value| group["group"] == name;
        let group = groups["groups"].as_array().unwrap().iter().find(named).unwrap();
        assert_eq!(group["triangles"], triangles, "{text}");
    }
}

#[test]
fn the_option_of_measures_narrows_the_tables() {
    let folder = small();
    let line = "quality in -m size-ratio,min-angle,size-ratio";
    let text = folder.line(line).clean().out;
    let table = text.split("\n\n").nth(1).unwrap();
    let names: Vec<_> = table.lines().skip(1).map(|row| row.split(' ').next().unwrap()).collect();
    assert_eq!(names, ["size-ratio", "min-angle"], "{text}");
    let told = json(&folder, &format!("{line} --json"));
    assert_eq!(told["measures"].as_object().unwrap().len(), 2);
    assert_eq!(folder.line(&format!("{line} --csv")).clean().out.lines().count(), 3);
    // A measure that is asked for has a row, though another measure has equal values.
    let text = folder.line("quality in -m imr").clean().out;
    assert_holds(&text, &["\nimr  "]);
    assert!(!text.contains("Not listed"), "{text}");
    assert_holds(&text, &["\nf imr, ar  "]);
}

/// A mesh in coordinates of UTM, in meters, is millions of meters from the origin.
#[test]
fn places_of_the_worst_triangles_have_digits_for_the_size_of_the_triangle() {
    let mut mesh = disturbed();
    mesh.points.iter_mut().for_each(|point| *point = [500_000.0 + point[0], 6.7e6 + point[1]]);
    let [node, ele] = support::triangle_text(&mesh, "made for a test");
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    let told = json(&folder, "quality in --json --worst 1");
    let corners = told["worst"][0]["corners"].as_array().unwrap();
    let text = folder.line("quality in --worst 1").clean().out;
    let place = text.split("; at ").nth(1).unwrap().split(';').next().unwrap();
    for (axis, word) in place.split(' ').enumerate() {
        let middle = corners.iter().map(|corner| number(&corner[axis]) / 3.0).sum::<f64>();
        let told: f64 = word.parse().unwrap();
        assert!((told - middle).abs() < 0.002, "{told} for {middle}");
    }
}

#[test]
fn defects_are_counted() {
    let [node, ele] = INVERTED;
    // The center moves onto a corner, and no triangle uses the sixth vertex.
    let node = node.replace("5 2 0 0", "6 2 0 0").replace("1.5 0.5", "1 1") + "6 9 9\n";
    let folder = Folder::new(&[("in.node", &node), ("in.ele", ele)]);
    let told = json(&folder, "quality in --json");
    let keys = ["inverted", "flat", "duplicate_vertices", "unused_vertices"];
    assert_eq!(keys.map(|key| told[key].as_u64().unwrap()), [2, 2, 1, 1]);
    let angle = &told["measures"]["min-angle"];
    assert_eq!((number(&angle["min"]), number(&angle["max"])), (0.0, 45.0));
    assert!(told["measures"]["condition"]["mean"].is_null());
    let text = folder.line("quality in").clean().out;
    let row = |start: &str| text.lines().find(|row| row.starts_with(start)).unwrap();
    for (start, count) in [("duplicate vertices", 1.0), ("unused vertices", 1.0), ("flat", 2.0)] {
        assert_eq!(numbers(row(start)), [count]);
    }
    assert_holds(row("condition"), &[" infinite"]);
}

/// Two squares share an edge. The right square has a vertex in the middle of the edge, the left square has
/// none.
#[test]
fn hanging_nodes_are_counted_and_the_first_is_named() {
    let hanging = "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 1 1 0\nND 4 0 1 0\nND 5 .4 .5 0\nND 6 2 0 0\nND 7 2 1 0\nND 8 1 .5 0\n\
                   ND 9 1.6 .5 0\nE3T 1 1 2 5 1\nE3T 2 2 3 5 1\nE3T 3 3 4 5 1\nE3T 4 4 1 5 1\nE3T 5 2 6 9 1\nE3T 6 6 7 9 1\n\
                   E3T 7 7 3 9 1\nE3T 8 3 8 9 1\nE3T 9 8 2 9 1\n";
    let whole = hanging.replace("E3T 2 2 3 5 1\n", "E3T 2 2 8 5 1\nE3T 10 8 3 5 1\n");
    let folder = Folder::new(&[("in.2dm", hanging), ("whole.2dm", &whole)]);
    let told = "1 hanging node: vertex 8 (in.2dm:9) is inside the edge between vertices 2 and 3; the mesh is open there";
    let run = folder.line("in.2dm out.2dm --engine cpu");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_holds(&run.err, &[told]);
    assert_holds(&folder.line("quality in.2dm").out, &[told]);
    let count = |name: &str| {
        let json = folder.line(&format!("quality {name} --json")).out;
        serde_json::from_str::<serde_json::Value>(&json).unwrap()["hanging_nodes"].clone()
    };
    assert_eq!([count("in.2dm"), count("whole.2dm")], [1, 0]);
    assert!(!folder.line("whole.2dm out.2dm --engine cpu").err.contains("hanging"));
}

#[cfg(target_os = "linux")]
#[test]
fn on_a_terminal_bars_are_of_blocks_unless_it_is_dumb() {
    let folder = small();
    let program = env!("CARGO_BIN_EXE_gpu-smooth");
    for (term, locale, blocks) in
        [("xterm", "C.UTF-8", true), ("dumb", "C.UTF-8", false), ("xterm", "C", false)]
    {
        let mut command = std::process::Command::new("script");
        command.current_dir(&folder.0).env("TERM", term).env("LC_ALL", locale);
        command.args(["-qec", &format!("{program} quality in"), "/dev/null"]);
        command.stdin(std::process::Stdio::null());
        let output = command.output().expect("script, of util-linux, makes a terminal");
        let text = String::from_utf8(output.stdout).unwrap();
        assert_holds(&text, &["min-angle"]);
        assert_eq!((text.contains('█'), text.is_ascii()), (blocks, !blocks), "{text}");
    }
}

#[test]
fn a_mesh_that_cannot_be_read_does_not_hide_the_others() {
    let folder = small();
    fs::write(folder.path("broken.su2"), "NDIME= 3\n").unwrap();
    let run = folder.line("quality none.msh in.node broken.su2 --threshold min-angle<90");
    assert_eq!(run.code, Some(3));
    assert_holds(&run.err, &["in.node: 1", "have min-angle<90"]);
    assert_holds(&run.out, &["in.node: Triangle", "160 triangles"]);
    assert_holds(&run.err, &["error: none.msh: ", "error: broken.su2"]);
    assert_eq!(folder.line("quality none.msh broken.su2").out, "");
}

#[test]
fn a_mistyped_command_is_told_from_a_missing_mesh() {
    let folder = small();
    for ending in ["node", "ele"] {
        fs::copy(folder.path(&format!("in.{ending}")), folder.path(&format!("benches.{ending}")))
            .unwrap();
    }
    for (line, name) in [
        ("qualtiy in.node", "quality"),
        ("comvert in.node", "convert"),
        ("Quality in.node", "quality"),
        ("tyr in.node", "try"),
        // A run would not accept these command lines either.
        ("qualtiy", "quality"),
        ("qualtiy in.node --by-region", "quality"),
        ("-q comapre in.node a.node b.node", "compare"),
        ("in.nod x", ""),
        ("groupings", ""),
        ("benches", ""),
        ("benches out --nonsense", ""),
    ] {
        let run = folder.line(line);
        let remedy = format!("There is a command `{name}`");
        assert_eq!(run.err.contains(&remedy), !name.is_empty(), "{line}: {}", run.err);
        assert_ne!(run.code, Some(0), "{line}");
    }
    // The mesh of Triangle resembles a command.
    folder.line("benches out --engine cpu -q").clean();
}
