//! The content of the JSON report.

use std::collections::BTreeSet;

use super::{Folder, assert_holds, disturbed, number, plate_path, small};
use gpu_smooth::Metric;
use serde_json::Value;

#[track_caller]
fn assert_keys(value: &Value, keys: &[&str]) {
    let mut keys = keys.to_vec();
    keys.sort_unstable();
    let mut found: Vec<_> = value.as_object().unwrap().keys().collect();
    found.sort_unstable();
    assert_eq!(found, keys);
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value} is not a text"))
}

fn metrics() -> Vec<&'static str> {
    Metric::ALL.iter().map(|metric| metric.name()).collect()
}

#[test]
fn report_holds_the_documented_keys() {
    let folder = small();
    for engine in ["gpu", "cpu"] {
        folder.line(&format!("in out --engine {engine} --report r.json")).clean();
        let report = folder.json("r.json");
        assert_keys(
            &report,
            &[
                "schema_version",
                "program",
                "engine",
                "mesh",
                "scheme",
                "options",
                "sweeps",
                "corrections",
                "newton_steps",
                "newton_iterations",
                "opening_sweeps",
                "closing_sweeps",
                "held_back",
                "lost",
                "movable_f",
                "remaining",
                "levels_left_out",
                "best_sweep",
                "change",
                "spacing",
                "stop",
                "returned",
                "before",
                "after",
                "certificate",
                "history",
                "seconds",
            ],
        );
        assert_keys(&report["engine"], &["kind", "adapter", "driver", "reason"]);
        assert_eq!(report["engine"]["kind"], engine);
        for name in ["adapter", "driver"] {
            let of_gpu = engine == "gpu";
            assert_eq!((report["engine"][name].is_string(), of_gpu), (of_gpu, of_gpu));
            assert!(of_gpu || report["engine"][name].is_null());
        }
        assert_keys(&report["mesh"], &["format", "vertices", "triangles", "free", "colors"]);
        let mesh = &report["mesh"];
        let counts = ["vertices", "triangles", "free"].map(|key| mesh[key].as_u64().unwrap());
        assert_eq!(counts, [99, 160, 63]);
        assert!((3..10).contains(&mesh["colors"].as_u64().unwrap()));
        assert_eq!(
            (text(&mesh["format"]), text(&report["scheme"])),
            ("Triangle .node/.ele", "imr")
        );
        assert_eq!((text(&report["stop"]), &report["returned"]), ("converged", &Value::from(0)));
        assert_eq!(report["best_sweep"], report["sweeps"]);

        assert_keys(&report["change"], &["moved", "size", "least_altitude"]);
        for spread in ["moved", "size"] {
            let spread = &report["change"][spread];
            assert_keys(spread, &["median", "p95", "most"]);
            let [half, most] = ["median", "most"].map(|key| spread[key].as_f64().unwrap());
            assert!(0.0 < half && half <= most, "{spread}");
        }

        for state in ["before", "after"] {
            let quality = &report[state];
            assert_keys(
                quality,
                &["f", "min_angle", "max_angle", "worst_imr", "worst_movable_imr", "inverted"],
            );
            assert_keys(&quality["f"], &metrics());
            assert_eq!(quality["inverted"], 0);
            assert!((0.0..60.0).contains(&number(&quality["min_angle"])));
            assert!((60.0..180.0).contains(&number(&quality["max_angle"])));
            assert!(number(&quality["worst_imr"]) >= number(&quality["worst_movable_imr"]));
        }
        let of = |state: &str, key: &str| number(&report[state][key]);
        assert!(of("after", "min_angle") > of("before", "min_angle"));
        assert!(of("after", "worst_imr") < of("before", "worst_imr"));

        let parts = ["read", "prepare", "smooth", "write", "pictures"];
        assert_keys(&report["seconds"], &[&parts[..], &["total"]].concat());
        let seconds = |part| number(&report["seconds"][part]);
        let sum: f64 = parts.into_iter().map(seconds).sum();
        assert!(sum > 0.0 && (sum - seconds("total")).abs() < 1e-6);
        assert_eq!(seconds("pictures"), 0.0, "nothing was drawn");
    }
}

#[test]
fn the_total_time_of_a_run_includes_pictures_and_pages() {
    let folder = small();
    for drawings in ["--picture p.png", "--html p.html", "--picture p.svg --html p.html"] {
        let start = std::time::Instant::now();
        let line = format!("in out --engine cpu --force --report r.json {drawings}");
        let run = folder.line(&line).clean();
        let elapsed = start.elapsed().as_secs_f64();
        let seconds = &folder.json("r.json")["seconds"];
        let [pictures, total] = ["pictures", "total"].map(|part| number(&seconds[part]));
        let sum: f64 =
            ["read", "prepare", "smooth", "write"].map(|part| number(&seconds[part])).iter().sum();
        assert!(pictures > 0.0 && (sum + pictures - total).abs() < 1e-6, "{seconds}");
        assert!(total < elapsed, "{total} of {elapsed} s");
        let told = format!(", pictures {pictures:.3} s; total {total:.3} s");
        assert!(run.out.contains(&told), "no {told:?} in {}", run.out);
        if drawings.contains("html") {
            assert!(
                folder.text("p.html").contains("<span class=\"pictures key\"></span>pictures ")
            );
        }
    }
}

#[test]
fn history_holds_the_first_state_and_every_sweep() {
    let folder = small();
    for engine in ["gpu", "cpu"] {
        let line = format!(
            "in out --scheme edge+imr --method relaxed --max-sweeps 30 --tolerance 0 --engine {engine}"
        );
        folder.line(&format!("{line} --report base.json")).clean();
        folder.line(&format!("{line} --report all.json --history all")).clean();
        let [base, all] = ["base.json", "all.json"].map(|name| folder.json(name));
        let rows = base["history"].as_array().unwrap();
        assert_eq!((rows.len(), base["sweeps"].as_u64()), (31, Some(30)));
        for (i, row) in rows.iter().enumerate() {
            assert_keys(row, &["sweep", "metric", "f"]);
            assert_eq!(row["sweep"], i);
            let metric = [Value::from("imr"), Value::from("edge")][i % 2].clone();
            assert_eq!(row["metric"], if i == 0 { Value::Null } else { metric });
        }
        let f = |row: &Value| number(&row["f"]);
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-5;
        assert!(near(f(&rows[0]), number(&base["before"]["f"]["edge"])));
        let best = base["best_sweep"].as_u64().unwrap() as usize;
        assert!(near(f(&rows[best]), number(&base["after"]["f"]["edge"])));
        assert!(rows.iter().all(|row| f(row) >= f(&rows[best])));

        let all_rows = all["history"].as_array().unwrap();
        assert_eq!(all_rows.len(), rows.len());
        for (row, base_row) in all_rows.iter().zip(rows) {
            assert_keys(row, &["sweep", "metric", "f", "all"]);
            assert_keys(&row["all"], &metrics());
            assert_eq!((&row["f"], &row["all"]["edge"]), (&base_row["f"], &base_row["f"]));
        }
        assert!(near(number(&all_rows[0]["all"]["rms"]), number(&all["before"]["f"]["rms"])));
    }
}

#[test]
fn goal_is_in_the_report_of_a_run_that_has_one() {
    let folder = small();
    for (options, given) in [("--fraction 0.9", false), ("--desired 1.05 --fraction 0.8", true)] {
        folder.line(&format!("in out --engine cpu --report r.json {options}")).clean();
        let goal = &folder.json("r.json")["goal"];
        assert_keys(goal, &["fraction", "desired", "origin", "reached", "best_fraction"]);
        assert_eq!(goal["reached"], true);
        assert!(number(&goal["best_fraction"]) > number(&goal["fraction"]));
        assert_eq!(text(&goal["origin"]) == "given", given);
        assert_eq!(number(&goal["desired"]) == 1.05, given);
    }
}

/// Compares the report's certificate with the files, and the hashes with the output of another
/// program.
#[cfg(unix)]
#[test]
fn the_certificate_holds_of_the_files() {
    let folder = small();
    let files = ["in.node", "in.ele", "out.node", "out.ele"];
    for options in ["", "--scheme edge+imr", "--fix-box 0,0,3,3 -q", "--engine gpu"] {
        let engine = if options.contains("gpu") { "" } else { "--engine cpu" };
        folder.line(&format!("in out {options} {engine} --report r.json"));
        let report = folder.json("r.json");
        let certificate = &report["certificate"];
        let keys =
            ["connectivity_identical", "moved", "fixed_moved", "inverted", "f", "input", "output"];
        assert_keys(certificate, &keys);
        assert_eq!(certificate["connectivity_identical"], true);
        assert_eq!([&certificate["fixed_moved"], &certificate["inverted"]], [0, 0]);
        assert!(certificate["moved"].as_u64().unwrap() > 10);
        let base = if options.contains("edge") { "edge" } else { "imr" };
        let (read, told) = (number(&certificate["f"]), number(&report["after"]["f"][base]));
        assert!((read - told).abs() <= 1e-12 * told, "{read} was read, {told} was told");
        let sums =
            std::process::Command::new("sha256sum").args(files).current_dir(&folder.0).output();
        let sums = String::from_utf8(sums.unwrap().stdout).unwrap();
        let listed = certificate["input"].as_array().unwrap().iter();
        let listed = listed.chain(certificate["output"].as_array().unwrap());
        let mine: String = listed
            .map(|file| format!("{}  {}\n", text(&file["sha256"]), text(&file["path"])))
            .collect();
        assert_eq!(mine, sums);
        // `gpu-smooth compare`, which reads only the files, must print equal facts.
        let choice = if options.contains("box") { "--fix-box 0,0,3,3" } else { "" };
        let compared = folder.line(&format!("compare in out {choice}"));
        assert!(compared.out.contains(&sums), "{}{}", compared.out, compared.err);
    }
}

/// Returns the node and the element file of a lattice of right triangles, whose diagonals alternate from row to row. Any move
/// makes an angle sharper.
pub(super) fn right_triangles() -> [String; 2] {
    let (mut node, mut ele) = ("81 2 0 0\n".to_owned(), "128 3 0\n".to_owned());
    for v in 0..81 {
        node += &format!("{} {} {}\n", v + 1, v % 9, v / 9);
    }
    for square in 0..64 {
        let a = square / 8 * 9 + square % 8 + 1;
        let [b, c, d] = [a + 1, a + 10, a + 9];
        let cut = if square / 8 % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        for (half, [p, q, r]) in cut.into_iter().enumerate() {
            ele += &format!("{} {p} {q} {r}\n", 2 * square + half + 1);
        }
    }
    [node, ele]
}

#[test]
fn a_run_by_default_tells_why_the_mesh_stays_as_it_was() {
    let [node, ele] = right_triangles();
    let folder = Folder::new(&[("right.node", &node), ("right.ele", &ele)]);
    let run = folder.line("right out --engine cpu --report r.json").clean();
    assert_holds(
        &run.out,
        &[
            "no gain without a worse triangle, so the mesh is written unchanged",
            "the sweeps left a least angle of 3",
            "° (45.00° before)",
            "; 49 vertices went back to end at 45.00°",
        ],
    );
    let report = folder.json("r.json");
    assert_eq!(report["floored"]["returned"], 49);
    let [floored, after] = [&report["floored"], &report["after"]];
    for [one, other] in [
        [&floored["least_angle"][2], &after["min_angle"]],
        [&floored["worst_imr"][2], &after["worst_imr"]],
        [&floored["f"][1], &after["f"]["imr"]],
    ] {
        assert!((number(one) / number(other) - 1.0).abs() < 1e-12, "{one} and {other}");
    }
    let run = folder.line("right sharp --engine cpu --method multilevel --report r.json").clean();
    assert!(!run.out.contains("the sweeps left"), "{}", run.out);
    assert!(folder.json("r.json").get("floored").is_none());
}

/// Adds the path of each key of `value` to `found`: `[]` stands for the entries of a list of texts or objects, METRIC
/// for the name of a metric.
fn add_paths(path: &str, value: &Value, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let key = match key.as_str() {
                    key if metrics().contains(&key) => "METRIC",
                    _ if path == "options" => "OPTION",
                    key => key,
                };
                let path = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
                // docs/quality.md has the keys of a mesh beside the limits of a solver.
                if path.starts_with("profile.") {
                    found.insert(path);
                    continue;
                }
                add_paths(&path, value, found);
            }
        }
        Value::Array(values) if values.iter().any(|value| !value.is_number()) => {
            values.iter().for_each(|value| add_paths(&format!("{path}[]"), value, found));
        }
        _ => _ = found.insert(path.to_owned()),
    }
}

/// Returns the keys in the first column of the tables of docs/report.md.
fn documented() -> BTreeSet<String> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/report.md");
    let page = std::fs::read_to_string(path).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let keys = rows.flat_map(|row| row.split('|').nth(1).unwrap().split(','));
    keys.map(|key| key.trim().trim_matches('`').to_owned()).collect()
}

#[test]
fn every_key_of_a_report_is_documented_and_every_documented_key_is_in_a_report() {
    let folder = small();
    let mut mesh = disturbed();
    let middle = mesh.points.len() / 2;
    mesh.points[middle][0] += 2.5;
    let [node, ele] = support::triangle_text(&mesh, "");
    std::fs::write(folder.path("bad.node"), node).unwrap();
    std::fs::write(folder.path("bad.ele"), ele).unwrap();
    assert_eq!(folder.line("convert in in.gr3 --lossy").code, Some(0));
    let [node, ele] = right_triangles();
    std::fs::write(folder.path("right.node"), node).unwrap();
    std::fs::write(folder.path("right.ele"), ele).unwrap();
    // The sweeps by ACUTE leave large angles.
    for ending in ["node", "ele"] {
        let plate = plate_path().with_extension(ending);
        std::fs::copy(plate, folder.path(&format!("plate.{ending}"))).unwrap();
    }
    let mut found = BTreeSet::new();
    for line in [
        "in out --engine gpu --history all",
        "in out --slide --improve-worst --target keep-size --fix-box 0,0,3,3",
        "in out --fraction 0.9",
        "in out --max-move 0.4",
        "plate plate-out --for dflowfm",
        "in out --time-limit 1e-6 --checkpoint r.ckpt",
        "in out --continue r.ckpt",
        "in.gr3 out.gr3 --interpolate all",
        "in.gr3 out.2dm --lossy",
        "bad out --untangle",
        "right right-out",
    ] {
        let run = folder.line(&format!("{line} --report r.json --force"));
        assert_eq!(run.code, Some(0), "{line}: {}", run.err);
        add_paths("", &folder.json("r.json"), &mut found);
    }
    folder.line("bad out --report r.json").refused(&["inverted"]);
    add_paths("", &folder.json("r.json"), &mut found);
    // A GPU that fails, and a binary file with bad triangles, have tests of their own.
    let elsewhere = ["engine.fault.sweep", "engine.fault.error", "triangles[].byte"];
    found.extend(elsewhere.map(str::to_owned));
    let documented = documented();
    let missing: Vec<_> = found.difference(&documented).collect();
    let unknown: Vec<_> = documented.difference(&found).collect();
    assert!(missing.is_empty() && unknown.is_empty(), "missing {missing:?}, unknown {unknown:?}");
    assert_eq!(folder.json("r.json")["schema_version"], 3);
}
