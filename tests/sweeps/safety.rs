//! Safety of runs: no inverted triangle, no moved fixed vertex, no remaining sliver.

use crate::{all_schemes, backends, name, perturbed, plate, run, with_points};
use gpu_smooth::{Mesh, Metric, Options, Quality, Smoother, Stopping};

/// Makes a strongly perturbed plate with some fixed inner vertices and some unused vertices.
fn held() -> Mesh {
    let mut mesh = plate(700);
    let interior: Vec<u32> = support::check::held(&mesh)
        .iter()
        .zip(0..)
        .filter_map(|(&held, v)| (!held).then_some(v))
        .collect();
    mesh.fixed = interior.into_iter().step_by(17).collect();
    mesh = support::perturb_random(&mesh, 1.0, 12);
    mesh.points.extend([[1e300, -7.0], [0.1, 0.2], [-0.0, 0.0]]);
    mesh
}

#[test]
fn no_scheme_inverts_a_triangle_or_moves_what_is_held() {
    let mesh = held();
    let held = support::check::held(&mesh);
    let smoother = Smoother::new(&mesh).unwrap();
    for scheme in all_schemes() {
        for backend in backends() {
            let options = Options::default()
                .scheme(scheme.clone())
                .max_sweeps(40)
                .stopping(Stopping::Tolerance(0.0));
            let outcome = run(&smoother, &options, backend);
            let after = with_points(&mesh, &outcome.points);
            let label = format!("{scheme} on the {}", name(backend));
            assert!(support::is_valid(&after), "{label}");
            assert!(support::same_orientations(&mesh, &after), "{label}");
            let mut moved = 0;
            for (v, (was, is)) in mesh.points.iter().zip(&after.points).enumerate() {
                let same = was.map(f64::to_bits) == is.map(f64::to_bits);
                assert!(same || !held[v], "{label}: vertex {v} has moved");
                moved += usize::from(!same);
            }
            assert!(moved > support::mover_count(&mesh) / 2, "{label}: only {moved} moved");
            assert_eq!(outcome.returned, 0, "{label} left this to the certificate");
        }
    }
}

#[test]
fn metrics_without_a_barrier_leave_no_slivers() {
    // In the mild mesh, no triangle exceeds the guard. In the strongly perturbed mesh, some triangles exceed the guard
    // by far and must improve.
    let mild = support::perturb_random(&plate(2000), 0.5, 3);
    assert!(support::worst_imr(&mild) < 30.0 && support::worst_imr(perturbed()) > 100.0);
    for mesh in [&mild, perturbed()] {
        let smoother = Smoother::new(mesh).unwrap();
        for metric in [Metric::Edge, Metric::Area, Metric::Rms] {
            let guard = metric.properties().shape_guard.min(support::worst_imr(mesh));
            for backend in backends() {
                let options = Options::default().scheme(metric.into()).max_sweeps(150);
                let outcome = run(&smoother, &options, backend);
                let worst = support::worst_imr(&with_points(mesh, &outcome.points));
                // Only rounding in single precision may exceed the guard.
                assert!(
                    worst <= guard * (1.0 + 1e-4),
                    "{metric} on the {}: {worst}",
                    name(backend)
                );
            }
        }
    }
}

#[test]
fn a_good_mesh_of_uneven_sizes_is_not_flattened() {
    // Sizes differ by a factor of a thousand, and shapes are good. Evening out lengths and areas would flatten
    // triangles up to any fixed guard.
    let even = support::perturb_random(&plate(2000), 0.2, 3);
    let graded = |[x, y]: [f64; 2]| {
        let r = x.hypot(y).max(1e-3);
        [x * r * r, y * r * r]
    };
    let mut mesh = even.clone();
    mesh.points.iter_mut().for_each(|p| *p = graded(*p));
    let smoother = Smoother::new(&mesh).unwrap();
    let before = Quality::of(&mesh.points, smoother.topology()).unwrap().worst_movable_imr;
    assert!(before < 10.0, "{before}");
    for metric in [Metric::Edge, Metric::Area, Metric::Rms] {
        for backend in backends() {
            let options = Options::default().scheme(metric.into()).max_sweeps(100);
            let outcome = run(&smoother, &options, backend);
            let after = Quality::of(&outcome.points, smoother.topology()).unwrap();
            let label = format!("{metric} on the {}", name(backend));
            let start = Quality::of(&mesh.points, smoother.topology()).unwrap().f(metric);
            assert!(after.f(metric) < start, "{label} does nothing");
            let worst = after.worst_movable_imr;
            assert!(worst <= before * (1.0 + 1e-4), "{label}: {worst} from {before}");
        }
    }
}

#[test]
fn an_optimal_mesh_comes_back_as_it_was() {
    // A former defect: rounding on a device moved thousands of vertices by a millionth, and raised f in the eighth
    // digit.
    let smoother = Smoother::new(perturbed()).unwrap();
    let options = Options::default().stopping(Stopping::Tolerance(1e-13)).max_sweeps(300);
    let outcome = run(&smoother, &options, &backends()[0]);
    let optimal = with_points(perturbed(), &outcome.points);
    let smoother = Smoother::new(&optimal).unwrap();
    for backend in backends() {
        let outcome = run(&smoother, &Options::default(), backend);
        assert!(outcome.points == optimal.points, "on the {}", name(backend));
        assert_eq!((outcome.best_sweep, outcome.returned), (0, 0));
    }
}

#[test]
fn points_rounded_to_single_precision_are_feasible_once_certified() {
    // So far from the origin, neighboring floats are farther apart than the length of an edge.
    let here = support::perturb_random(&plate(800), 0.6, 4);
    let mesh = support::transformed(&here, 1.0, [1.2e6, 9e5]);
    let smoother = Smoother::new(&mesh).unwrap();
    let outcome = run(&smoother, &Options::default(), &backends()[1]);
    let mut points: Vec<_> =
        outcome.points.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
    assert!(!support::is_ccw(&with_points(&mesh, &points)), "rounding alone inverts triangles");
    let rounded = points.clone();
    let returned = smoother.certify(&mut points).unwrap();
    assert!(support::is_ccw(&with_points(&mesh, &points)));
    let back = points.iter().zip(&rounded).filter(|(p, q)| p != q).count();
    assert_eq!(returned, back);
    assert!(back > 0);
    for ((p, q), was) in points.iter().zip(&rounded).zip(&mesh.points) {
        assert!(p == q || p == was, "what goes back goes where it was");
    }
}

#[test]
fn a_mesh_as_fine_as_its_numbers_stays_feasible() {
    // Beyond 2^52, doubles are integers. Rows of a wavy strip are one unit apart. The positions found by sweeps must be
    // rounded to integers, which flattens good triangles.
    let (columns, rows) = (36, 24);
    let far = 2f64.powi(52);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let wave = (8.0 * support::trig::sin_turns(column as f64 / 12.0)).round();
            mesh.points.push([far + (3 * column) as f64, far + wave + row as f64]);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = (row * (columns + 1) + column) as u32;
            let (b, c, d) = (a + 1, a + columns as u32 + 1, a + columns as u32 + 2);
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    assert!(support::is_ccw(&mesh));
    let smoother = Smoother::new(&mesh).unwrap();
    for backend in backends() {
        let outcome = run(&smoother, &Options::default(), backend);
        assert!(support::is_ccw(&with_points(&mesh, &outcome.points)), "on the {}", name(backend));
        let f =
            |points: &[[f64; 2]]| Quality::of(points, smoother.topology()).unwrap().f(Metric::Imr);
        let (before, after) = (f(&mesh.points), f(&outcome.points));
        assert!(after <= before, "on the {}: {after} from {before}", name(backend));
    }
}

#[test]
fn points_that_rounding_makes_worse_than_the_start_are_not_returned() {
    // A free vertex among integer coordinates: all positions to which it can be rounded are worse than its own.
    let far = 2f64.powi(52);
    let at = |x: f64, y: f64| [far + x, far + y];
    let mesh = Mesh {
        points: vec![at(1.0, 3.0), at(0.0, 1.0), at(3.0, 0.0), at(1.0, 2.0)],
        triangles: vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]],
        ..Mesh::default()
    };
    let smoother = Smoother::new(&mesh).unwrap();
    for backend in backends() {
        let outcome = run(&smoother, &Options::default(), backend);
        assert_eq!(outcome.points, mesh.points, "on the {}", name(backend));
        assert_eq!(outcome.best_sweep, 0);
    }
}
