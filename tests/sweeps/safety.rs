//! What a run must never do: invert a triangle, move what is held, or leave a sliver behind.

use crate::{all_schemes, backends, name, perturbed, plate, run, support, with_points};
use gpu_smooth::{Mesh, Metric, Options, Smoother};

/// Strongly perturbed, with some interior vertices fixed and some that no triangle uses.
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
            let options = Options {
                scheme: scheme.clone(),
                max_sweeps: 40,
                tolerance: 0.0,
                ..Options::default()
            };
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
    // Mildly disturbed there is none above the guard; strongly, some are far above, and must go.
    let mild = support::perturb_random(&plate(2000), 0.5, 3);
    assert!(support::worst_imr(&mild) < 30.0 && support::worst_imr(perturbed()) > 100.0);
    for mesh in [&mild, perturbed()] {
        let smoother = Smoother::new(mesh).unwrap();
        for metric in [Metric::Edge, Metric::Area] {
            let guard = metric.properties().shape_guard;
            for backend in backends() {
                let options =
                    Options { scheme: metric.into(), max_sweeps: 150, ..Options::default() };
                let outcome = run(&smoother, &options, backend);
                let worst = support::worst_imr(&with_points(mesh, &outcome.points));
                // Rounding in single precision is all it may be exceeded by.
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
fn points_rounded_to_single_precision_are_feasible_once_certified() {
    // So far from the origin that a float has steps longer than an edge.
    let here = support::perturb_random(&plate(800), 0.6, 4);
    let mesh = support::transformed(&here, 1.0, [1.2e6, 9e5]);
    let smoother = Smoother::new(&mesh).unwrap();
    let outcome = run(&smoother, &Options::default(), &backends()[1]);
    let mut points: Vec<_> =
        outcome.points.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
    assert!(!support::is_ccw(&with_points(&mesh, &points)), "rounding alone inverts triangles");
    let rounded = points.clone();
    let returned = smoother.certify(&mut points);
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
    // From 2^52 on doubles are whole numbers. Rows one unit apart in a wavy strip: where the sweeps take
    // the vertices cannot be written down, and rounding flattens triangles that were fine.
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
        assert!(outcome.returned > 0, "on the {} nothing was rounded over", name(backend));
        assert!(support::is_ccw(&with_points(&mesh, &outcome.points)), "on the {}", name(backend));
    }
}
