//! The floor: runs with default options leave no triangle with a smaller angle or a larger inverse mean ratio than the worst
//! triangle of the mesh before the run.

use crate::worst::FIVE_DIGITS;
use crate::{backends, name, plate, run, with_points};
use gpu_smooth::{
    Backend, Goal, Guard, Mesh, Method, Metric, Options, Outcome, Phase, Progress, Quality, Slide,
    Smoother, Stop, Stopping, Targets, measure::Change, options::Precision, targets::Surface,
};
use std::ops::ControlFlow;
use support::check;

/// Returns the cotangent of the least angle and the worst inverse mean ratio among the triangles with a corner in `moves`.
pub(crate) fn worst(mesh: &Mesh, points: &[[f64; 2]], moves: &[bool]) -> [f64; 2] {
    let mut worst = [0.0, 0.0_f64];
    for t in mesh.triangles.iter().filter(|t| t.iter().any(|&v| moves[v as usize])) {
        let [p, q, r] = t.map(|v| points[v as usize]);
        let doubled_area = check::orient([p, q, r]);
        let dot = |at: [f64; 2], a: [f64; 2], b: [f64; 2]| {
            (a[0] - at[0]) * (b[0] - at[0]) + (a[1] - at[1]) * (b[1] - at[1])
        };
        let most = dot(p, q, r).max(dot(q, r, p)).max(dot(r, p, q));
        worst[0] = worst[0].max(most / doubled_area);
        worst[1] = worst[1].max(check::imr([p, q, r]));
    }
    worst
}

/// Returns the least angle in degrees and the worst inverse mean ratio among the triangles with a free vertex.
fn shapes(mesh: &Mesh, points: &[[f64; 2]]) -> [f64; 2] {
    let free: Vec<bool> = check::held(mesh).iter().map(|held| !held).collect();
    let [cotangent, imr] = worst(mesh, points, &free);
    [1f64.atan2(cotangent).to_degrees(), imr]
}

/// Makes a square of `n` times `n` squares, which diagonals cut in directions that alternate from row to row. All triangles
/// are right and isosceles.
fn alternating(n: u32) -> Mesh {
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let cut = |(i, j): (u32, u32)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if j.is_multiple_of(2) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    let all = |end: u32| (0..end).flat_map(move |j| (0..end).map(move |i| (i, j)));
    Mesh {
        points: all(n + 1).map(|(i, j)| [f64::from(i), f64::from(j)]).collect(),
        triangles: all(n).flat_map(cut).collect(),
        ..Mesh::default()
    }
}

/// Moves the vertices near the middle of a mesh of `n` times `n` squares along a wave.
fn with_wave(mut mesh: Mesh, n: u32, height: f64) -> Mesh {
    for [x, y] in &mut mesh.points {
        let [u, v] = [*x, *y].map(|x| x / f64::from(n) - 0.5);
        let near = (0.09 - u * u - v * v).max(0.0) / 0.09;
        *x += height * near * (5.0 * v).sin();
        *y -= height * near * (4.0 * u).cos();
    }
    mesh
}

fn assert_not_worse(mesh: &Mesh, outcome: &Outcome, label: &str) {
    let [[angle, imr], [now, imr_now]] = [&mesh.points, &outcome.points].map(|p| shapes(mesh, p));
    assert!(now > angle - 1e-7, "{label}: least angle from {angle} to {now}");
    assert!(imr_now < imr * (1.0 + 2e-9), "{label}: worst imr from {imr} to {imr_now}");
}

/// No vertex of such a lattice can move without an angle below 45 degrees. Sweeps would end at 36 degrees.
#[test]
fn right_triangles_of_a_regular_lattice_do_not_become_sharp() {
    let mesh = alternating(12);
    let smoother = Smoother::new(&mesh).unwrap();
    for backend in backends() {
        let outcome = run(&smoother, &Options::default(), backend);
        assert_eq!(outcome.points, mesh.points, "on the {}", name(backend));
        let floored = outcome.floored.unwrap();
        assert_eq!((floored.moved, floored.returned), (0, 121), "{floored:?}");
        assert!(floored.least_angle[1] < 40.0, "{floored:?}");
        assert_eq!(floored.least_angle[2], floored.least_angle[0], "{floored:?}");
        assert_eq!(floored.worst_imr[2], floored.worst_imr[0], "{floored:?}");
        assert_eq!(floored.f[1], outcome.movable_f[0], "{floored:?}");
    }
}

/// Returns the options of runs with an aim of their own.
fn with_another_aim() -> [Options; 5] {
    let usual = Options::default;
    [
        usual().method(Method::PAPER),
        usual().method(Method::Multilevel),
        usual().scheme(Metric::Ar.into()),
        usual().guard(Guard::Worst),
        usual().stopping(Stopping::Goal(Goal { fraction: 0.9, desired: Some(1.0) })),
    ]
}

#[test]
fn a_run_with_another_aim_has_no_floor() {
    let mesh = alternating(12);
    let mut smoother = Smoother::new(&mesh).unwrap();
    for options in with_another_aim() {
        let outcome = run(&smoother, &options, &Backend::Cpu);
        assert_eq!(outcome.floored, None, "{options:?}");
    }
    let sharp = run(&smoother, &with_another_aim()[0], &Backend::Cpu);
    assert!(shapes(&mesh, &sharp.points)[0] < 40.0);
    smoother.set_targets(&Targets::sizes(&vec![1.0; mesh.points.len()]).unwrap()).unwrap();
    let outcome = run(&smoother, &Options::default(), &Backend::Cpu);
    assert_eq!(outcome.floored, None);
    assert!(shapes(&mesh, &outcome.points)[0] < 40.0);
}

/// Returns meshes whose worst triangle gets worse in the sweeps.
fn worsening() -> Vec<(String, Mesh)> {
    let mut meshes = vec![("lattice".to_owned(), alternating(12))];
    for height in [0.1, 0.6] {
        meshes.push((format!("wave {height}"), with_wave(alternating(20), 20, height)));
    }
    for seed in 1..=10 {
        let mesh = support::perturb_random(&plate(300), 0.15, seed);
        meshes.push((format!("plate {seed}"), mesh));
    }
    meshes
}

#[test]
fn no_default_run_makes_the_worst_worse_and_the_floor_costs_little() {
    let (mut acted, mut gained) = (0, 0);
    for (name, mesh) in worsening() {
        let smoother = Smoother::new(&mesh).unwrap();
        for backend in backends() {
            let outcome = run(&smoother, &Options::default(), backend);
            let label = format!("{name} on the {}: {:?}", crate::name(backend), outcome.floored);
            assert_not_worse(&mesh, &outcome, &label);
            assert!(check::is_valid(&with_points(&mesh, &outcome.points)), "{label}");
            let Some(floored) = outcome.floored else { continue };
            acted += 1;
            gained += usize::from(floored.returned == 0);
            let [angle, imr] = shapes(&mesh, &outcome.points);
            assert!((angle - floored.least_angle[2]).abs() < 1e-9, "{label}");
            assert!((imr - floored.worst_imr[2]).abs() < 1e-9, "{label}");
            let f = smoother.f(Metric::Imr, &outcome.points).unwrap();
            assert!((f / floored.f[1] - 1.0).abs() < 1e-12, "{label}");
        }
    }
    assert!(acted >= 6 && gained >= 4, "{acted} {gained}");
}

#[test]
fn the_floor_holds_for_coordinates_as_they_are_stored() {
    let mut acted = 0;
    for (name, mut mesh) in worsening() {
        for stored in [Precision::Single, FIVE_DIGITS] {
            // Far from the origin, the digits are few.
            let far = if stored == FIVE_DIGITS { 300.0 } else { 3e5 };
            let shift = |x: &mut f64| *x = stored.rounded(*x + far);
            mesh.points.as_flattened_mut().iter_mut().for_each(shift);
            if !check::is_ccw(&mesh) {
                continue;
            }
            let smoother = Smoother::new(&mesh).unwrap();
            let options = Options::default().stored(stored);
            let outcome = run(&smoother, &options, &Backend::Cpu);
            let label = format!("{name}, {stored:?}: {:?}", outcome.floored);
            assert_not_worse(&mesh, &outcome, &label);
            let is_stored = |x: &f64| stored.rounded(*x) == *x;
            assert!(outcome.points.as_flattened().iter().all(is_stored), "{label}");
            acted += usize::from(outcome.floored.is_some());
        }
    }
    assert!(acted >= 3, "{acted}");
}

#[test]
fn sliding_vertices_and_bounds_keep_the_floor() {
    let mesh = with_wave(alternating(20), 20, 0.1);
    let mut smoother = Smoother::new(&mesh).unwrap();
    let bounded = Options::default().max_move(Some(0.6));
    let outcome = run(&smoother, &bounded, &Backend::Cpu);
    assert_not_worse(&mesh, &outcome, "with a bound of moves");
    let change = Change::between(smoother.topology(), &mesh.points, &outcome.points).unwrap();
    assert!(change.moved.most <= 0.6 + 1e-9 && outcome.floored.is_some(), "{change:?}");
    let kept = Options::default().keep_altitude(true);
    let outcome = run(&smoother, &kept, &Backend::Cpu);
    assert_not_worse(&mesh, &outcome, "with the least altitude kept");
    let change = Change::between(smoother.topology(), &mesh.points, &outcome.points).unwrap();
    assert!(change.least_altitude[1] >= change.least_altitude[0], "{change:?}");
    assert!(smoother.set_slide(Some(&Slide::default())).unwrap() > 0);
    let outcome = run(&smoother, &Options::default(), &Backend::Cpu);
    let every = vec![true; mesh.points.len()];
    let [before, after] = [&mesh.points, &outcome.points].map(|p| worst(&mesh, p, &every));
    let label = format!("sliding: {before:?} {after:?} {:?}", outcome.floored);
    assert!((0..2).all(|k| after[k] <= before[k] * (1.0 + 2e-9)), "{label}");
    assert!(outcome.slid.unwrap().moved > 0 && outcome.floored.is_some(), "{label}");
}

/// A mesh in degrees far from the equator, whose angles are those on the sphere.
#[test]
fn the_floor_of_a_mesh_on_the_sphere_is_that_of_angles_on_the_sphere() {
    let mut mesh = with_wave(alternating(12), 12, 0.2);
    mesh.points = mesh.points.iter().map(|[x, y]| [2.0 * x, 55.0 + y]).collect();
    let mut smoother = Smoother::new(&mesh).unwrap();
    assert!(smoother.project_from_sphere().unwrap());
    // A former defect: runs to equilateral triangles on the sphere, as those of the command line, had no floor.
    let topology = smoother.topology().corners().to_vec();
    let equilateral = Targets::equilateral(mesh.points.len());
    let equilateral = equilateral.seen_on(Surface::Sphere, &mesh.points, &topology).unwrap();
    for has_targets in [false, true] {
        if has_targets {
            smoother.set_targets(&equilateral).unwrap();
        }
        let outcome = run(&smoother, &Options::default(), &Backend::Cpu);
        let quality = |points: &[[f64; 2]]| {
            Quality::on(Surface::Sphere, points, smoother.topology()).unwrap()
        };
        let [before, after] = [&mesh.points, &outcome.points].map(|points| quality(points));
        let label = format!("{before:?} {after:?} {:?}", outcome.floored);
        assert!(outcome.floored.is_some() && outcome.best_sweep > 0, "{label}");
        assert!(after.min_angle >= before.min_angle - 1e-7, "{label}");
        assert!(after.worst_imr <= before.worst_imr * (1.0 + 2e-9), "{label}");
    }
}

/// A canceled run, and a run whose observer ends the floor, leave no worse triangle either.
#[test]
fn an_ended_run_keeps_the_worst() {
    let mesh = alternating(12);
    let smoother = Smoother::new(&mesh).unwrap();
    let ended_at = |sweep: u32, phase: Phase| {
        let observe = |progress: &Progress| match progress.sweep >= sweep && progress.phase == phase
        {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let options = Options::default();
        smoother.run(&options).on(&Backend::Cpu).observe(observe).block().unwrap()
    };
    for (sweep, phase) in [(1, Phase::Smoothing), (0, Phase::Improving)] {
        let outcome = ended_at(sweep, phase);
        let label = format!("{phase:?}: {:?}", outcome.floored);
        assert_eq!(outcome.stop, Stop::Canceled, "{label}");
        assert_not_worse(&mesh, &outcome, &label);
    }
    assert!(ended_at(0, Phase::Improving).floored.unwrap().moved == 0);
}
