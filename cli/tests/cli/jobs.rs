//! The crate `gpu-smooth-job` and the command line write equal files, for each option that changes where vertices go.

use gpu_smooth::layers::KeepLayers;
use gpu_smooth::options::{Derivatives, WorstBy};
use gpu_smooth::{Backend, Guard, Metric, Options, Scheme};
use gpu_smooth_job::{Job, MethodName, RunRequest, SlideBy, TargetKind, TargetRequest};
use mesh_io::MeshFile;

use super::regions::{folder, halves};
use super::{Folder, disturbed};

/// The words of a command line, and the same run in Rust.
type Case = (&'static str, fn(&mut RunRequest), for<'f> fn(Job<'f>) -> Job<'f>);

fn scheme(text: &str) -> Option<Scheme> {
    Some(text.parse().unwrap())
}

fn toward(job: Job<'_>, kind: TargetKind, rings: Option<u32>, of_places: bool) -> Job<'_> {
    let of_places = of_places.then_some(true);
    job.target(TargetRequest { kind, rings, of_places, ..TargetRequest::default() })
}

const CASES: &[Case] = &[
    ("", |_| {}, |job| job),
    ("--scheme edge+imr", |run| run.scheme = scheme("edge+imr"), |job| job),
    ("--scheme rms --tolerance 1e-4", by_rms, |job| job),
    ("--method multilevel", |run| run.method = MethodName::Multilevel, |job| job),
    ("--omega 1.2", |run| run.omega = Some(1.2), |job| job),
    ("--method paper --inner 3", by_paper, |job| job),
    ("--derivatives finite-difference", differences, |job| job),
    ("--scheme edge --edge-norm fixed", by_fixed_norm, |job| job),
    ("--fraction 0.9", |run| run.fraction = Some(0.9), |job| job),
    ("--desired 1.3 --fraction 0.5", toward_f, |job| job),
    ("--max-sweeps 3", |run| run.max_sweeps = Some(3), |job| job),
    ("--guard worst", |run| run.guard = Guard::Worst, |job| job),
    ("--max-move 0.2", |run| run.max_move = Some(0.2), |job| job),
    ("--keep-altitude", |run| run.keep_altitude = true, |job| job),
    ("--improve-worst", |run| run.improve_worst = Some(WorstBy::Imr), |job| job),
    ("--history all --report r.json", |run| run.track_all = true, |job| job),
    ("--slide", |_| {}, |job| job.slide(SlideBy::default())),
    (
        "--slide --corner-angle 10 --hausdorff 0.01",
        |_| {},
        |job| {
            let mut by = SlideBy::default();
            (by.corner_angle, by.hausdorff) = (10.0, Some(0.01));
            job.slide(by)
        },
    ),
    ("--free-interfaces", |_| {}, |job| job.free_interfaces()),
    ("--keep-layers none", |_| {}, |job| job.keep_layers(KeepLayers::None)),
    ("--target keep-size", |_| {}, |job| toward(job, TargetKind::KeepSize, None, false)),
    (
        "--target keep-shape --target-rings 2",
        |_| {},
        |job| toward(job, TargetKind::KeepShape, Some(2), false),
    ),
    (
        "--target keep-shape --target-of place",
        |_| {},
        |job| toward(job, TargetKind::KeepShape, None, true),
    ),
    (
        "--target keep-size --slide",
        |_| {},
        |job| toward(job, TargetKind::KeepSize, None, false).slide(SlideBy::default()),
    ),
];

fn by_rms(run: &mut RunRequest) {
    (run.scheme, run.tolerance) = (Some(Metric::Rms.into()), Some(1e-4));
}

fn by_paper(run: &mut RunRequest) {
    (run.method, run.newton_steps) = (MethodName::Paper, Some(3));
}

fn differences(run: &mut RunRequest) {
    run.derivatives = Some(Derivatives::FiniteDifference);
}

fn by_fixed_norm(run: &mut RunRequest) {
    (run.scheme, run.doubles_exponent) = (scheme("edge"), Some(false));
}

fn toward_f(run: &mut RunRequest) {
    (run.desired, run.fraction) = (Some(Some(1.3)), Some(0.5));
}

/// Compares the file that a command line writes with that of a job.
fn compare(folder: &Folder, input: &str, words: &str, request: &RunRequest, job: Job<'_>) {
    let output = input.replace("in", "out");
    let line = folder.line(&format!("{input} {output} --engine cpu --force {words}"));
    assert_eq!(line.code, Some(0), "{words}: {}", line.err);
    let options = job.options(request);
    let smoothed = job.smooth(&options, &Backend::Cpu).unwrap();
    let own = input.replace("in", "own");
    smoothed.write(&folder.path(&own)).unwrap();
    let [by_line, by_job] = [output, own].map(|name| std::fs::read(folder.path(&name)).unwrap());
    assert!(by_line == by_job, "{input} {words}: the files differ");
    let [before, after] = [input, &input.replace("in", "out")].map(|name| folder.mesh(name).points);
    assert_ne!(before, after, "{input} {words}: no vertex has moved");
}

#[test]
fn a_job_and_the_command_line_write_equal_files_by_all_options() {
    let mesh = disturbed();
    for files in support::write_regions(&mesh, &halves(&mesh, [[1, 7], [2, 7]])).iter().take(2) {
        let (folder, input) = (folder(files), files[0].0);
        for (words, set, prepare) in CASES {
            let file = MeshFile::read(&folder.path(input)).unwrap();
            let mut request = RunRequest::default();
            set(&mut request);
            compare(&folder, input, words, &request, prepare(Job::of_file(&file).unwrap()));
        }
        let file = MeshFile::read(&folder.path(input)).unwrap();
        let (job, request) = (Job::on_sphere(&file).unwrap(), RunRequest::default());
        compare(&folder, input, "--surface sphere", &request, job);
        let job = Job::of_file(&file).unwrap().fix(&[40, 41]).unwrap();
        std::fs::write(folder.path("held.txt"), "41\n42\n").unwrap();
        compare(&folder, input, "--fix-vertices held.txt", &request, job);
    }
}

#[test]
fn a_job_untangles_as_the_command_line_does() {
    let mut mesh = disturbed();
    let regions = halves(&mesh, [[1, 7], [2, 7]]);
    mesh.points[41] = mesh.points[43];
    for files in support::write_regions(&mesh, &regions).iter().take(2) {
        let (folder, input) = (folder(files), files[0].0);
        let file = MeshFile::read(&folder.path(input)).unwrap();
        let job = || Job::of_file(&file).unwrap();
        assert!(job().smooth(&Options::default(), &Backend::Cpu).is_err());
        compare(&folder, input, "--untangle", &RunRequest::default(), job().untangle());
    }
}
