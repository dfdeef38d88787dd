//! Runs on meshes of quadrilaterals, and the properties that runs keep.

use gpu_smooth::{Mesh, Metric, Options, Quality, Slide, Topology, options::WorstBy};
use support::SplitMix64;
use support::quadrilaterals::{mixed, perturbed, squares};

use crate::*;

#[test]
fn a_disturbed_lattice_becomes_squares_by_each_metric() {
    let squares = squares(12);
    let mesh = perturbed(&squares, 0.3);
    for &metric in Metric::ALL {
        for outcome in runs(&mesh, &Options::default().scheme(metric.into())) {
            assert!(is_convex(&mesh, &outcome.points), "{metric}");
            let off = outcome.points.iter().zip(&squares.points);
            let off = off.map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1])).fold(0.0, f64::max);
            assert!(off < 0.02, "{metric}: {off}");
        }
    }
}

#[test]
fn the_objective_is_the_mean_over_elements() {
    for mesh in [perturbed(&squares(9), 0.2), perturbed(&mixed(9), 0.2)] {
        let smoother = prepared(&mesh);
        let expected = f(&mesh, &mesh.points);
        let quality = Quality::of(&mesh.points, smoother.topology()).unwrap();
        assert!((quality.f(Metric::Imr) / expected - 1.0).abs() < 1e-13);
        assert!((smoother.f(Metric::Imr, &mesh.points).unwrap() / expected - 1.0).abs() < 1e-12);
        let [outcome, of_device] = runs(&mesh, &Options::default());
        for (outcome, by) in [(&outcome, 1e-9), (&of_device, 1e-6)] {
            let after = f(&mesh, &outcome.points);
            let told = outcome.history[outcome.best_sweep as usize].of(Metric::Imr).unwrap();
            assert!((told / after - 1.0).abs() < by && after < expected, "{told} {after}");
        }
        let worst = |points: &[[f64; 2]]| {
            let triangles = mesh.triangles.len();
            let of = |(k, corner)| squared_imr(points, corner, k >= triangles);
            (0..).zip(corners(&mesh)).map(of).fold(0.0, f64::max).sqrt()
        };
        assert!((quality.worst_imr / worst(&mesh.points) - 1.0).abs() < 1e-12);
        assert!(worst(&outcome.points) <= worst(&mesh.points) * (1.0 + 1e-9));
    }
}

/// At the end of a converged run, no move of a single vertex lowers f by more than the tolerance allows.
#[test]
fn runs_converge_to_a_minimum_by_each_smooth_metric() {
    for lattice in [squares(14), mixed(14)] {
        let mesh = perturbed(&lattice, 0.25);
        for metric in [Metric::Imr, Metric::Rms, Metric::ShapeSize, Metric::Tmop80, Metric::Acute] {
            let options = Options::default().scheme(metric.into()).max_sweeps(200);
            let [outcome, of_device] = runs(&mesh, &options);
            let smoother = prepared(&mesh);
            let f = |points: &[[f64; 2]]| smoother.f(metric, points).unwrap();
            let least = f(&outcome.points);
            assert_eq!(outcome.stop, of_device.stop);
            let on_device = f(&of_device.points);
            assert!(
                (on_device - least).abs() < 2e-3 * least.max(0.1),
                "{metric}: {least} {on_device}"
            );
            // A second run from another start ends at the same minimum.
            let other = perturbed(&lattice, 0.1);
            let again = run(&other, &Options::default().scheme(metric.into()).max_sweeps(200));
            let again = f(&again.points);
            assert!((least - again).abs() < 2e-3 * least.max(0.1), "{metric}: {least} {again}");
            let mut points = outcome.points.clone();
            for v in (0..points.len()).filter(|&v| smoother.topology().free()[v]) {
                for [x, y] in [[1e-3, 0.0], [-1e-3, 0.0], [0.0, 1e-3], [0.0, -1e-3]] {
                    let kept = points[v];
                    points[v] = [kept[0] + x, kept[1] + y];
                    assert!(f(&points) > least - 2e-6 * least.max(1.0), "{metric}, vertex {v}");
                    points[v] = kept;
                }
            }
        }
    }
}

#[test]
fn windings_and_orders_of_the_elements_do_not_matter() {
    let mesh = perturbed(&mixed(10), 0.25);
    let expected = run(&mesh, &Options::default()).points;
    let mut turned = mesh.clone();
    for (k, quadrilateral) in turned.quadrilaterals.iter_mut().enumerate() {
        quadrilateral.rotate_left(k % 4);
        if k % 3 == 0 {
            quadrilateral.reverse();
        }
    }
    turned.triangles.iter_mut().step_by(2).for_each(|triangle| triangle.swap(0, 1));
    turned.quadrilaterals.reverse();
    turned.triangles.reverse();
    let found = run(&turned, &Options::default()).points;
    let [found, expected] = [&found, &expected].map(|points| f(&mesh, points));
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    let topology = Topology::new(&turned).unwrap();
    let all = topology.corners().iter().map(|&corner| doubled_area(&mesh.points, corner));
    assert!(all.fold(f64::INFINITY, f64::min) > 0.0);
}

#[test]
fn bounds_guards_and_the_worst_corners_are_kept() {
    let mesh = perturbed(&mixed(10), 0.3);
    let altitude = |points: &[[f64; 2]]| {
        let of = |corner: [u32; 3]| {
            let [p, q, r] = corner.map(|v| points[v as usize]);
            let length = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
            doubled_area(points, corner) / length(p, q).max(length(q, r)).max(length(r, p))
        };
        corners(&mesh).into_iter().map(of).fold(f64::INFINITY, f64::min)
    };
    for kept in runs(&mesh, &Options::default().keep_altitude(true)) {
        assert!(altitude(&kept.points) >= altitude(&mesh.points) * (1.0 - 1e-12));
    }
    for near in runs(&mesh, &Options::default().max_move(Some(0.05))) {
        let moves = near.points.iter().zip(&mesh.points);
        let most = moves.map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1])).fold(0.0, f64::max);
        // Distances are in units of the mean edge at each vertex, which is below 1.6.
        assert!(most <= 0.05 * 1.6 && most > 0.04, "{most}");
    }
    for by in [WorstBy::Imr, WorstBy::MinAngle, WorstBy::Altitude] {
        let plain = run(&mesh, &Options::default());
        let improved = run(&mesh, &Options::default().improve_worst(Some(by)));
        assert!(is_convex(&mesh, &improved.points));
        let of = |points: &[[f64; 2]]| Quality::of(points, &Topology::new(&mesh).unwrap()).unwrap();
        let [before, after] = [&plain, &improved].map(|outcome| of(&outcome.points));
        let is_better = match by {
            WorstBy::Imr => after.worst_movable_imr < before.worst_movable_imr,
            WorstBy::MinAngle => after.min_angle > before.min_angle,
            _ => altitude(&improved.points) > altitude(&plain.points),
        };
        assert!(is_better, "{by:?}: {before:?} {after:?}");
    }
}

#[test]
fn vertices_of_the_boundary_slide() {
    let squares = squares(8);
    let mut mesh = perturbed(&squares, 0.2);
    for (v, point) in mesh.points.iter_mut().enumerate().filter(|(v, _)| (1..8).contains(v)) {
        point[0] += 0.3 * (v as f64).sin();
    }
    let mut smoother = prepared(&mesh);
    assert_eq!(smoother.set_slide(Some(&Slide::default())).unwrap(), 28);
    for outcome in on_both(&smoother, &Options::default()) {
        assert!(is_convex(&mesh, &outcome.points));
        let off = outcome.points.iter().zip(&squares.points);
        let off = off.map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1])).fold(0.0, f64::max);
        assert!(off < 0.03, "{off}");
    }
}

#[test]
fn runs_repeat_their_bits_on_any_number_of_threads() {
    let mesh = perturbed(&mixed(40), 0.3);
    let points = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&mesh, &Options::default()).points)
    };
    assert!(points(1) == points(3));
}

/// A block whose rows are a hundred times longer than high at the lower side, and grow upward.
fn layers() -> Mesh {
    let mut mesh = squares(12);
    for point in &mut mesh.points {
        let height = (0..point[1] as i32).map(|row| 0.01 * 1.4f64.powi(row)).sum();
        *point = [point[0], height];
    }
    mesh
}

#[test]
fn targets_keep_the_rows_of_quadrilaterals() {
    let layers = layers();
    let mut mesh = layers.clone();
    let mut random = SplitMix64::new(5);
    let topology = Topology::new(&layers).unwrap();
    for (v, _) in topology.free().iter().enumerate().filter(|(_, free)| **free) {
        let height = layers.points[v + 13][1] - layers.points[v][1];
        mesh.points[v][0] += 0.2 * random.range(-1.0, 1.0);
        mesh.points[v][1] += 0.2 * height * random.range(-1.0, 1.0);
    }
    let mut smoother = prepared(&mesh);
    let targets = gpu_smooth::Targets::keep_shape(&topology, &layers.points, 0).unwrap();
    smoother.set_targets(&targets).unwrap();
    for outcome in on_both(&smoother, &Options::default().scheme(Metric::Tmop80.into())) {
        assert!(is_convex(&mesh, &outcome.points));
        for v in (13..143).filter(|v| v % 13 > 0 && v % 13 < 12) {
            let spacing = |points: &[[f64; 2]]| points[v + 13][1] - points[v][1];
            let ratio = spacing(&outcome.points) / spacing(&layers.points);
            assert!((ratio - 1.0).abs() < 0.1, "vertex {v}: {ratio}");
        }
    }
}

#[test]
fn default_runs_keep_small_angles_and_the_worst_corner() {
    for lattice in [squares(9), mixed(9)] {
        for most in [0.1, 0.2, 0.3] {
            let mesh = perturbed(&lattice, most);
            let outcome = run(&mesh, &Options::default());
            let topology = Topology::new(&mesh).unwrap();
            let of = |points: &[[f64; 2]]| Quality::of(points, &topology).unwrap();
            let [before, after] = [of(&mesh.points), of(&outcome.points)];
            assert!(after.min_angle >= before.min_angle.min(60.0) - 1e-6, "{before:?} {after:?}");
            assert!(after.worst_imr <= before.worst_imr * (1.0 + 1e-8), "{before:?} {after:?}");
        }
    }
}

/// ACUTE of a quadrilateral with the corner angles A to D is 1 + 0.3 (mean imr² - 1) + 105 Σ cot² + 200 (cot A cot C + cot B cot D)
/// + 150 Σ ψ(0.1 - cot) over the angles between its sides and diagonals.
#[test]
fn acute_of_quadrilaterals_joins_opposite_angles() {
    let mesh = perturbed(&squares(6), 0.3);
    let cotangent = |[p, q, r]: [u32; 3]| {
        let [p, q, r] = [p, q, r].map(|v| mesh.points[v as usize]);
        let (a, b) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
        1.0 / (b[1].atan2(b[0]) - a[1].atan2(a[0])).tan()
    };
    let penalty = |x: f64| match x {
        ..=0.0 => 0.0,
        ..=0.1 => x.powi(3) / 0.3,
        _ => 0.01 / 3.0 + (x - 0.1) * x,
    };
    let of = |&[p, q, r, s]: &[u32; 4]| {
        let corners = [[p, q, s], [q, r, p], [r, s, q], [s, p, r]];
        let [a, b, c, d] = corners.map(cotangent);
        let imr = corners.map(|corner| squared_imr(&mesh.points, corner, true));
        let shape = imr.iter().sum::<f64>() / 4.0;
        let right = a * a + b * b + c * c + d * d;
        let at_diagonals = corners.map(|[p, q, r]| {
            penalty(0.1 - cotangent([q, r, p])) + penalty(0.1 - cotangent([r, p, q]))
        });
        let large: f64 = at_diagonals.iter().sum();
        1.0 + 0.3 * (shape - 1.0) + 105.0 * right + 200.0 * (a * c + b * d) + 150.0 * large
    };
    let values = mesh.quadrilaterals.iter().map(of);
    let expected = values.sum::<f64>() / mesh.quadrilaterals.len() as f64;
    let smoother = prepared(&mesh);
    let quality = Quality::of(&mesh.points, smoother.topology()).unwrap();
    assert!((quality.f(Metric::Acute) / expected - 1.0).abs() < 1e-12);
    assert!((smoother.f(Metric::Acute, &mesh.points).unwrap() / expected - 1.0).abs() < 1e-11);
    let options = Options::default().scheme(Metric::Acute.into()).max_sweeps(0);
    for outcome in on_both(&smoother, &options) {
        let told = outcome.history[0].of(Metric::Acute).unwrap();
        assert!((told / expected - 1.0).abs() < 1e-5, "{told} {expected}");
    }
}

/// The penalties on large angles, which rounds after a run by ACUTE lower, see the right angles of quadrilaterals as good.
#[test]
fn acute_lowers_f_and_leaves_right_angles() {
    for lattice in [squares(12), mixed(12)] {
        let mesh = perturbed(&lattice, 0.25);
        let smoother = prepared(&mesh);
        let outcome =
            smoother.run(&Options::default().scheme(Metric::Acute.into())).block().unwrap();
        let f = |points: &[[f64; 2]]| smoother.f(Metric::Acute, points).unwrap();
        assert!(
            f(&outcome.points) < 0.7 * f(&mesh.points),
            "{} {}",
            f(&outcome.points),
            f(&mesh.points)
        );
        let imr = run(&mesh, &Options::default());
        let topology = smoother.topology();
        let off = |points: &[[f64; 2]]| {
            let cosine = |&[p, q, r]: &[u32; 3]| {
                let [p, q, r] = [p, q, r].map(|v| points[v as usize]);
                let (a, b) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
                (a[0] * b[0] + a[1] * b[1]).abs() / (a[0].hypot(a[1]) * b[0].hypot(b[1]))
            };
            let right = &topology.corners()[topology.triangles().len()..];
            right.iter().map(cosine).sum::<f64>() / right.len() as f64
        };
        assert!(off(&outcome.points) < off(&imr.points) + 1e-3);
    }
}
