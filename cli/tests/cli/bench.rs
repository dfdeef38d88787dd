//! The measurements of `gpu-smooth bench` are consistent. No test judges the speed.

use serde_json::Value;

use super::{Folder, assert_holds, small};

/// The rows printed as JSON.
fn rows(text: &str) -> Vec<Value> {
    serde_json::from_str::<Value>(text).unwrap().as_array().unwrap().clone()
}

#[test]
fn both_engines_are_measured_on_lattices_of_the_sizes_asked_for() {
    let folder = small();
    let args = "bench --vertices 400,900 --scheme edge+imr --seconds 0 --json";
    let rows = rows(&folder.line(args).clean().out);
    let sizes: Vec<_> = rows.iter().map(|row| row["vertices"].as_u64().unwrap()).collect();
    assert_eq!(sizes, [400, 400, 900, 900]);
    for (row, side) in rows.iter().zip([20.0, 20.0, 30.0, 30.0]) {
        let number = |key: &str| row[key].as_f64().unwrap();
        assert_eq!(row["scheme"], "edge+imr");
        assert_eq!(number("free"), (side - 2.0) * (side - 2.0));
        let updates = number("free") / number("seconds_per_sweep");
        assert!((number("vertex_updates_per_second") / updates - 1.0).abs() < 1e-9);
        // Bytes of a vertex update: at least its own position read and written, six neighbors, and two triangles.
        assert!(number("bytes_per_second") > updates * (32.0 + 24.0 + 24.0));
        assert!(number("share_of_copy_rate") > 0.0);
    }
    assert!(rows[0]["engine"].as_str().unwrap().starts_with("cpu, "), "{}", rows[0]);
    assert!(rows[0]["kernels"].is_null());
    let adapters = folder.line("adapters").clean().out;
    let is_software = adapters.lines().next().unwrap().contains("(CPU: software, ");
    assert_eq!([&rows[0]["software"], &rows[1]["software"]], [false, is_software]);
    let kernels: Vec<_> = rows[1]["kernels"].as_array().unwrap().iter().collect();
    let names: Vec<_> = kernels.iter().map(|kernel| kernel["kernel"].as_str().unwrap()).collect();
    for name in ["sweep edge", "sweep imr", "objective"] {
        assert!(names.contains(&name), "{name} in {names:?}");
    }
    // No frame corrects sweeps by alternating metrics.
    assert!(rows[1]["corrected_kernels"].is_null(), "{}", rows[1]);
    // Runs by EDGE end without Newton steps.
    assert!(rows[1]["step_kernels"].is_null(), "{}", rows[1]);
    assert!(kernels.iter().all(|kernel| kernel["seconds_per_sweep"].as_f64().unwrap() > 0.0));
}

#[test]
fn a_mesh_of_the_user_is_measured_and_printed_as_text() {
    let folder = small();
    let vertices = folder.mesh("in").points.len().to_string();
    let run = folder.line("bench in --engine cpu --seconds 0").clean();
    assert_holds(&run.out, &["copies", "A sweep by imr", "M updates/s", "cpu, ", &vertices]);
    assert!(!run.out.contains("kernel"), "{}", run.out);
    let run = folder.line("bench in --engine gpu --seconds 0").clean();
    assert_holds(&run.out, &["sweep imr", "by its clock", "a sweep without clock"]);
    assert_holds(&run.out, &["a corrected sweep of", "coarsest_solve", "prolong_solution"]);
    assert_holds(
        &run.out,
        &["a Newton step with 10 iterations of", "find_hessian", "judge_length"],
    );
    // The shares are of the sum of the kernels, which a row below them has.
    let field = |name: &str, column: usize| -> f64 {
        let row = run.out.lines().find(|row| row.trim_start().starts_with(name)).unwrap();
        let numbers = row.trim_start()[name.len()..].split_whitespace();
        numbers.filter_map(|word| word.parse().ok()).nth(column).unwrap()
    };
    let kernels = ["sweep imr", "objective", "finish"];
    let sum: f64 = kernels.iter().map(|name| field(name, 1)).sum();
    let told = field("all, one after another", 0);
    assert!((sum - told).abs() < 0.3 && told > 0.0, "{}", run.out);
    let shares: f64 = kernels.iter().map(|name| field(name, 2)).sum();
    assert!((shares - 100.0).abs() < 0.3, "{}", run.out);
    // Only an application copies objectives to a buffer of its own.
    assert!(!run.out.contains("write_objective"), "{}", run.out);
    assert!(!run.out.contains("cpu, "), "{}", run.out);
}

/// A run smooths each of these meshes in its plane.
#[test]
fn a_mesh_in_any_plane_is_measured_in_its_plane() {
    let rows = |place: fn([f64; 2]) -> [f64; 3]| -> String {
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 2.0]].map(place);
        let faces = "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
        points.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect::<String>() + faces
    };
    let folder = Folder::new(&[
        ("xz.obj", &rows(|[x, y]| [x, 5.5, y])),
        ("yz.obj", &rows(|[x, y]| [5.5, x, y])),
        ("tilted.obj", &rows(|[x, y]| [x, y, x - 2.0 * y])),
        ("curved.obj", &rows(|[x, y]| [x, y, x * y])),
    ]);
    for (name, plane) in [("xz", "the plane of x and z"), ("yz", "y and z"), ("tilted", "tilted")] {
        let run = folder.line(&format!("bench {name}.obj --engine cpu --seconds 0"));
        assert_eq!(run.code, Some(0), "{}", run.err);
        assert_holds(&run.err, &["the mesh lies in", plane]);
    }
    let line = "bench curved.obj --engine cpu --seconds 0 --json";
    folder.line(line).refused(&["the mesh is not planar", "add --z data"]);
    let run = folder.line(&format!("{line} --z data")).clean();
    assert_eq!(self::rows(&run.out)[0]["free"], 1);
}

/// The rows of a Markdown table, split into fields.
fn table(text: &str) -> Vec<Vec<String>> {
    let rows = text.lines().filter(|line| line.starts_with('|'));
    let fields =
        |row: &str| row.trim_matches('|').split('|').map(|f| f.trim().to_owned()).collect();
    rows.map(fields).collect()
}

#[test]
fn markdown_tells_the_machine_and_compares_with_a_baseline() {
    let folder = small();
    let line = "bench in --engine cpu --seconds 0";
    let saved = folder.line(&format!("{line} --json")).clean().out;
    let mut known = rows(&saved);
    assert_holds(
        known[0]["version"].as_str().unwrap(),
        &["gpu-smooth ", env!("CARGO_PKG_VERSION")],
    );
    // Claims an earlier time of a thousand seconds per sweep.
    known[0]["seconds_per_sweep"] = 1000.0.into();
    std::fs::write(folder.path("saved.json"), Value::from(known).to_string()).unwrap();

    let plain = folder.line(&format!("{line} --markdown")).clean().out;
    assert_holds(&plain, &["- gpu-smooth ", " threads, ", "- cpu, ", ": copies "]);
    let rows = table(&plain);
    assert_eq!(rows[0], ["vertices", "ms/sweep", "M updates/s", "GB/s", "of copying", "engine"]);
    assert_eq!((rows.len(), rows[2].len(), rows[2][0].as_str()), (3, 6, "99"));
    assert!(rows[1].iter().all(|field| field.starts_with("---")));

    let compared = folder.line(&format!("{line} --markdown --baseline saved.json")).clean().out;
    let rows = table(&compared);
    assert_eq!(rows[0][1..4], ["ms/sweep", "baseline", "change"]);
    assert_eq!(rows[2][2..4], ["1000000.000", "-100.0 %"]);
    let text = folder.line(&format!("{line} --baseline saved.json")).clean().out;
    assert_holds(&text, &["  baseline    change ", " 1000000.000  -100.0 % "]);
    let told = folder.line(&format!("{line} --baseline saved.json --json")).clean().out;
    assert_eq!(self::rows(&told)[0]["baseline_seconds_per_sweep"], 1000.0);
    // The baseline lacks rows for meshes of other sizes.
    let other = "bench --vertices 400 --engine cpu --seconds 0 --markdown --baseline saved.json";
    assert_eq!(table(&folder.line(other).clean().out)[2][2..4], ["-", "-"]);

    folder.line(&format!("{line} --baseline in.node")).refused(&["in.node: ", "bench --json"]);
    folder.line(&format!("{line} --baseline none.json")).refused(&["none.json: ", "bench --json"]);
    assert_eq!(folder.line(&format!("{line} --json --markdown")).code, Some(2));
}

#[test]
fn times_of_kernels_are_printed_as_markdown() {
    let folder = small();
    let out = folder.line("bench in --engine gpu --seconds 0 --markdown").clean().out;
    let rows = table(&out);
    let sweep = rows.iter().find(|row| row[0] == "sweep imr").unwrap();
    assert_eq!((sweep.len(), rows[3][0].as_str()), (6, "kernel"));
}

#[test]
fn whole_runs_are_timed_by_phase_on_both_engines() {
    let folder = small();
    let args = "bench --runs --vertices 900 --seconds 0 --json";
    let rows = rows(&folder.line(args).clean().out);
    assert_eq!(rows.len(), 4);
    for (row, first) in rows.iter().zip([true, false, true, false]) {
        let number = |key: &str| row[key].as_f64().unwrap();
        assert_eq!((row["first"].as_bool(), row["runs"].as_u64()), (Some(first), Some(1)));
        let f: Vec<f64> =
            row["f"].as_array().unwrap().iter().map(|f| f.as_f64().unwrap()).collect();
        assert!(f[1] < f[0] && number("sweeps") > 1.0, "{row}");
        assert!(number("newton_steps") > 0.0 && number("corrections") == 0.0, "{row}");
        for part in ["levels_seconds", "waiting_seconds"] {
            assert!(number(part) <= number("smooth_seconds"), "{part}: {row}");
        }
        // The threads of the pool and the thread of the run compile at once.
        let threads = std::thread::available_parallelism().unwrap().get() + 1;
        let most = threads as f64 * number("smooth_seconds");
        assert!(number("compiling_seconds") <= most, "{row}");
        // Newton steps need no levels from the host.
        assert!(number("levels_seconds") == 0.0 && number("prepare_seconds") > 0.0, "{row}");
    }
    let [cpu, _, gpu, again] = &rows[..] else { unreachable!() };
    assert!(cpu["engine"].as_str().unwrap().starts_with("cpu, "), "{cpu}");
    assert_eq!((cpu["dispatches"].as_u64(), cpu["waits"].as_u64()), (Some(0), Some(0)));
    assert!(!gpu["driver"].as_str().unwrap().is_empty(), "{gpu}");
    // The first run compiles all kernels before its first sweep. The second run finds them compiled, and does the same work.
    let count = |row: &Value, key: &str| row[key].as_u64().unwrap();
    assert!(count(gpu, "kernels") > 0 && count(again, "kernels") == 0);
    assert_eq!(count(gpu, "kernels_after_first_sweep"), 0);
    for key in ["dispatches", "submissions", "waits", "uploaded_bytes", "read_back_bytes"] {
        assert!(
            count(gpu, key) > 0 && count(gpu, key) == count(again, key),
            "{key}: {gpu} {again}"
        );
    }
}

#[test]
fn whole_runs_of_a_mesh_of_the_user_are_printed_as_text_and_markdown() {
    let folder = small();
    let vertices = folder.mesh("in").points.len().to_string();
    let run = folder.line("bench in --runs --engine cpu --seconds 0").clean();
    assert_holds(&run.out, &["Whole runs by imr", "prepare", "late kernels", "cpu, ", &vertices]);
    let out = folder.line("bench in --runs --engine gpu --seconds 0 --markdown").clean().out;
    let rows = table(&out);
    assert_eq!((rows.len(), rows[0][1].as_str(), rows[3][1].as_str()), (4, "run", "of 1"));
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    assert_eq!(folder.line("bench in --runs --baseline in.node").code, Some(2));
}

#[test]
fn bench_refuses_missing_meshes_and_values_out_of_range() {
    let folder = small();
    folder.line("bench nowhere").refused(&["nowhere"]);
    folder.line("bench --adapter nonsense").refused(&["'nonsense'", "There are: "]);
    for args in [
        "bench --vertices 8",
        "bench --vertices 1e4",
        "bench in --vertices 100",
        "bench --seconds -1",
    ] {
        let run = folder.line(args);
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{args}: {}", run.err);
    }
}
