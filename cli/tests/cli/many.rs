//! Batches: `gpu-smooth MESH... --out-dir DIR`.

use super::{Folder, Run, assert_holds, disturbed, number};
use serde_json::Value;
use std::fs;

/// Returns a folder with Triangle and gmsh meshes, and a file without a mesh.
fn several() -> Folder {
    let [node, ele] = support::triangle_text(&disturbed(), "made for a test");
    let gmsh = support::write_msh22(&disturbed());
    Folder::new(&[
        ("a.1.node", &node),
        ("a.1.ele", &ele),
        ("b.msh", &gmsh),
        ("c.msh", &gmsh),
        ("none.msh", "hello\n"),
    ])
}

fn names(folder: &Folder, directory: &str) -> Vec<String> {
    let entries = fs::read_dir(folder.path(directory)).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn json(run: &Run) -> Value {
    serde_json::from_str(&run.out).unwrap_or_else(|error| panic!("{error}: {}", run.out))
}

const ALL: &str = "a.1.ele a.1.node b.msh c.msh none.msh";

#[test]
fn each_mesh_ends_as_in_a_run_by_itself_and_a_bad_one_stops_none() {
    let folder = several();
    for engine in ["cpu", "gpu"] {
        let line = format!("{ALL} --out-dir {engine} --engine {engine} --report {engine}.json");
        let run = folder.line(&line);
        assert_eq!(run.code, Some(1), "{}", run.err);
        assert_holds(&run.err, &["error: 1 of 4 meshes failed\n  none.msh: the format is not"]);
        assert_eq!(run.err.lines().count(), 2, "{}", run.err);
        assert_holds(&run.out, &["\na.1.ele ", "\nc.msh ", "\nnone.msh ", "  failed\n"]);
        let columns = |line: &str| line.split_whitespace().count();
        assert!(run.out.lines().skip(1).take(3).all(|line| columns(line) == 8), "{}", run.out);
        assert_holds(&run.out, &["\n3 smoothed, 1 failed of 4 meshes; 297 vertices in "]);
        assert_eq!(names(&folder, engine), ["a.1.ele", "a.1.node", "b.msh", "c.msh"]);

        let report = folder.json(&format!("{engine}.json"));
        for (i, mesh) in ["a.1.ele", "b.msh", "c.msh"].iter().enumerate() {
            let alone = format!("alone-{mesh}");
            folder.line(&format!("{mesh} {alone} --engine {engine} --report alone.json")).clean();
            let [found, expected] = [&format!("{engine}/{mesh}"), &alone];
            assert!(folder.mesh(found).points == folder.mesh(expected).points, "{mesh}");
            let (told, alone) = (&report["meshes"][i], folder.json("alone.json"));
            assert_eq!((&told["mesh"], &told["status"]), (&(*mesh).into(), &"smoothed".into()));
            for key in ["mesh", "sweeps", "stop", "before", "after", "history"] {
                assert_eq!(told["report"][key], alone[key], "{mesh}: {key}");
            }
        }
        assert_eq!(report["meshes"][3]["status"], "failed");
        let error = report["meshes"][3]["error"].as_str().unwrap();
        assert_holds(error, &["none.msh: the format is not recognized"]);
    }
}

#[test]
fn each_mesh_has_a_line_with_what_is_beyond_the_limits_of_a_solver() {
    let folder = several();
    let run = folder
        .line("a.1.node b.msh --out-dir out --for dflowfm --engine cpu --report r.json")
        .clean();
    let table = run.out.split("\n\nlimits of dflowfm").nth(1).unwrap();
    let rows: Vec<Vec<&str>> =
        table.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(rows[0], ["failed", "after", "warned", "after", "verdict"]);
    let report = folder.json("r.json");
    let list =
        json(&folder.line("a.1.node b.msh --out-dir again --for dflowfm --engine cpu --json"));
    for (i, row) in rows[1..3].iter().enumerate() {
        let profile = &report["meshes"][i]["report"]["profile"];
        let sum = |state: &str, key: &str| {
            let limits = profile[state]["limits"].as_array().unwrap().iter();
            limits.map(|limit| limit[key].as_u64().unwrap()).sum::<u64>()
        };
        let columns =
            [("failed", "before"), ("failed", "after"), ("warned", "before"), ("warned", "after")];
        for (column, (key, state)) in (1..).zip(columns) {
            assert_eq!(row[column], sum(state, key).to_string());
            assert_eq!(list[i][format!("{key}_{state}")], sum(state, key));
        }
        assert!(sum("before", "warned") > sum("after", "warned"));
        assert_eq!(row[5], profile["after"]["verdict"]);
        assert_eq!(list[i]["verdict"], row[5]);
    }
    let plain = folder.line("a.1.node --out-dir plain --engine cpu").clean().out;
    assert!(!plain.contains("limits of"), "{plain}");
}

#[test]
fn the_table_is_printed_as_csv_and_json_too() {
    let folder = several();
    let line = format!("{ALL} --out-dir out --engine cpu");
    let csv = folder.line(&format!("{line} --csv"));
    let list = folder.line(&format!("{line} --json"));
    assert_eq!((csv.code, list.code), (Some(1), Some(1)));
    let list = json(&list);
    let mut rows = csv.out.lines();
    let keys: Vec<&str> = rows.next().unwrap().split(',').collect();
    for (row, object) in rows.by_ref().zip(list.as_array().unwrap()) {
        let row: Vec<&str> = row.splitn(keys.len(), ',').collect();
        assert_eq!((row.len(), object.as_object().unwrap().len()), (keys.len(), keys.len()));
        for (key, field) in keys.iter().zip(row).filter(|(key, _)| **key != "seconds") {
            let value = match &object[*key] {
                Value::Null => String::new(),
                Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            assert_eq!(field.trim_matches('"'), value, "{key}");
        }
    }
    assert_eq!(rows.next(), None);
    assert_eq!((&list[1]["mesh"], &list[1]["stop"]), (&"b.msh".into(), &"converged".into()));
    let f = |key: &str| number(&list[1][key]);
    assert!((f("f_before") / support::f_imr(&folder.mesh("b.msh")) - 1.0).abs() < 1e-9);
    assert!((f("f_after") / support::f_imr(&folder.mesh("out/b.msh")) - 1.0).abs() < 1e-9);
    let problem = list[3]["problem"].as_str().unwrap();
    assert_holds(problem, &["none.msh: the format is not recognized"]);
}

#[test]
fn strict_makes_it_an_error_that_a_run_falls_short() {
    let folder = several();
    let call = |options: &str| {
        folder.line(&format!("b.msh c.msh --out-dir out --engine cpu -q --strict {options}"))
    };
    call("").clean();
    let short = call("--max-sweeps 1");
    assert_eq!(short.code, Some(1));
    assert_holds(&short.err, &["2 of 2 runs neither converged nor reached their goal; --strict"]);
    assert_eq!(names(&folder, "out"), ["b.msh", "c.msh"]);
}

#[test]
fn a_call_of_many_meshes_is_resumed() {
    let folder = several();
    let line = "a.1.node b.msh c.msh --out-dir out --engine cpu --resume";
    assert_holds(&folder.line(line).clean().out, &["\n3 smoothed of 3 meshes"]);
    let bytes = |name: &str| fs::read(folder.path(name)).unwrap();
    fs::remove_file(folder.path("out/a.1.ele")).unwrap();
    fs::write(folder.path("out/c.msh"), "what newer files hold is not looked at").unwrap();
    assert_holds(&folder.line(line).clean().out, &["\n1 smoothed, 2 skipped of 3 meshes"]);
    assert_eq!(names(&folder, "out"), ["a.1.ele", "a.1.node", "b.msh", "c.msh"]);
    // A mesh that has changed since its result was written is smoothed again.
    fs::write(folder.path("c.msh"), bytes("b.msh")).unwrap();
    assert_holds(&folder.line(line).clean().out, &["\n1 smoothed, 2 skipped of 3 meshes"]);
    assert!(bytes("out/c.msh") == bytes("out/b.msh"));
    assert_holds(&folder.line(line).clean().out, &["\n3 skipped of 3 meshes; 0 vertices"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_triangle_mesh_with_endings_of_a_capital_first_is_skipped_once_it_is_done() {
    let folder = super::small();
    for (from, to) in [("in.node", "A.Node"), ("in.ele", "A.Ele")] {
        fs::rename(folder.path(from), folder.path(to)).unwrap();
    }
    for name in ["A.Node", "A.Ele"] {
        let line = format!("{name} --out-dir out --engine cpu --resume");
        let done =
            if name == "A.Node" { "\n1 smoothed of 1 mesh" } else { "\n1 skipped of 1 mesh" };
        assert_holds(&folder.line(&line).clean().out, &[done]);
        assert_holds(&folder.line(&line).clean().out, &["\n1 skipped of 1 mesh"]);
    }
    assert_eq!(names(&folder, "out"), ["A.Ele", "A.Node"]);
}

#[test]
fn files_that_would_be_overwritten_are_listed_before_any_work() {
    let folder = several();
    fs::create_dir(folder.path("other")).unwrap();
    fs::copy(folder.path("b.msh"), folder.path("other/b.msh")).unwrap();
    for (line, part) in [
        ("b.msh --out-dir c.msh", "c.msh: the directory cannot be made"),
        ("b.msh --out-dir out --adapter none-of-this-name", "no GPU adapter"),
    ] {
        folder.line(line).refused(&[part]);
    }
    for (line, part) in [
        ("b.msh other/b.msh --out-dir out", "b.msh and other/b.msh would both be written to out"),
        ("b.msh c.msh --out-dir .", "the mesh itself would be replaced. Give another directory"),
        ("b.msh other/../c.msh --out-dir other/..", "the mesh itself would be replaced"),
        ("b.msh --out-dir out --report c.msh", "c.msh: the report is JSON"),
        ("b.msh --out-dir out --report out/b.msh", "b.msh: the report is JSON"),
        ("b.msh - --out-dir out", "-: not a file. --out-dir"),
        ("b.msh other --out-dir out", "other: not a file. --out-dir"),
    ] {
        folder.line(line).misused(&[part]);
    }
    assert!(!folder.path("out/b.msh").exists());
    let text = folder.text("b.msh");
    assert!(text == folder.text("other/b.msh") && text == folder.text("c.msh"));
}

#[test]
fn options_for_one_mesh_are_refused_with_many() {
    let folder = several();
    for (options, part) in [
        ("--picture a.png", "--picture"),
        ("--resume --untangle --keep-going", "--keep-going"),
        ("--csv --json", "--json"),
    ] {
        let run = folder.line(&format!("b.msh c.msh --out-dir out {options}"));
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{options}");
        assert_holds(&run.err, &[part]);
    }
    for option in ["--resume", "--csv", "--json"] {
        let run = folder.line(&format!("b.msh c.msh {option}"));
        assert_eq!(run.code, Some(2));
        assert_holds(&run.err, &["--out-dir <DIR>"]);
    }
}

/// For a mesh that cannot be smoothed, the report lists all its bad triangles.
#[test]
fn a_tangled_mesh_fails_or_is_untangled() {
    let folder = several();
    let [node, ele] = super::output::INVERTED;
    fs::write(folder.path("t.node"), node).unwrap();
    fs::write(folder.path("t.ele"), ele).unwrap();
    let run = folder.line("t.node b.msh --out-dir out --engine cpu --report r.json -q");
    assert_eq!((run.code, run.out.as_str()), (Some(1), ""));
    assert_holds(&run.err, &["1 of 2 meshes failed\n  t.ele:3: triangle 2", "--untangle"]);
    let failed = &folder.json("r.json")["meshes"][0];
    assert_eq!(failed["triangles"][0]["line"], 3);
    folder.line("t.node b.msh --out-dir out --engine cpu --untangle").clean();
    assert_eq!(support::worst_imr(&folder.mesh("out/t")).max(2.0), 2.0);
}

#[test]
fn verbose_tells_each_mesh_as_it_is_done() {
    let folder = several();
    let run = folder.line(&format!("{ALL} --out-dir out --engine cpu -v"));
    for mesh in ["a.1.ele: converged, ", "b.msh: converged, ", "none.msh: none.msh: the format"] {
        assert_holds(&run.err, &[mesh]);
    }
    assert_holds(&run.err, &["gpu-smooth: 4 of 4: ", " sweeps, f imr 4.3"]);
}

/// The error of the report hid the table and the failed meshes.
#[cfg(target_os = "linux")]
#[test]
fn a_report_that_cannot_be_written_hides_no_failure() {
    let folder = several();
    let run = folder.line("b.msh none.msh --out-dir out --engine cpu --report /dev/full");
    assert_eq!(run.code, Some(4), "{}", run.err);
    assert_holds(&run.err, &["none.msh", "/dev/full"]);
    assert_holds(&run.out, &["b.msh"]);
    assert_eq!(names(&folder, "out"), ["b.msh"]);
}

/// The notes on the meshes of a batch were in the report alone.
#[test]
fn each_distinct_note_is_printed_once_with_the_number_of_its_meshes() {
    let mut gmsh = support::write_msh22(&disturbed());
    let count = disturbed().points.len();
    let depths: Vec<String> = (1..=count).map(|v| format!("{v} {v}.5\n")).collect();
    gmsh += &format!(
        "$NodeData\n1\n\"depth\"\n1\n0.0\n3\n0\n1\n{count}\n{}$EndNodeData\n",
        depths.concat()
    );
    let folder = several();
    for name in ["c.msh", "d.msh", "e.msh"] {
        fs::write(folder.path(name), &gmsh).unwrap();
    }
    let alone = folder.line("d.msh alone.msh --engine cpu").err;
    let note = alone.strip_prefix("gpu-smooth: ").unwrap().trim_end();
    assert_holds(note, &["depth"]);
    let one = format!("c.msh: {note}");
    let three = format!("{note} (3 of 4 meshes; the first is c.msh)");
    let batch = "--out-dir out --engine cpu --force";
    let run = folder.line(&format!("b.msh c.msh {batch}"));
    assert_eq!(run.err.lines().last(), Some(&*format!("gpu-smooth: {one}")));
    let run = folder.line(&format!("b.msh c.msh d.msh e.msh {batch}"));
    assert_eq!(
        run.err.lines().filter(|line| line.contains("depth")).collect::<Vec<_>>(),
        [format!("gpu-smooth: {three}")]
    );
    let run = folder.line(&format!("b.msh c.msh d.msh e.msh {batch} --log json"));
    let events = run.err.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let notes: Vec<Value> = events.filter(|event| event["event"] == "note").collect();
    assert_eq!(notes.len(), 1, "{}", run.err);
    assert_eq!(notes[0]["message"], three);
    let quiet = folder.line(&format!("b.msh c.msh {batch} -q"));
    assert_eq!(quiet.err, "");
}
