//! The effects of options on a run.

use std::fmt::Write;
use std::path::Path;

use super::{Folder, assert_holds, assert_smoothed, finish, number, plate_path, small};
use gpu_smooth_job::options::{Belongs, Kind, OPTIONS, OptionRow, Spelling};
use serde_json::Value;

/// Runs on the CPU. Returns the report and the printed text.
#[track_caller]
fn run(folder: &Folder, options: &str) -> (Value, String) {
    let line = format!("in out --engine cpu --report r.json {options}");
    let out = folder.line(&line).clean().out;
    assert_smoothed(&folder.mesh("in"), &folder.mesh("out"));
    (folder.json("r.json"), out)
}

/// Runs on the plate. Returns the report.
#[track_caller]
fn on_plate(options: &[&str]) -> Value {
    let folder = Folder::new(&[]);
    let args = ["out", "--engine", "cpu", "--report", "r.json"];
    finish(folder.command().arg(plate_path()).args(args).args(options)).clean();
    folder.json("r.json")
}

fn sweeps(report: &Value) -> u64 {
    report["sweeps"].as_u64().unwrap()
}

fn f(report: &Value, metric: &str) -> f64 {
    number(&report["after"]["f"][metric])
}

#[test]
fn max_sweeps_ends_a_run() {
    let folder = small();
    let (report, out) = run(&folder, "--max-sweeps 5");
    assert_eq!((sweeps(&report), &report["stop"]), (5, &"max-sweeps".into()));
    assert_holds(&out, &["stopped after 5 sweeps (", ", the most allowed", "(--max-sweeps)"]);
    let (report, out) = run(&folder, "--max-sweeps 1");
    assert_eq!(sweeps(&report), 1);
    assert_holds(&out, &["stopped after 1 sweep, the most"]);
}

/// The remaining gain is relative to f, or to 1e-6 for smaller f. An earlier version printed "1.7e-2 of
/// itself" for an f of 1.2e-8.
#[test]
fn the_rest_above_the_limit_is_printed_also_where_f_is_small() {
    let folder = small();
    let (report, out) = run(&folder, "--scheme area --max-sweeps 400 --tolerance 0");
    let left = number(&report["remaining"]);
    assert!(f(&report, "area") < 1e-6, "{out}");
    assert_holds(&out, &[&format!("f is estimated to be {:.1e} above its limit", left * 1e-6)]);
}

#[test]
fn strict_makes_it_an_error_to_fall_short_and_writes_the_mesh() {
    let folder = small();
    let strict = |options: &str| folder.line(&format!("in out --engine cpu --strict {options}"));
    strict("").clean();
    strict("--fraction 0.5").clean();
    std::fs::remove_file(folder.path("out.node")).unwrap();
    let short = strict("--max-sweeps 2");
    assert_eq!(short.code, Some(1));
    assert_holds(&short.err, &["stopped after 2 sweeps", "The mesh was written", "--strict"]);
    assert_smoothed(&folder.mesh("in"), &folder.mesh("out"));
    assert_eq!(strict("--desired 0.5").code, Some(1));
}

#[test]
fn a_loose_tolerance_ends_a_run_earlier_and_zero_never() {
    let folder = small();
    let (loose, _) = run(&folder, "--tolerance 1e-2");
    let (tight, out) = run(&folder, "--tolerance 1e-8");
    assert_holds(&out, &[&format!("\nconverged after {} sweeps (", sweeps(&tight))]);
    assert!(sweeps(&loose) < sweeps(&tight) && f(&loose, "imr") >= f(&tight, "imr"));
    let (zero, _) = run(&folder, "--tolerance 0 --max-sweeps 400");
    assert_eq!((sweeps(&zero), &zero["stop"]), (400, &"max-sweeps".into()));
}

#[test]
fn a_goal_ends_a_run_when_reached() {
    let folder = small();
    let (full, _) = run(&folder, "--tolerance 1e-8");
    for options in ["--fraction 0.95", "--desired auto", "--fraction 0.95 --desired auto"] {
        let (report, out) = run(&folder, options);
        let goal = &report["goal"];
        assert_eq!((&report["stop"], number(&goal["fraction"])), (&"reached".into(), 0.95));
        assert!((number(&goal["desired"]) / f(&full, "imr") - 1.0).abs() < 1e-6);
        assert!(sweeps(&report) < sweeps(&full) && number(&goal["best_fraction"]) >= 0.95);
        assert_holds(&out, &["\nreached after ", " % of the way to f = 1."]);
    }
    let (half, _) = run(&folder, "--fraction 0.5");
    assert!(sweeps(&half) <= sweeps(&run(&folder, "--fraction 0.99").0));

    let target = (f(&half, "imr") + number(&half["before"]["f"]["imr"])) / 2.0;
    let (report, out) = run(&folder, &format!("--desired {target} --fraction 1"));
    assert_eq!(report["stop"], "reached");
    assert!(f(&report, "imr") < target);
    assert_holds(&out, &["beyond f = "]);
}

#[test]
fn a_goal_out_of_reach_is_reported() {
    let folder = small();
    let (report, out) = run(&folder, "--desired 1 --fraction 1 --max-sweeps 3");
    assert_eq!(
        (&report["stop"], &report["goal"]["reached"]),
        (&"max-sweeps".into(), &false.into())
    );
    assert_holds(
        &out,
        &["not reached after 3 sweeps (the most): ", " % of the way to f = 1.000000"],
    );
    let (report, out) = run(&folder, "--desired 1 --fraction 1");
    assert_eq!((&report["stop"], &report["goal"]["reached"]), (&"stalled".into(), &false.into()));
    assert_holds(&out, &["not reached: no more progress after "]);
}

#[test]
fn a_goal_that_is_met_at_the_start_changes_nothing() {
    let folder = small();
    let out = folder.line("in out --engine cpu --desired 1e6").clean().out;
    assert_holds(&out, &["nothing to do: f is as low as the desired 1.0000e6 already"]);
    assert_eq!(folder.text("in.node"), folder.text("out.node"));
}

#[test]
fn the_paper_method_is_omega_one() {
    let folder = small();
    let (paper, _) = run(&folder, "--method paper");
    let bytes = folder.text("out.node");
    let (plain, _) = run(&folder, "--omega 1");
    assert_eq!((&paper["history"], bytes), (&plain["history"], folder.text("out.node")));
    let (relaxed, _) = run(&folder, "--method relaxed");
    assert_eq!(relaxed["corrections"], 0);
    assert_eq!(relaxed["history"], run(&folder, "--omega 1.9").0["history"]);
    assert_ne!(relaxed["history"], run(&folder, "--method relaxed --omega 1.5").0["history"]);
}

#[test]
fn corrections_from_coarser_levels_are_the_default() {
    let folder = small();
    for scheme in ["imr", "ar", "rms", "imr+rms"] {
        let (auto, _) = run(&folder, &format!("--scheme {scheme}"));
        let (asked, _) = run(&folder, &format!("--scheme {scheme} --method multilevel"));
        assert_eq!(auto["history"], asked["history"]);
        assert!(auto["newton_steps"].as_u64().unwrap() > 0);
        let (relaxed, _) = run(&folder, &format!("--scheme {scheme} --method relaxed"));
        assert!(auto["sweeps"].as_u64() < relaxed["sweeps"].as_u64());
    }
    assert!(run(&folder, "--scheme edge").0["corrections"].as_u64().unwrap() > 0);
    for scheme in ["area", "area+imr"] {
        assert_eq!(run(&folder, &format!("--scheme {scheme}")).0["corrections"], 0);
        let line = format!("in out --engine cpu --scheme {scheme} --method multilevel");
        let refused = folder.line(&line);
        assert_eq!(refused.code, Some(2));
        assert_holds(&refused.err, &["--method multilevel", "cannot be corrected from coarser"]);
    }
    let text = folder.line("in out --engine cpu").clean().out;
    assert_holds(&text, &["converged after ", " with a Newton step)"]);
    let text = folder.line("in out --engine cpu --scheme edge").clean().out;
    assert_holds(&text, &["converged after ", " corrected from coarser levels)"]);
}

#[test]
fn over_relaxation_saves_sweeps() {
    let [relaxed, paper] = ["relaxed", "paper"].map(|method| on_plate(&["--method", method]));
    assert!(sweeps(&relaxed) < sweeps(&paper), "{} {}", sweeps(&relaxed), sweeps(&paper));
    assert!((f(&relaxed, "imr") / f(&paper, "imr") - 1.0).abs() < 1e-5);
}

#[test]
fn more_inner_steps_gain_more_a_sweep() {
    let folder = small();
    let (one, _) = run(&folder, "--method paper --max-sweeps 1");
    let (five, _) = run(&folder, "--method paper --max-sweeps 1 --inner 5");
    assert!(f(&five, "imr") < f(&one, "imr"));
}

#[test]
fn finite_differences_lead_to_the_same_place() {
    let folder = small();
    let (analytic, _) = run(&folder, "--derivatives analytic");
    let (differences, _) = run(&folder, "--derivatives finite-difference");
    assert_ne!(analytic["history"], differences["history"]);
    assert!((f(&analytic, "imr") / f(&differences, "imr") - 1.0).abs() < 1e-4);
}

#[test]
fn a_continued_edge_norm_ends_lower() {
    let [fixed, continued] = ["fixed", "continued"]
        .map(|norm| on_plate(&["--scheme", "edge", "--edge-norm", norm, "--max-sweeps", "200"]));
    assert!(f(&continued, "edge") < f(&fixed, "edge"));
}

#[test]
fn options_work_on_the_gpu_too() {
    let folder = small();
    for options in [
        "--fraction 0.95",
        "--method paper",
        "--omega 1.2",
        "--inner 2",
        "--derivatives finite-difference",
        "--scheme edge --edge-norm continued --max-sweeps 50",
    ] {
        folder.line(&format!("in out --engine gpu {options}")).clean();
        assert_smoothed(&folder.mesh("in"), &folder.mesh("out"));
    }
}

/// Returns a row of the table in docs/options.md.
fn documented(row: &OptionRow) -> String {
    let line = match row.kind {
        Kind::Flag(_) => Spelling::CommandLine.option(row.name),
        Kind::WordOrFlag(..) => format!("--{}[={}]", row.name, row.placeholder),
        _ => format!("{} {}", Spelling::CommandLine.option(row.name), row.placeholder),
    };
    let values = match row.kind {
        Kind::Flag(_) => "–".to_owned(),
        Kind::Scheme(_) => "metrics with `+` between them".to_owned(),
        Kind::Word(words, _) | Kind::WordOrFlag(words, _) => {
            words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
        }
        _ => row.wanted(),
    };
    let default = match row.default {
        "" => "–".to_owned(),
        default => format!("`{default}`"),
    };
    let call = match row.belongs {
        Belongs::ToMesh => "mesh",
        Belongs::ToRun => "run",
    };
    let line = line.replace('|', "\\|");
    let (name, help) = (Spelling::Python.option(row.name), row.help(Spelling::CommandLine));
    format!(
        "| `{line}` | `{name}` | {call} | {values} | {default} | {} |\n",
        help.replace('|', "\\|")
    )
}

#[test]
fn the_document_of_the_options_has_the_table() {
    let mut text = String::new();
    for row in OPTIONS {
        let of_heading = OPTIONS.iter().find(|other| other.heading == row.heading);
        let is_first = of_heading.is_some_and(|first| first.name == row.name);
        if is_first {
            write!(text, "\n## {}\n\n", row.heading).unwrap();
            text += "| command line | Python | belongs to | values | default | meaning |\n|---|---|---|---|---|---|\n";
        }
        text += &documented(row);
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/options.md");
    let recorded = std::fs::read_to_string(&path).unwrap();
    let start = recorded.find("\n## ").unwrap_or(recorded.len());
    if std::env::var("GPU_SMOOTH_OPTIONS").is_ok_and(|what| what == "write") {
        std::fs::write(&path, format!("{}{text}", &recorded[..start])).unwrap();
        return;
    }
    let remedy = "GPU_SMOOTH_OPTIONS=write cargo test -p gpu-smooth-cli the_document_of_the_options writes it";
    assert!(recorded[start..] == text, "docs/options.md differs from the table: {remedy}");
}
