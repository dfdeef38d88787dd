//! Printed text, and its absence with `--quiet`.

use super::{Folder, assert_holds, finish, number, plate_path, small};
use gpu_smooth::Metric;
use mesh_io::MeshFile;
use std::fs;
use std::process::Stdio;

/// A square with the center vertex moved out to the right, which inverts triangle 2.
pub(crate) const INVERTED: [&str; 2] = [
    "5 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n5 1.5 0.5\n",
    "4 3 0\n1 1 2 5\n2 2 3 5\n3 3 4 5\n4 4 1 5\n",
];

#[test]
fn quality_prints_what_the_report_says() {
    let folder = small();
    folder.line("in out --engine cpu --report r.json").clean();
    let report = folder.json("r.json");
    for (mesh, state) in [("in", "before"), ("out.node", "after")] {
        let out = folder.line(&format!("quality {mesh} --json")).clean().out;
        let told: serde_json::Value = serde_json::from_str(&out).unwrap();
        let counts = ["vertices", "triangles", "free"].map(|key| &told[key]);
        assert_eq!(counts, ["vertices", "triangles", "free"].map(|key| &report["mesh"][key]));
        for (key, value) in report[state].as_object().unwrap() {
            assert_eq!(&told[key], value, "{key}");
        }
        let oracle = support::f_imr(&folder.mesh(mesh));
        assert!((number(&told["f"]["imr"]) / oracle - 1.0).abs() < 1e-9);

        let text = folder.line(&format!("quality {mesh}")).clean().out;
        assert_holds(&text, &["99 vertices (63 free), 160 triangles\n", "\ninverted or flat"]);
        // Without names of measures, imr stands for the metrics of runs. Metrics with equal objectives share a row.
        let rows_of_f = text.lines().filter(|row| row.starts_with("f ")).count();
        assert!(rows_of_f == 1 && text.contains("\nf imr "), "{text}");
        let text = folder.line(&format!("quality {mesh} -m shape")).clean().out;
        let rows = text.lines().filter_map(|row| row.strip_prefix("f ")?.split("  ").next());
        let names: Vec<&str> = rows.flat_map(|names| names.split(", ")).collect();
        let mut expected: Vec<&str> = Metric::ALL.iter().map(|metric| metric.name()).collect();
        expected.sort_by_key(|name| names.iter().position(|other| other == name));
        assert_eq!(names, expected);
        let worst = text.lines().find(|row| row.starts_with("worst imr")).unwrap();
        assert_holds(worst, &["triangle ", &format!("{}.ele:", mesh.trim_end_matches(".node"))]);
    }
    assert_eq!(folder.content().len(), 5);
}

#[test]
fn quality_counts_inverted_triangles() {
    let [node, ele] = INVERTED;
    let flat = node.replace("1.5 0.5", "1 0.5");
    for node in [node, &flat] {
        let folder = Folder::new(&[("in.node", node), ("in.ele", ele)]);
        let text = folder.line("quality in.node").clean().out;
        let row = |start: &str| text.lines().find(|row| row.starts_with(start)).unwrap();
        assert!(row("inverted or flat").ends_with(" 1"), "{text}");
        assert!(row("f imr").ends_with(" infinite"), "{text}");
        assert_holds(row("worst imr"), &["infinite", "triangle 2 (in.ele:3)"]);
        let json = folder.line("quality in.node --json").clean().out;
        let told: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!((&told["inverted"], &told["free"]), (&1.into(), &1.into()));
        assert!(told["f"]["imr"].is_null() && told["f"]["edge"].is_number());
    }
}

#[test]
fn quality_needs_no_free_vertex() {
    let folder =
        Folder::new(&[("m.node", "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n"), ("m.ele", "1 3 0\n1 1 2 3\n")]);
    let text = folder.line("quality m").clean().out;
    assert_holds(&text, &["3 vertices (0 free)", "\nmin-angle \u{b0} ", " 45.000"]);
    assert!(!text.contains("movable"), "{text}");
}

/// The small mesh with a `.poly` that makes the run print a note.
fn small_with_poly() -> Folder {
    let folder = small();
    fs::write(folder.path("in.poly"), "0 2 0 0\n1 0\n1 50 51\n0\n").unwrap();
    folder
}

#[test]
fn vertices_held_by_the_file_are_remarked() {
    let folder = small_with_poly();
    let remark = "1 segment of in.poly: its vertices stay fixed\n";
    let out = folder.line("quality in").clean().out;
    assert_holds(&out, &["in: Triangle .node/.ele\n", remark, "\n99 vertices (61 free)"]);
    let run = folder.line("in out --engine cpu");
    assert_eq!((run.code, run.err), (Some(0), format!("gpu-smooth: {remark}")));
}

#[test]
fn metrics_lists_every_metric() {
    let out = Folder::new(&[]).line("metrics").clean().out;
    for metric in Metric::ALL {
        assert!(out.lines().any(|line| line.starts_with(&format!("{:<10} q = ", metric.name()))));
        assert_holds(&out, &[metric.formula(), metric.purpose(), metric.citation()]);
    }
}

#[test]
fn quiet_prints_nothing() {
    let folder = small_with_poly();
    for quiet in ["-q", "--quiet"] {
        for engine in ["auto", "gpu", "cpu"] {
            let line = format!("in out {quiet} --engine {engine} --report r.json");
            assert_eq!(folder.line(&line).clean().out, "");
        }
    }
    folder.line("none out -q --engine cpu").refused(&["none: "]);
}

#[test]
fn a_worst_element_that_got_worse_is_reported_with_a_remedy() {
    let folder = Folder::new(&[]);
    let plate = plate_path().to_str().unwrap();
    let out = folder.run([plate, "good", "--engine", "cpu"]).clean().out;
    assert!(!out.contains(" rose "), "{out}");
    // A graded mesh, whose shapes become worse as sizes become even.
    let file = MeshFile::read(&folder.path("good.node")).unwrap();
    let graded = |&[x, y]: &[f64; 2]| [x * x.hypot(y), y * x.hypot(y)];
    let points: Vec<_> = file.points().iter().map(graded).collect();
    file.write(&folder.path("graded"), &points).unwrap();
    let line = "graded out --engine cpu --scheme shape-size --max-sweeps 30 --report r.json";
    let out = folder.line(line).clean().out;
    let report = folder.json("r.json");
    let [before, after] = ["before", "after"].map(|key| number(&report[key]["worst_movable_imr"]));
    assert!(after > 1.01 * before);
    let told = format!("\nworst imr rose from {before:.4}");
    assert_holds(
        &out,
        &[
            &told[..told.len() - 1],
            " to ",
            ": f is a mean, which may fall as one element gets worse",
        ],
    );
}

#[test]
fn verbose_prints_every_sweep() {
    let folder = small();
    for engine in ["gpu", "cpu"] {
        let line = format!(
            "in out --engine {engine} -v --scheme edge+imr --method relaxed --report r.json"
        );
        let out = folder.line(&line).clean().out;
        let sweeps = folder.json("r.json")["sweeps"].as_u64().unwrap() as usize;
        let rows: Vec<_> = out.lines().take_while(|row| row.starts_with("sweep ")).collect();
        assert_eq!(rows.len(), sweeps + 1);
        for (i, row) in rows.iter().enumerate() {
            let words: Vec<_> = row.split_whitespace().collect();
            let metric = if i == 0 { "-" } else { ["imr", "edge"][i % 2] };
            assert_eq!(words[..4], ["sweep", &i.to_string(), metric, "f"]);
            assert!(words[4].parse::<f64>().unwrap() >= 1.0);
        }
        assert_holds(&out, &["\n99 vertices (63 free, ", "\nf edge ", "\nf imr "]);
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = small();
    // The exit code is that of SIGPIPE, which ends usual programs. A help text is short, and its reader has all of it.
    let lines = ["quality in", "metrics", "adapters", "in out -v --engine cpu", "--help"];
    for (line, code) in lines.into_iter().zip([141, 141, 141, 141, 0]) {
        let mut command = folder.command();
        command.args(line.split(' ')).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), err.as_str()), (Some(code), ""), "{line}");
    }
    assert_ne!(folder.text("in.node"), folder.text("out.node"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_under_standard_output_is_an_error() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let folder = small();
    let mut command = folder.command();
    let child = command.args(["quality", "in"]).stdout(full).stderr(Stdio::piped()).spawn();
    let output = child.unwrap().wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), err.lines().count()), (Some(4), 1), "{err}");
    assert_holds(&err, &["gpu-smooth: error: standard output: "]);
}

#[test]
fn no_bar_is_drawn_where_there_is_no_terminal() {
    let folder = Folder::new(&[]);
    for sweeps in [250, 1000, 4000, 16_000] {
        let mut command = folder.command();
        command.arg(plate_path()).args(["out", "--engine", "cpu", "--tolerance", "0"]);
        command.args(["--report", "r.json", "--max-sweeps", &sweeps.to_string()]);
        let run = finish(&mut command);
        assert_eq!(run.code, Some(0), "{}", run.err);
        // Standard error is not a terminal, so the program prints lines of progress.
        assert!(!run.err.contains(['\r', '\u{1b}']), "{}", run.err);
        assert!(run.err.lines().all(super::is_progress), "{}", run.err);
        // The run was long enough for a bar on a terminal.
        if number(&folder.json("r.json")["seconds"]["smooth"]) > 1.0 {
            return;
        }
    }
    panic!("no run took long enough");
}
