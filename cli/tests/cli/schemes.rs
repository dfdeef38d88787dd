//! Every metric and the alternating schemes of the paper, on both engines.

use super::{Folder, assert_smoothed, number, small};
use gpu_smooth::Metric;

/// The alternating schemes of the paper.
const ALTERNATING: [&str; 8] = [
    "edge+imr",
    "area+imr",
    "rms+imr",
    "edge+ar",
    "area+ar",
    "rms+ar",
    "edge+imr+imr",
    "edge+imr+imr+imr",
];

fn schemes() -> impl Iterator<Item = &'static str> {
    Metric::ALL.iter().map(|metric| metric.name()).chain(ALTERNATING)
}

fn assert_scheme_works(folder: &Folder, scheme: &str, engine: &str) {
    let line = format!("in out --scheme {scheme} --engine {engine} --max-sweeps 60");
    let summary = folder.line(&format!("{line} --report r.json")).clean().out;
    assert!(summary.contains(&format!("\n{scheme} on {engine} (")), "{summary}");
    let (before, after, report) = (folder.mesh("in"), folder.mesh("out"), folder.json("r.json"));
    assert_smoothed(&before, &after);
    assert_eq!((&report["scheme"], &report["after"]["inverted"]), (&scheme.into(), &0.into()));
    let metrics: Vec<_> = scheme.split('+').collect();
    let f = |state: &str| number(&report[state]["f"][metrics[0]]);
    assert!(f("after") < f("before"), "{scheme} on {engine}: f {}", f("after"));
    let rows = report["history"].as_array().unwrap();
    assert!(rows.len() > 4);
    // Metrics alternate until corrections or Newton steps begin, which lower the base metric.
    let swept: Vec<_> = rows[1..].iter().map(|row| row["metric"].as_str().unwrap()).collect();
    let turns = swept.iter().zip(metrics.iter().cycle()).take_while(|(a, b)| a == b).count();
    assert!(swept[turns..].iter().all(|metric| *metric == metrics[0]), "{scheme}: {swept:?}");
    let corrections = number(&report["corrections"]) + number(&report["newton_steps"]);
    let rest = swept.len() - turns;
    assert!(turns >= metrics.len(), "{scheme}: {swept:?}");
    if corrections == 0.0 {
        assert_eq!(rest, 0, "{scheme}: {swept:?}");
    } else if metrics.len() > 1 {
        assert!(rest as f64 + metrics.len() as f64 >= corrections, "{scheme}: {swept:?}");
    }
    let is_ratio = |metric: Metric| metric.properties().is_inverse_mean_ratio;
    if metrics.iter().any(|metric| metric.parse().is_ok_and(is_ratio)) {
        assert!(support::f_imr(&after) < support::f_imr(&before));
    }
}

#[test]
fn every_scheme_leaves_a_valid_better_mesh_on_the_gpu() {
    let folder = small();
    schemes().for_each(|scheme| assert_scheme_works(&folder, scheme, "gpu"));
}

#[test]
fn every_scheme_leaves_a_valid_better_mesh_on_the_cpu() {
    let folder = small();
    schemes().for_each(|scheme| assert_scheme_works(&folder, scheme, "cpu"));
}

#[test]
fn a_run_says_that_single_precision_ends_it() {
    let folder_of = |around, ratio| {
        let mesh = support::perturb_random(&support::graded(around, ratio), 0.3, 5);
        let [node, ele] = support::triangle_text(&mesh, "");
        Folder::new(&[("in.node", &node), ("in.ele", &ele)])
    };
    let folder = folder_of(32, 1e-4);
    let out = folder.line("in.node out.node --scheme soft-size --engine gpu --force").clean().out;
    let told = ", as far as single precision tells; f is estimated to be ";
    assert!(out.contains(told) && out.contains("; --engine cpu has double precision"), "{out}");
    // A measured end may be within a tolerance below the error of f in single precision.
    let by_soft_size = "in.node out.node --scheme soft-size --engine gpu --force --method relaxed";
    let out = folder_of(16, 1e-2).line(&format!("{by_soft_size} --tolerance 1e-8")).clean().out;
    assert!(out.contains("\nconverged after ") && !out.contains("single precision"), "{out}");
    let run = folder.line("in.node out.node --engine gpu --force");
    assert!(run.code == Some(0) && !run.out.contains("single precision"), "{}", run.out);
}
