//! Runs around a hub, a vertex of more than 16 neighbors: the remaining gain that they report, and their last corrections.

use crate::tolerance::with_gain_left;
use crate::{backends, name};
use gpu_smooth::{Backend, Metric, Stop, Targets, Topology, targets::Surface};

/// Around a vertex of fifty, corrections were refused and sweeps alone ended the runs: by `keep_shape`, because levels in
/// the coordinates of the maps take large changes of triangles for translations, and by `keep_size`, because the mesh
/// was still rough when corrections were tried. The runs left 4e-5 and 2e-4 and reported 1e-6, a former defect, which on a
/// device lasted longer than on the CPU.
#[test]
fn corrections_are_taken_around_a_hub_with_targets() {
    let hub = |seed| support::perturb_random(&support::hub(50, 1e-2), 1.0, seed);
    let [of_shapes, of_sizes] = [hub(4), hub(3)];
    let [shapes, sizes] = {
        let [a, b] = [&of_shapes, &of_sizes].map(|mesh| Topology::new(mesh).unwrap());
        [
            Targets::keep_shape(&a, &of_shapes.points, 0).unwrap(),
            Targets::keep_size(&b, &of_sizes.points, Surface::Plane, 0).unwrap(),
        ]
    };
    for (mesh, targets, metric, most) in
        [(&of_shapes, &shapes, Metric::Imr, 60), (&of_sizes, &sizes, Metric::Rms, 200)]
    {
        for backend in backends() {
            let (outcome, left) = with_gain_left(mesh, Some(targets), metric, backend);
            let (told, sweeps) = (outcome.remaining.unwrap(), outcome.sweeps);
            let label = format!("{metric} on the {}: {sweeps} sweeps", name(backend));
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            assert!(outcome.corrections + outcome.newton_steps >= 3 && sweeps <= most, "{label}");
            assert!(left <= 2.0 * told, "{label}: {told:e} of {left:e}");
        }
    }
}

/// Two to four corrections around a vertex of fifty promised that a fifth of the tolerance was left, and slow modes held
/// up to 5.9e-6. Without targets, 44 corrections hid a mode of 2.6e-6. The runs reported 1e-6, a former defect.
#[test]
fn gains_around_a_hub_are_confirmed_by_further_corrections() {
    let hub = |ratio, noise, seed| support::perturb_random(&support::hub(50, ratio), noise, seed);
    let of_80 = support::perturb_random(&support::hub(80, 1e-2), 0.2, 1);
    for (mesh, rings) in [
        (hub(1e-3, 0.2, 1), Some(1)),
        (hub(0.1, 0.1, 3), Some(0)),
        (hub(1e-3, 0.3, 1), None),
        (of_80, None),
    ] {
        let topology = Topology::new(&mesh).unwrap();
        let targets = rings.map(|n| Targets::keep_shape(&topology, &mesh.points, n).unwrap());
        for backend in backends() {
            let (outcome, left) = with_gain_left(&mesh, targets.as_ref(), Metric::Imr, backend);
            let (told, sweeps) = (outcome.remaining.unwrap(), outcome.sweeps);
            let label = format!("{rings:?} on the {}: {sweeps} sweeps", name(backend));
            assert_eq!(outcome.stop, Stop::Converged, "{label}");
            // On lavapipe, one of the runs without targets takes 127 sweeps.
            let most = if matches!(backend, Backend::Cpu) { 60 } else { 200 };
            assert!(sweeps <= most && left <= 2.0 * told, "{label}: {told:e} of {left:e}");
        }
    }
}

/// Around a vertex of fifty, the gains of sweeps rise now and then, and a single rise must not hide the decay of f over
/// several sweeps: the run lasted 37 sweeps, a former defect, and left 6e-10.
#[test]
fn gains_that_rise_now_and_then_do_not_prolong_a_run() {
    let mesh = support::perturb_random(&support::hub(50, 0.1), 0.3, 3);
    let topology = Topology::new(&mesh).unwrap();
    let targets = Targets::keep_shape(&topology, &mesh.points, 1).unwrap();
    let (outcome, left) = with_gain_left(&mesh, Some(&targets), Metric::Imr, &Backend::Cpu);
    assert_eq!(outcome.stop, Stop::Converged);
    assert!(outcome.sweeps <= 30 && left <= 1e-6, "{left:e} after {} sweeps", outcome.sweeps);
}

/// Rounding in single precision hides slow modes around a hub. After 164 corrections around a vertex of 200, a run on a device
/// had left 4.4e-5 and reported 2e-6, a former defect. Newton steps bound the rest on both engines.
#[test]
fn a_run_around_a_hub_ends_on_its_engine() {
    let mesh = support::perturb_random(&support::hub(60, 1e-2), 1.0, 3);
    for backend in backends() {
        let (outcome, left) = with_gain_left(&mesh, None, Metric::Imr, backend);
        let label = format!("{} sweeps on the {}", outcome.sweeps, name(backend));
        assert_eq!((outcome.stop, outcome.closing_sweeps), (Stop::Converged, 0), "{label}");
        assert!(outcome.newton_steps > 2 && outcome.corrections == 0, "{label}");
        assert!(left <= 2.0 * outcome.remaining.unwrap() && left <= 1e-6, "{label}: {left:e}");
    }
}

/// A guard holds vertices around a vertex of fifty back. Corrections that are tried again at the end of the run are
/// refused, and do not prolong the run by further sweeps alone, as was a former defect (67 sweeps).
#[test]
fn corrections_in_vain_at_the_end_do_not_prolong_a_run() {
    let mesh = support::perturb_random(&support::hub(50, 1e-2), 0.2, 2);
    let (outcome, left) = with_gain_left(&mesh, None, Metric::Rms, &Backend::Cpu);
    assert_eq!(outcome.stop, Stop::HeldBack);
    assert!(outcome.sweeps <= 62 && left <= 1e-6, "{left:e} after {} sweeps", outcome.sweeps);
}
