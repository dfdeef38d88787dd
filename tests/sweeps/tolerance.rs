//! The tolerance bounds the distance to the limit, not the change in the last sweep.

use crate::flat::{bent, pressed_to_a_line};
use crate::{backends, distorted, global, history, name, perturbed, plate, run};
use gpu_smooth::{
    Backend, Mesh, Method, Metric, Options, Outcome, Smoother, Stop, Stopping, TargetField,
    Targets, Topology, targets::Surface,
};

/// Largest allowed ratio of the actual distance to the limit and the distance estimated from the last sweeps.
const TRUST: f64 = 1.5;

fn check(smoother: &Smoother, options: &Options, limit: f64) {
    for tolerance in [1e-4, 1e-6] {
        for backend in backends() {
            let options = options.clone().stopping(Stopping::Tolerance(tolerance));
            let outcome = run(smoother, &options, backend);
            let label = format!("{} to {tolerance:e} on the {}", options.scheme, name(backend));
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            let f = history(&outcome, options.scheme.base());
            let left = (f[f.len() - 1] - limit) / limit;
            assert!(left <= TRUST * tolerance, "{label}: {left:e} left");
            // The tolerance must not be exceeded by many sweeps either. A corrected sweep gains a factor of up to ten. A
            // Newton step of all vertices may gain a factor of more than a thousand, so f before the last step counts.
            let before = f[f.len() - if outcome.newton_steps > 0 { 2 } else { 1 }];
            let left = (before - limit) / limit;
            let room = if options.is_multilevel() { 100.0 } else { 20.0 };
            assert!(left >= tolerance / room, "{label}: {left:e} left");
        }
    }
}

#[test]
fn the_rest_above_the_limit_is_within_the_tolerance() {
    let rms = global::rms_optimum(perturbed());
    let (imr, _) = global::imr_optimum(&rms);
    assert!(imr < support::f_imr(&rms));
    for mesh in [perturbed(), distorted()] {
        let smoother = Smoother::new(mesh).unwrap();
        for (metric, limit) in [(Metric::Imr, imr), (Metric::Rms, global::f_rms(&rms))] {
            for method in [Method::Auto, Method::PAPER] {
                check(&smoother, &Options::default().scheme(metric.into()).method(method), limit);
            }
        }
    }
}

#[test]
fn the_rest_above_the_limit_of_edge_is_within_the_tolerance() {
    // The limit is that of the run's own sweeps, where the p-norm leads, not the best minimum. Corrections are
    // disabled, because with them, rounding decides in which of many minima a run ends.
    let smoother = Smoother::new(perturbed()).unwrap();
    let (scheme, method) = (Metric::Edge.into(), Method::RELAXED);
    let options = Options::default().scheme(scheme).method(method);
    let long =
        run(&smoother, &options.clone().stopping(Stopping::Tolerance(1e-11)), &backends()[0]);
    let limit = history(&long, Metric::Edge).into_iter().fold(f64::INFINITY, f64::min);
    check(&smoother, &options, limit);
}

/// f cannot fall below its ideal, whatever the extrapolation of a short decay predicts.
#[test]
fn the_rest_above_the_limit_is_at_most_that_above_the_ideal() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let mut smoother = Smoother::new(&mesh).unwrap();
    let sizes = Targets::sizes(&vec![1.0; mesh.points.len()]).unwrap();
    let mut told = 0;
    for metric in [Metric::Area, Metric::ShapeSize] {
        let is_of_places = metric == Metric::ShapeSize;
        if is_of_places {
            let field = TargetField::new(&mesh, &sizes).unwrap();
            smoother.set_target_field(field).unwrap();
        }
        for max_sweeps in [1, 3, 40] {
            let options = Options::default().scheme(metric.into()).max_sweeps(max_sweeps);
            let outcome = run(&smoother, &options, &Backend::Cpu);
            let f = smoother.f(metric, &outcome.points).unwrap();
            let Some(left) = outcome.remaining else { continue };
            let above = (f - metric.ideal_squared()) / f.max(1e-6);
            assert!(left <= above * (1.0 + 1e-9), "{metric}, {max_sweeps}: {left} of {above}");
            told += 1;
        }
    }
    assert!(told > 2, "{told}");
}

#[test]
fn a_run_that_is_cut_short_says_how_far_it_is() {
    let rms = global::rms_optimum(distorted());
    let (limit, _) = global::imr_optimum(&rms);
    let smoother = Smoother::new(distorted()).unwrap();
    for (method, max_sweeps) in [(Method::PAPER, 120), (Method::Auto, 8)] {
        let options = Options::default().method(method).max_sweeps(max_sweeps);
        for backend in backends() {
            let outcome = run(&smoother, &options, backend);
            let label = format!("{max_sweeps} sweeps on the {}", name(backend));
            assert_eq!(outcome.stop, Stop::MaxSweeps, "{label}");
            let f = *history(&outcome, Metric::Imr).last().unwrap();
            let (left, told) = ((f - limit) / limit, outcome.remaining.unwrap());
            assert!(left <= TRUST * told && told <= 100.0 * left, "{label}: {told:e} of {left:e}");
        }
    }
}

#[test]
fn a_mesh_that_can_become_ideal_converges() {
    // Each sweep of the small meshes gains more than a sixth of the remainder, so that corrections never begin. A
    // former defect: runs continued to the last sweep at an f of 1 to all digits.
    for (columns, rows) in [(3, 3), (5, 4), (8, 8), (12, 12)] {
        let mesh = support::perturb_random(&support::lattice(columns, rows), 0.8, 3);
        let smoother = Smoother::new(&mesh).unwrap();
        for metric in [Metric::Imr, Metric::Ar, Metric::ShapeSize] {
            for backend in backends() {
                let options = Options::default().scheme(metric.into());
                let outcome = run(&smoother, &options, backend);
                let (f, sweeps) = (*history(&outcome, metric).last().unwrap(), outcome.sweeps);
                let label = format!("{metric} on {columns} by {rows} on the {}", name(backend));
                assert_eq!(outcome.stop, Stop::Converged, "{label}");
                let above = f - metric.ideal_squared();
                assert!(above < 1e-6 && sweeps <= 50, "{label}: {above} in {sweeps} sweeps");
            }
        }
    }
}

/// On strongly graded meshes, gains of single sweeps are small by chance in a slow decay. Runs ended up to seven times the
/// tolerance above the limit: a former defect.
#[test]
fn a_loose_tolerance_holds_in_a_slow_decay() {
    for (around, ratio, strength, tolerance) in
        [(40, 0.001, 0.2, 1e-3), (60, 0.0003, 0.6, 1e-3), (24, 0.0001, 0.2, 1e-6)]
    {
        let mesh = support::perturb_random(&support::graded(around, ratio), strength, 3);
        let smoother = Smoother::new(&mesh).unwrap();
        let f = |tolerance: f64, backend: &Backend| {
            let options = Options::default()
                .scheme(Metric::ShapeSize.into())
                .stopping(Stopping::Tolerance(tolerance));
            let outcome = run(&smoother, &options, backend);
            let label = format!("{around} {ratio} to {tolerance:e} on the {}", name(backend));
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            *history(&outcome, Metric::ShapeSize).last().unwrap()
        };
        let limit = f(1e-9, &Backend::Cpu);
        // In single precision, corrections of the finer meshes are refused, and the runs stall.
        let is_precise = |backend: &&Backend| ratio == 0.001 || matches!(backend, Backend::Cpu);
        for backend in backends().iter().filter(is_precise) {
            let left = f(tolerance, backend) / limit - 1.0;
            let label = format!("{around} {ratio} on the {}", name(backend));
            assert!(left <= TRUST * tolerance, "{label}: {left:e} for {tolerance:e}");
        }
    }
}

/// A former defect: around this hub, sweeps alone reported less than half of the remaining gain, and elsewhere an 800th. The decay
/// of f proposes the end of a run, and a Newton step that is not taken measures the rest.
#[test]
fn sweeps_alone_measure_the_rest_that_their_decay_hides() {
    let mesh = support::perturb_random(&support::hub_evenly(200, 6), 0.5, 1);
    let smoother = Smoother::new(&mesh).unwrap();
    let f = |outcome: &Outcome| smoother.f(Metric::Imr, &outcome.points).unwrap();
    let stopping = Stopping::Tolerance(1e-11);
    let least = f(&run(&smoother, &Options::default().stopping(stopping), &Backend::Cpu));
    for backend in backends() {
        let mut sweeps = Vec::new();
        for method in [Method::RELAXED, Method::PAPER] {
            let outcome = run(&smoother, &Options::default().method(method), backend);
            let (left, told) = (f(&outcome) / least - 1.0, outcome.remaining.unwrap());
            let label = format!("{method:?} on the {}: {told:e} of {left:e}", name(backend));
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            assert!(left <= 2.0 * told && told <= 20.0 * left.max(1e-7), "{label}");
            // The paper's method only reports the rest.
            assert!(method == Method::PAPER || told <= 1e-6, "{label}");
            sweeps.push(outcome.sweeps);
        }
        assert!(sweeps[0] > 150, "{sweeps:?}: no end was refused");
    }
}

/// On meshes whose sizes differ by factors of 1,000 and 10,000, f in single precision has errors of up to 1e-4. A former
/// defect: runs on the GPU reported as little as a hundredth of the remaining gain. The bound of Newton steps comes from
/// derivatives, not from f, and holds on these meshes.
#[test]
fn newton_steps_on_a_device_bound_the_rest_on_graded_meshes() {
    for ratio in [1e-3, 1e-4] {
        let mesh = support::perturb_random(&support::graded(32, ratio), 0.3, 5);
        for metric in [Metric::SoftSize, Metric::Tmop94] {
            let (outcome, left) = with_gain_left(&mesh, None, metric, &backends()[1]);
            let (told, sweeps) = (outcome.remaining.unwrap(), outcome.sweeps);
            let label = format!("{metric} at {ratio}, {sweeps} sweeps: {told:e} of {left:e}");
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            assert!(left <= 2.0 * told, "{label}");
        }
    }
}

/// On the same meshes, runs that keep corrections extrapolate the decay of f in single precision.
#[test]
fn the_rest_above_the_limit_is_not_below_the_error_of_single_precision() {
    let gpu = &backends()[1];
    let mut most: f64 = 0.0;
    for ratio in [1e-3, 1e-4] {
        let mesh = support::perturb_random(&support::graded(32, ratio), 0.3, 5);
        let smoother = Smoother::new(&mesh).unwrap();
        for metric in [Metric::ShapeSize, Metric::SoftSize, Metric::Tmop94] {
            // These runs end on the device. Longer runs end on the CPU.
            for max_sweeps in [40, 50, 60, 70] {
                // No vertex reaches its disc, but runs with discs take no Newton steps.
                let max_move = Some(1e3);
                let options = Options::default()
                    .scheme(metric.into())
                    .max_sweeps(max_sweeps)
                    .max_move(max_move);
                let outcome = run(&smoother, &options, gpu);
                assert_eq!((outcome.stop, outcome.closing_sweeps), (Stop::MaxSweeps, 0));
                let Some(told) = outcome.remaining else { continue };
                let f = smoother.f(metric, &outcome.points).unwrap();
                let error = (history(&outcome, metric).last().unwrap() / f - 1.0).abs();
                let label = format!("{metric} at {ratio}, {max_sweeps} sweeps");
                assert!(
                    error <= told * (1.0 + 1e-6),
                    "{label}: {told:e} with an error of {error:e}"
                );
                most = most.max(error);
            }
        }
    }
    assert!(most > 1e-6, "{most:e}: the test has no hard mesh");
}

/// Returns the outcome of a run on a mesh with targets, and the gain of further sweeps on the CPU, as a share of f. The
/// run from the start to a tolerance of 1e-11 has the least f.
pub(crate) fn with_gain_left(
    mesh: &Mesh,
    targets: Option<&Targets>,
    metric: Metric,
    backend: &Backend,
) -> (Outcome, f64) {
    let mut smoother = Smoother::new(mesh).unwrap();
    targets.iter().for_each(|targets| smoother.set_targets(targets).unwrap());
    let options = Options::default().scheme(metric.into());
    let outcome = run(&smoother, &options, backend);
    let stopping = Stopping::Tolerance(1e-11);
    let long = run(&smoother, &options.stopping(stopping), &Backend::Cpu);
    let [f, least] = [&outcome, &long].map(|run| smoother.f(metric, &run.points).unwrap());
    (outcome, (f - least) / f)
}

/// Fast modes hid slow ones, and gains of single sweeps were small by chance: runs reported a tenth to a third of the
/// remaining gain, a former defect.
#[test]
fn a_converged_run_reports_at_least_half_of_the_remaining_gain() {
    let small = support::perturb_random(&plate(300), 1.0, 1);
    let hub = support::perturb_random(&support::hub(50, 1e-2), 1.0, 2);
    let [shape, size] = {
        let [small_topology, hub_topology] = [&small, &hub].map(|m| Topology::new(m).unwrap());
        [
            Targets::keep_shape(&small_topology, &small.points, 0).unwrap(),
            Targets::keep_size(&hub_topology, &hub.points, Surface::Plane, 0).unwrap(),
        ]
    };
    let graded = support::perturb_random(&support::graded(48, 1e-3), 0.3, 5);
    for (mesh, targets, metric) in [
        (&small, Some(&shape), Metric::Imr),
        (&hub, Some(&size), Metric::ShapeSize),
        (&graded, None, Metric::SoftSize),
    ] {
        for backend in backends() {
            let (outcome, left) = with_gain_left(mesh, targets, metric, backend);
            let label =
                format!("{metric}, {} vertices on the {}", mesh.points.len(), name(backend));
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            let told = outcome.remaining.unwrap();
            assert!(left <= 2.0 * told, "{label}: {told:e} of {left:e}");
        }
    }
}

/// Long runs kept the levels of their first correction if f ended far above its lower limit, a former defect. The graded mesh
/// took 166 sweeps, and around the vertex of fifty a run left 1.2e-5 and reported 2e-6.
#[test]
fn levels_are_built_again_in_long_runs() {
    let graded = support::perturb_random(&support::graded(40, 1e-4), 0.4, 4);
    let hub = support::perturb_random(&support::hub(50, 1e-3), 0.1, 4);
    for (mesh, metric, most) in [(&graded, Metric::Tmop94, 120), (&hub, Metric::Tmop80, 200)] {
        let (outcome, left) = with_gain_left(mesh, None, metric, &Backend::Cpu);
        let (told, sweeps) = (outcome.remaining.unwrap(), outcome.sweeps);
        let label = format!("{metric}: {sweeps} sweeps");
        assert_eq!(outcome.stop, Stop::Converged, "{label}");
        assert!(sweeps <= most && left <= 2.0 * told, "{label}: {told:e} of {left:e}");
    }
}

/// On graded meshes, rounding in single precision refuses corrections that gain less than 1e-6 of f. A run by `tmop-94` left
/// 6.5e-6 and reported 2e-6, a former defect. A device that cannot lower f further now stalls, and reports the measured rest.
#[test]
fn corrections_refused_by_rounding_leave_what_is_reported() {
    for (around, strength, seed, metric) in
        [(48, 0.3, 1, Metric::Tmop94), (24, 0.1, 6, Metric::ShapeSize)]
    {
        let mesh = support::perturb_random(&support::graded(around, 1e-3), strength, seed);
        for backend in backends() {
            let (outcome, left) = with_gain_left(&mesh, None, metric, backend);
            let told = outcome.remaining.unwrap();
            let (stop, sweeps) = (outcome.stop, outcome.sweeps);
            let label =
                format!("{metric} on the {}: {sweeps} sweeps, {told:e} of {left:e}", name(backend));
            let may_stall = matches!(backend, Backend::Gpu(_)) && told > 1e-6;
            assert!(
                stop == Stop::Converged || may_stall && stop == Stop::Stalled,
                "{stop:?}: {label}"
            );
            assert!(left <= 2.0 * told && told <= 1e-5 && sweeps <= 400, "{label}");
            assert_eq!(outcome.history.len() as u32, sweeps + 1, "{label}");
            assert_eq!(outcome.closing_sweeps, 0, "{label}");
        }
    }
}

/// Moves every seventh free vertex almost onto the opposite edge of one of its triangles, if no triangle is inverted.
fn with_slivers(mut mesh: Mesh) -> Mesh {
    let held = support::check::held(&mesh);
    for v in (0..mesh.points.len()).filter(|&v| !held[v]).step_by(7) {
        let of_vertex = |t: &&[u32; 3]| t.contains(&(v as u32));
        let triangle = *mesh.triangles.iter().find(of_vertex).unwrap();
        let [a, b] = {
            let mut others = triangle.into_iter().filter(|&other| other != v as u32);
            [0; 2].map(|_| mesh.points[others.next().unwrap() as usize])
        };
        let before = mesh.points[v];
        mesh.points[v] = [0, 1].map(|k| 0.5 * (a[k] + b[k]) * (1.0 - 1e-6) + 1e-6 * before[k]);
        if !support::is_valid(&mesh) {
            mesh.points[v] = before;
        }
    }
    mesh
}

/// Former defects, on another mesh with slivers: a run by `soft-size` with a tolerance of 1e-3 ended as converged at a
/// hundred times the least f, and a run by `imr` 1.3 % above the least f.
#[test]
fn slivers_are_opened_with_a_tolerance_of_a_thousandth() {
    let mesh = with_slivers(support::perturb_random(&plate(600), 0.3, 2));
    assert!(support::is_valid(&mesh) && support::worst_imr(&mesh) > 1e5);
    let smoother = Smoother::new(&mesh).unwrap();
    for metric in [Metric::SoftSize, Metric::Imr] {
        let options = Options::default().scheme(metric.into());
        let best = run(&smoother, &options, &Backend::Cpu);
        let best = smoother.f(metric, &best.points).unwrap();
        let options = options.stopping(Stopping::Tolerance(1e-3));
        for backend in backends() {
            let outcome = run(&smoother, &options, backend);
            let label = format!("{metric} on the {}: {} sweeps", name(backend), outcome.sweeps);
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            let left = smoother.f(metric, &outcome.points).unwrap() / best - 1.0;
            let told = outcome.remaining.unwrap();
            assert!(left <= 2.0 * told && told <= 1e-3, "{label}: {told:e} of {left:e}");
        }
    }
}

/// A former defect: the first correction of a stage gained ten times as much as the second. A run to a tolerance of 0.1
/// then ended as converged after 20 sweeps, at f = 20,000 instead of 0.06. Longer runs begin at means of neighbors.
#[test]
fn a_loose_tolerance_does_not_end_a_run_while_f_falls_steeply() {
    let bent = bent(32, 32);
    let width = bent.points.iter().map(|point| point[0]).fold(0.0, f64::max);
    let mesh = pressed_to_a_line(bent, 0.8 * width, 1e-3);
    let smoother = Smoother::new(&mesh).unwrap();
    let stopping = Stopping::Tolerance(0.1);
    let options =
        Options::default().scheme(Metric::Tmop80.into()).stopping(stopping).max_sweeps(40);
    let outcome = run(&smoother, &options, &Backend::Cpu);
    let f = smoother.f(Metric::Tmop80, &outcome.points).unwrap();
    assert_eq!((outcome.stop, outcome.sweeps), (Stop::MaxSweeps, 40), "f = {f}");
    let options = options.max_sweeps(1000);
    let outcome = run(&smoother, &options, &Backend::Cpu);
    let f = smoother.f(Metric::Tmop80, &outcome.points).unwrap();
    assert!(outcome.stop == Stop::Converged && f < 0.06, "{:?} at f = {f}", outcome.stop);
}

/// Runs with bounds or with work between sweeps reported too little, and a remaining gain of 0 after a run with targets of
/// places whose last move did not lower f: former defects.
#[test]
fn converged_runs_with_bounds_or_stages_do_not_report_too_little() {
    let mesh = support::perturb_random(&plate(300), 1.0, 3);
    let topology = Topology::new(&mesh).unwrap();
    let targets = Targets::keep_size(&topology, &mesh.points, Surface::Plane, 0).unwrap();
    let default = Options::default().scheme(Metric::Tmop94.into());
    let mut told = Vec::new();
    for (options, has_field) in [
        (default.clone().max_move(Some(0.3)), false),
        (default.clone().keep_altitude(true), false),
        (default, true),
    ] {
        let mut smoother = Smoother::new(&mesh).unwrap();
        smoother.set_targets(&targets).unwrap();
        if has_field {
            smoother.set_target_field(TargetField::new(&mesh, &targets).unwrap()).unwrap();
        }
        let outcome = run(&smoother, &options, &Backend::Cpu);
        assert_eq!(outcome.stop, Stop::Converged, "{outcome:?}");
        if let Some(told) = outcome.remaining {
            let stopping = Stopping::Tolerance(1e-11);
            let long = run(&smoother, &options.stopping(stopping), &Backend::Cpu);
            let [f, least] = [&outcome, &long].map(|run| run.movable_f[1]);
            assert!(f / least - 1.0 <= 2.0 * told, "{told:e} of {:e}", f / least - 1.0);
        }
        told.push(outcome.remaining.is_some());
    }
    // No part of the last move lowers f by the targets at the new positions.
    assert_eq!(told, [true, true, false]);
}
