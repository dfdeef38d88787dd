//! Golden results: hashes of all bits that the engines return, recorded in `cpu.txt` and `lavapipe.txt` in this folder.
//!
//! Changes of the code that should not change results must leave both files unchanged. A change that should change
//! results replaces the lines in a separate commit that gives the reason. `GPU_SMOOTH_GOLDEN=write cargo test --test
//! golden` writes both files.
//!
//! `cpu.txt` is valid on any x86-64 Linux, for all processors and numbers of threads. The first line of `lavapipe.txt`
//! names the recorded driver: other versions of Mesa compile kernels to other instructions, so their results are not
//! compared.

#![allow(clippy::print_stderr)]

use gpu_smooth::{
    Backend, Goal, Guard, Mesh, Method, Metric, Options, Slide, Smoother, Stopping, TargetField,
    Targets, Untangle,
    options::{Precision, WorstBy},
    targets::Surface,
};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use support::Outline;

/// The 64-bit hash FNV-1a.
struct Hash(u64);

impl Hash {
    fn of(numbers: impl IntoIterator<Item = u64>) -> Hash {
        let bytes = numbers.into_iter().flat_map(u64::to_le_bytes);
        Hash(bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        }))
    }

    fn of_points(points: &[[f64; 2]]) -> Hash {
        Hash::of(points.as_flattened().iter().map(|x| x.to_bits()))
    }
}

/// Parses a mesh file of `meshes/`.
fn shipped(name: &str) -> Mesh {
    let path = |ending: &str| {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../meshes").join(name).with_extension(ending)
    };
    let rows = |ending: &str| -> Vec<Vec<f64>> {
        let text = std::fs::read_to_string(path(ending)).unwrap();
        let lines = text.lines().map(|line| line.split('#').next().unwrap().trim());
        let rows = lines.filter(|line| !line.is_empty()).skip(1);
        rows.map(|row| row.split_whitespace().map(|word| word.parse().unwrap()).collect()).collect()
    };
    let nodes = rows("node");
    let first = nodes[0][0];
    Mesh {
        points: nodes.iter().map(|row| [row[1], row[2]]).collect(),
        triangles: rows("ele")
            .iter()
            .map(|row| [1, 2, 3].map(|corner| (row[corner] - first) as u32))
            .collect(),
        ..Mesh::default()
    }
}

/// Makes a plate with two holes.
fn plate(vertices: usize) -> Mesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../meshes/plate.outline");
    let outline = Outline::parse(&std::fs::read_to_string(path).unwrap()).unwrap();
    support::triangulate(&outline, vertices).unwrap()
}

/// Returns meshes with different kinds of difficulty.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let mut lines = support::perturb_random(&support::lattice(12, 8), 0.3, 4);
    // Vertices of the fourth column are fixed.
    lines.fixed = (0..9).map(|row| row * 13 + 4).collect();
    vec![
        ("perturbed", support::perturb_random(&support::lattice(20, 16), 0.35, 1)),
        ("distorted", support::distort_smooth(&support::lattice(16, 16), 0.8)),
        ("plate", support::perturb_random(&plate(500), 0.5, 3)),
        ("graded", support::perturb_random(&support::graded(24, 1e-2), 0.2, 2)),
        ("layer", support::wavy_layer(24, 30.0, 0.2)),
        ("hub", support::perturb_random(&support::hub(40, 0.1), 0.2, 5)),
        ("fixed-line", lines),
        ("fish", shipped("fish.node")),
    ]
}

type Change = fn(&mut Case<'_>);

/// A run under construction, whose options and targets changes may modify.
struct Case<'m> {
    mesh: &'m Mesh,
    options: Options,
    slide: Option<Slide>,
    targets: Option<Targets>,
    field: Option<TargetField>,
}

/// Returns target sizes that grow linearly from 0.5 on the left to 1.5 on the right.
fn sizes(mesh: &Mesh) -> Vec<f64> {
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    for [x, _] in &mesh.points {
        (low, high) = (low.min(*x), high.max(*x));
    }
    let share = |x: f64| (x - low) / (high - low);
    mesh.points.iter().map(|[x, _]| 0.5 + share(*x)).collect()
}

fn keep_size(case: &mut Case<'_>) {
    let smoother = Smoother::new(case.mesh).unwrap();
    let kept = Targets::keep_size(smoother.topology(), &case.mesh.points, Surface::Plane, 2);
    case.targets = Some(kept.unwrap());
}

fn keep_shape(case: &mut Case<'_>) {
    let smoother = Smoother::new(case.mesh).unwrap();
    case.targets = Some(Targets::keep_shape(smoother.topology(), &case.mesh.points, 2).unwrap());
}

fn given_sizes(case: &mut Case<'_>) {
    case.targets = Some(Targets::sizes(&sizes(case.mesh)).unwrap());
}

fn given_tensors(case: &mut Case<'_>) {
    let tensors: Vec<_> = sizes(case.mesh).iter().map(|size| [size.powi(-2), 0.1, 2.0]).collect();
    case.targets = Some(Targets::tensors(&tensors).unwrap());
}

fn field(case: &mut Case<'_>) {
    let targets = Targets::sizes(&sizes(case.mesh)).unwrap();
    case.field = Some(TargetField::new(case.mesh, &targets).unwrap());
}

fn slide(case: &mut Case<'_>) {
    let fixed = &case.mesh.fixed;
    let lines = fixed.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    case.slide = Some(Slide { lines, corner_angle: 50.0, ..Slide::default() });
}

/// Changes of options, each of which is run alone and in pairs with other changes.
const CHANGES: &[(&str, Change)] = &[
    ("slide", slide),
    ("max-move", |case| case.options.max_move = Some(0.2)),
    ("keep-altitude", |case| case.options.keep_altitude = true),
    ("keep-size", keep_size),
    ("keep-shape", keep_shape),
    ("sizes", given_sizes),
    ("tensors", given_tensors),
    ("field", field),
    ("worst-imr", |case| case.options.improve_worst = Some(WorstBy::Imr)),
    ("worst-angle", |case| case.options.improve_worst = Some(WorstBy::MinAngle)),
    ("worst-altitude", |case| case.options.improve_worst = Some(WorstBy::Altitude)),
    ("guard", |case| case.options.guard = Guard::Worst),
    ("goal", |case| {
        case.options.stopping = Stopping::Goal(Goal { fraction: 0.9, desired: Some(1.2) });
    }),
    ("single", |case| case.options.stored = Precision::Single),
];

/// Returns runs for each metric, alternating scheme, method, change, and several pairs of changes.
fn cases() -> Vec<(String, Vec<Change>, Options)> {
    let mut cases = Vec::new();
    let options = |scheme: &str| {
        Options::default().scheme(scheme.parse().unwrap()).max_sweeps(60).track_all(true)
    };
    for metric in Metric::ALL {
        cases.push((metric.name().to_owned(), vec![], options(metric.name())));
    }
    for scheme in ["edge+imr", "imr+area", "rms+imr+ar"] {
        cases.push((scheme.to_owned(), vec![], options(scheme)));
        let paper = Options::paper(scheme.parse().unwrap());
        let paper = paper.max_sweeps(20).track_all(true);
        cases.push((format!("paper:{scheme}"), vec![], paper));
    }
    for scheme in ["imr", "edge"] {
        let sweeps = options(scheme).method(Method::RELAXED);
        cases.push((format!("sweeps:{scheme}"), vec![], sweeps));
    }
    let searched = Goal { fraction: 0.95, desired: None };
    cases.push(("searched".into(), vec![], options("imr").stopping(Stopping::Goal(searched))));
    for (first, &(name, change)) in CHANGES.iter().enumerate() {
        cases.push((format!("imr,{name}"), vec![change], options("imr")));
        for &(other, also) in &CHANGES[first + 1..] {
            cases.push((format!("imr,{name},{other}"), vec![change, also], options("imr")));
        }
    }
    for scheme in ["rms", "ar", "shape-size"] {
        for &(name, change) in
            CHANGES.iter().filter(|(name, _)| ["slide", "keep-shape"].contains(name))
        {
            cases.push((format!("{scheme},{name}"), vec![change], options(scheme)));
        }
    }
    cases
}

/// Returns the metrics whose values a scheme's line contains: the nine metrics of the first recorded files, and those
/// of the scheme. A new metric thus leaves the lines of other schemes unchanged.
fn hashed(scheme: &[Metric]) -> Vec<Metric> {
    const FIRST: usize = 9;
    let (first, later) = Metric::ALL.split_at(FIRST);
    let own = later.iter().filter(|metric| scheme.contains(metric));
    first.iter().chain(own).copied().collect()
}

/// Runs a case, and returns its line for the file of results.
fn run(label: &str, mesh: &Mesh, changes: &[Change], options: &Options, on: &Backend) -> String {
    let mut case = Case { mesh, options: options.clone(), slide: None, targets: None, field: None };
    changes.iter().for_each(|change| change(&mut case));
    let Case { options, slide, targets, field, .. } = case;
    let made = || {
        let mut smoother = Smoother::new(mesh)?;
        smoother.set_slide(slide.as_ref())?;
        if let Some(targets) = &targets {
            smoother.set_targets(targets)?;
        }
        if let Some(field) = field {
            smoother.set_target_field(field)?;
        }
        smoother.run(&options).on(on).block()
    };
    match made() {
        // Messages of refusals are not part of the results.
        Err(_) => format!("{label} refused"),
        Ok(outcome) => {
            let metrics = hashed(options.scheme.metrics());
            let values = outcome.history.iter().flat_map(|objectives| {
                metrics.iter().map(|&metric| objectives.of(metric).map_or(0, f64::to_bits))
            });
            format!(
                "{label} points {:016x} history {:016x} sweeps {} {:?}",
                Hash::of_points(&outcome.points).0,
                Hash::of(values).0,
                outcome.history.len() - 1,
                outcome.stop,
            )
        }
    }
}

/// Untangles meshes, and returns a line for each.
fn untangled() -> String {
    let lattice = support::lattice(14, 10);
    let two_holes = support::boundaries::two_holes(500);
    let meshes = [
        ("scattered", support::tangle::scattered(&lattice, 1)),
        ("noisy", support::tangle::noisy(&lattice, 0.8, 2)),
        ("folded", support::tangle::folded(&lattice, 3)),
        ("turned-hole", support::tangle::turned_hole(24, 0.4)),
        ("bent", support::boundaries::bent(&lattice, 0.4)),
        ("past", support::boundaries::past(&two_holes, 1)),
    ];
    let mut lines = String::new();
    for (name, mesh) in meshes {
        let done = Untangle::new(&mesh).run().unwrap();
        let hash = Hash::of_points(&done.points).0;
        let (left, sweeps) = (done.left.len(), done.sweeps);
        writeln!(lines, "{name} untangled points {hash:016x} left {left} sweeps {sweeps}").unwrap();
    }
    lines
}

/// Compares lines with those of a file, or writes the file.
fn compare(file: &str, found: &str) {
    let path = recorded(file);
    if std::env::var("GPU_SMOOTH_GOLDEN").is_ok_and(|what| what == "write") {
        std::fs::write(&path, found).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap();
    // A new case may precede others, so that only its own line is missing.
    let [recorded, own] = [&expected, found].map(|text| text.lines().collect::<BTreeSet<_>>());
    let gone = recorded.difference(&own).map(|line| format!("- {line}"));
    let new = own.difference(&recorded).map(|line| format!("+ {line}"));
    let differ: Vec<_> = gone.chain(new).collect();
    let remedy = "if that is meant, as for a new metric, GPU_SMOOTH_GOLDEN=write cargo test --test golden writes them anew";
    assert!(differ.is_empty(), "lines of {file} differ; {remedy}\n{}", differ.join("\n"));
    assert_eq!(expected.lines().count(), found.lines().count(), "{file} has other cases; {remedy}");
}

fn recorded(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(file)
}

/// Returns all results of the CPU engine, computed on `threads` threads.
fn on_cpu(threads: usize) -> String {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut lines = String::new();
        for (name, mesh) in meshes() {
            for (case, changes, options) in cases() {
                let label = format!("{name} {case}");
                writeln!(lines, "{}", run(&label, &mesh, &changes, &options, &Backend::Cpu))
                    .unwrap();
            }
        }
        lines + &untangled()
    })
}

#[test]
fn results_on_one_thread_have_the_recorded_bits() {
    compare("cpu.txt", &on_cpu(1));
}

#[test]
fn results_on_two_threads_have_the_recorded_bits() {
    // Another test writes the file.
    if std::env::var_os("GPU_SMOOTH_GOLDEN").is_none() {
        compare("cpu.txt", &on_cpu(2));
    }
}

/// Small meshes without pairs of changes, because lavapipe needs a second to compile each kernel.
#[test]
fn results_on_lavapipe_have_the_recorded_bits() {
    let gpu = gpu_smooth::Gpu::open(Some("llvmpipe"))
        .block()
        .expect("lavapipe is needed: tests/run installs it");
    let driver = format!("{} {}", gpu.adapter().name, gpu.adapter().driver);
    let backend = Backend::Gpu(gpu);
    let mut lines = format!("{driver}\n");
    for (name, mesh) in
        meshes().into_iter().filter(|(name, _)| ["plate", "layer", "fixed-line"].contains(name))
    {
        for (case, changes, options) in
            cases().into_iter().filter(|(_, changes, _)| changes.len() < 2)
        {
            let label = format!("{name} {case}");
            writeln!(lines, "{}", run(&label, &mesh, &changes, &options, &backend)).unwrap();
        }
    }
    let expected = std::fs::read_to_string(recorded("lavapipe.txt")).unwrap_or_default();
    if expected.lines().next() == Some(&driver) || std::env::var_os("GPU_SMOOTH_GOLDEN").is_some() {
        compare("lavapipe.txt", &lines);
    } else {
        eprintln!("recorded with another driver than {driver}: not compared");
    }
}
