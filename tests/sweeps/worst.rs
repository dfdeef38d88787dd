//! `improve_worst`, which improves the worst triangles after a run.

use crate::{backends, distorted, name, plate, run, with_points};
use gpu_smooth::{
    Backend, Guard, Mesh, Metric, Options, Outcome, Phase, Progress, Slide, Smoother, Stop,
    Stopping, Targets,
    measure::Change,
    options::{Precision, Rounding, WorstBy},
};
use std::ops::ControlFlow;
use support::{SplitMix64, check};

/// Returns the smallest angle of a triangle in degrees, by the law of cosines.
fn least_angle([p, q, r]: [[f64; 2]; 3]) -> f64 {
    let length = |[x, y]: [f64; 2], [a, b]: [f64; 2]| (x - a).hypot(y - b);
    let (a, b, c) = (length(q, r), length(r, p), length(p, q));
    let angle = |a: f64, b: f64, c: f64| ((b * b + c * c - a * a) / (2.0 * b * c)).acos();
    angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b)).to_degrees()
}

/// Returns the worst value among triangles with a free vertex, as [`gpu_smooth::outcome::Improved::worst`] defines it.
fn worst(smoother: &Smoother, points: &[[f64; 2]], by: WorstBy) -> f64 {
    let topology = smoother.topology();
    let can_move = |t: &&[u32; 3]| t.iter().any(|&v| topology.free()[v as usize]);
    let of = |measure: &dyn Fn([[f64; 2]; 3]) -> f64| {
        let values = topology.triangles().iter().filter(can_move);
        values.map(|t| measure(t.map(|v| points[v as usize]))).collect::<Vec<_>>()
    };
    let altitude = |corners: [[f64; 2]; 3]| {
        let [p, q, r] = corners;
        let longest = [(p, q), (q, r), (r, p)].map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
        let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        area.abs() / longest.into_iter().fold(0.0, f64::max)
    };
    match by {
        WorstBy::Imr => of(&check::imr).into_iter().fold(1.0, f64::max),
        WorstBy::MinAngle => of(&least_angle).into_iter().fold(180.0, f64::min),
        WorstBy::Altitude => of(&altitude).into_iter().fold(f64::INFINITY, f64::min),
    }
}

fn improved(smoother: &Smoother, by: WorstBy, options: Options, backend: &Backend) -> Outcome {
    run(smoother, &options.improve_worst(Some(by)), backend)
}

#[test]
fn the_worst_triangle_is_better_by_each_measure_at_a_small_cost_in_f() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let (cpu, gpu) = (&backends()[0], &backends()[1]);
    for (by, backend) in [(WorstBy::Imr, cpu), (WorstBy::MinAngle, gpu), (WorstBy::Altitude, cpu)] {
        let usual = run(&smoother, &Options::default(), backend);
        assert_eq!(usual.improved, None);
        let outcome = improved(&smoother, by, Options::default(), backend);
        let told = outcome.improved.unwrap();
        let label = format!("{by:?} on the {}: {told:?}", name(backend));
        let [before, after] = told.worst;
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-4;
        assert!(near(before, worst(&smoother, &usual.points, by)), "{label}");
        assert!((after / worst(&smoother, &outcome.points, by) - 1.0).abs() < 1e-9, "{label}");
        let gain = if by == WorstBy::Imr { before / after } else { after / before };
        assert!(gain > 1.05, "{label}");
        let f = |points| smoother.f(Metric::Imr, points).unwrap();
        assert!(near(told.f[0], f(&usual.points)), "{label}");
        assert!((told.f[1] / f(&outcome.points) - 1.0).abs() < 1e-9, "{label}");
        // Larger altitudes take space from other triangles.
        let most = if by == WorstBy::Altitude { 1.3 } else { 1.06 };
        assert!(told.f[0] < told.f[1] && told.f[1] < most * told.f[0], "{label}");
        assert!(told.vertices > 0 && told.vertices <= smoother.topology().free_count(), "{label}");
        assert!(check::is_valid(&with_points(&mesh, &outcome.points)), "{label}");
        // No other triangle may become worse in shape than the worst triangle was.
        let shapes = [&usual, &outcome].map(|o| worst(&smoother, &o.points, WorstBy::Imr));
        assert!(shapes[1] <= shapes[0] * (1.0 + 1e-6), "{label}: {shapes:?}");
    }
}

/// The result is returned although f is higher than before.
#[test]
fn a_smooth_mesh_is_improved_without_a_sweep() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let smooth = run(&Smoother::new(&mesh).unwrap(), &Options::default(), &Backend::Cpu);
    let mesh = with_points(&mesh, &smooth.points);
    let smoother = Smoother::new(&mesh).unwrap();
    let options = Options::default().max_sweeps(0);
    let outcome = improved(&smoother, WorstBy::Imr, options, &Backend::Cpu);
    let told = outcome.improved.unwrap();
    assert!(told.worst[1] < 0.95 * told.worst[0] && told.f[1] > told.f[0], "{told:?}");
    let moved = outcome.points.iter().zip(&mesh.points).filter(|(a, b)| a != b).count();
    assert_eq!(moved, told.vertices);
}

#[test]
fn bounds_and_altitudes_hold_while_the_worst_is_improved() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let change = |outcome: &Outcome| {
        Change::between(smoother.topology(), &mesh.points, &outcome.points).unwrap()
    };
    let bounded = Options::default().max_move(Some(0.4));
    let outcome = improved(&smoother, WorstBy::Imr, bounded, &Backend::Cpu);
    assert!(change(&outcome).moved.most <= 0.4 && outcome.improved.unwrap().vertices > 0);
    let kept = Options::default().keep_altitude(true);
    let outcome = improved(&smoother, WorstBy::MinAngle, kept, &Backend::Cpu);
    let [before, after] = change(&outcome).least_altitude;
    assert!(after >= before && outcome.improved.unwrap().vertices > 0);
}

/// A mesh, and its image under a linear map with targets that invert the map, end with equal shapes.
#[test]
fn the_worst_triangle_is_judged_in_the_shape_of_its_target() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let stretched: Vec<[f64; 2]> = mesh.points.iter().map(|[x, y]| [*x, 0.5 * y]).collect();
    let image = with_points(&mesh, &stretched);
    let targets = Targets::tensors(&vec![[1.0, 0.0, 4.0]; mesh.points.len()]).unwrap();
    let plain = Smoother::new(&mesh).unwrap();
    let mut shown = Smoother::new(&image).unwrap();
    shown.set_targets(&targets).unwrap();
    for by in [WorstBy::Imr, WorstBy::MinAngle] {
        let options = Options::default().stopping(Stopping::Tolerance(1e-9));
        let ends = [&plain, &shown].map(|smoother| {
            improved(smoother, by, options.clone(), &Backend::Cpu).improved.unwrap()
        });
        let [a, b] = ends.map(|end| end.worst);
        assert!((a[0] / b[0] - 1.0).abs() < 1e-4, "{by:?}: {ends:?}");
        assert!((a[1] / b[1] - 1.0).abs() < 1e-2, "{by:?}: {ends:?}");
    }
}

#[test]
fn triangles_that_cannot_be_improved_stay() {
    // Equilateral triangles around a free vertex, and a worse triangle without a free vertex.
    let mut points: Vec<[f64; 2]> =
        (0..6).map(|k| support::trig::on_circle(f64::from(k) / 6.0)).collect();
    points.extend([[0.0, 0.0], [3.0, 0.4]]);
    let mut triangles: Vec<[u32; 3]> = (0..6).map(|k| [k, (k + 1) % 6, 6]).collect();
    triangles.push([0, 7, 1]);
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    let smoother = Smoother::new(&mesh).unwrap();
    let outcome = improved(&smoother, WorstBy::Imr, Options::default(), &Backend::Cpu);
    let told = outcome.improved.unwrap();
    assert_eq!((told.vertices, told.stuck), (0, 1), "{told:?}");
    assert_eq!(told.worst[0], told.worst[1]);
    assert_eq!(outcome.points, mesh.points);
    // After a canceled run, nothing is improved.
    let mesh = distorted();
    let smoother = Smoother::new(mesh).unwrap();
    let options = Options::default().improve_worst(Some(WorstBy::Imr));
    let leave = |_: &gpu_smooth::Progress| std::ops::ControlFlow::Break(());
    let outcome = smoother.run(&options).on(&Backend::Cpu).observe(leave).block().unwrap();
    assert_eq!(outcome.improved, None);
}

/// The worst triangles surround a vertex at its best position, and other triangles could be improved.
#[test]
fn a_pass_that_leaves_the_worst_as_it_is_is_undone() {
    let mut mesh = support::perturb_random(&plate(300), 0.5, 3);
    let first = mesh.points.len() as u32;
    let rhombus = [[0.05, 0.0], [0.0, 0.005], [-0.05, 0.0], [0.0, -0.005], [0.0, 0.0]];
    mesh.points.extend(rhombus.map(|[x, y]| [x + 9.0, y]));
    mesh.triangles.extend((0..4).map(|k| [first + k, first + (k + 1) % 4, first + 4]));
    let smoother = Smoother::new(&mesh).unwrap();
    let usual = run(&smoother, &Options::default(), &Backend::Cpu);
    for by in WorstBy::ALL {
        let outcome = improved(&smoother, by, Options::default(), &Backend::Cpu);
        let told = outcome.improved.unwrap();
        assert_eq!(told.vertices, 0, "{told:?}");
        assert_eq!((told.worst[0], told.f[0]), (told.worst[1], told.f[1]), "{told:?}");
        assert_eq!(outcome.points, usual.points, "{told:?}");
    }
}

#[test]
fn improving_the_worst_ends_where_the_observer_says_so() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let smoother = Smoother::new(&mesh).unwrap();
    let options = Options::default().improve_worst(Some(WorstBy::Imr));
    let whole = run(&smoother, &options, &Backend::Cpu);
    let passes_before_it_ends = |most: u32| {
        let mut passes = 0;
        let mut observe = |progress: &Progress| {
            passes += u32::from(progress.phase == Phase::Improving);
            match passes > most {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let outcome =
            smoother.run(&options).on(&Backend::Cpu).observe(&mut observe).block().unwrap();
        (outcome, passes)
    };
    let (outcome, passes) = passes_before_it_ends(u32::MAX);
    assert_eq!((outcome.stop, &outcome.points), (whole.stop, &whole.points));
    assert!(passes > 1, "{passes}");
    let (outcome, _) = passes_before_it_ends(0);
    let told = outcome.improved.unwrap();
    assert_eq!((outcome.stop, told.vertices), (Stop::Canceled, 0));
    assert_eq!(told.worst[0], told.worst[1]);
    // The gain of completed passes is preserved.
    let (outcome, _) = passes_before_it_ends(1);
    let told = outcome.improved.unwrap();
    assert_eq!(outcome.stop, Stop::Canceled);
    assert!(told.vertices > 0 && told.worst[1] < told.worst[0], "{told:?}");
}

/// A triangle without a free vertex on the boundary is stuck only if none of its corners can slide.
#[test]
fn a_triangle_whose_corners_may_slide_is_not_stuck() {
    // Six triangles around a free vertex, and two outside of one side. One of the outer vertices can slide along a
    // straight line.
    let mut points: Vec<[f64; 2]> =
        (0..6).map(|k| support::trig::on_circle(f64::from(k) / 6.0)).collect();
    points.push([0.0, 0.0]);
    let mut triangles: Vec<[u32; 3]> = (0..6).map(|k| [k, (k + 1) % 6, 6]).collect();
    // Outside of the side from vertex 0 to 1: `out` is the middle of the straight line from vertex 0 to `far`.
    let [a, b] = [points[0], points[1]];
    let out = [a[0] + 0.5, a[1]];
    let far = [a[0] + 1.0, a[1]];
    points.extend([out, far]);
    triangles.extend([[0, 7, 1], [7, 8, 1]]);
    assert!(b[1] > 0.0);
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    let mut smoother = Smoother::new(&mesh).unwrap();
    let stuck = |smoother: &Smoother| {
        let options = Options::default().max_sweeps(0);
        improved(smoother, WorstBy::Imr, options, &Backend::Cpu).improved.unwrap().stuck
    };
    assert_eq!(stuck(&smoother), 2);
    let slide = Slide { corner_angle: 20.0, ..Slide::default() };
    assert_eq!(smoother.set_slide(Some(&slide)).unwrap(), 1);
    assert_eq!(stuck(&smoother), 0);
}

/// Rounds to five significant digits.
pub(crate) const FIVE_DIGITS: Precision = Precision::Custom(Rounding {
    name: "five digits",
    round: |x| format!("{x:.4e}").parse().unwrap_or(x),
    error: |size| 1e-4 * size,
});

/// Rounding may cost more than the stage gains. The worst triangle then stays as the sweeps left it.
#[test]
fn an_improvement_that_rounding_undoes_is_not_written() {
    let (mut improved, mut undone) = (0, 0);
    let mut random = SplitMix64::new(5);
    let plate = support::perturb_random(&plate(300), 0.3, 3);
    for case in 0..16 {
        let mut mesh = plate.clone();
        // In every second mesh, the worst triangles surround a vertex in a rhombus that is a few units of the last digit
        // high.
        if case % 2 == 0 {
            let first = mesh.points.len() as u32;
            let mut height = || random.range(0.03, 0.09);
            let rhombus = [[1.0, 0.0], [0.0, height()], [-1.0, 0.0], [0.0, -height()], [0.1, 0.0]];
            mesh.points.extend(rhombus.map(|[x, y]| [x + 9.0, y]));
            mesh.triangles.extend((0..4).map(|k| [first + k, first + (k + 1) % 4, first + 4]));
        }
        for x in mesh.points.as_flattened_mut() {
            *x = FIVE_DIGITS.rounded(*x + 300.0);
        }
        if !check::is_ccw(&mesh) {
            continue;
        }
        let smoother = Smoother::new(&mesh).unwrap();
        let usual = Options::default().stored(FIVE_DIGITS).guard(Guard::Worst);
        let without = run(&smoother, &usual, &Backend::Cpu);
        for by in [WorstBy::Imr, WorstBy::MinAngle] {
            let options = usual.clone().improve_worst(Some(by));
            let outcome = run(&smoother, &options, &Backend::Cpu);
            let told = outcome.improved.unwrap();
            let label = format!("case {case}: {told:?}");
            let [before, after] = [&without, &outcome].map(|o| worst(&smoother, &o.points, by));
            let is_no_worse = match by {
                WorstBy::Imr => after <= before * (1.0 + 1e-12),
                _ => after >= before * (1.0 - 1e-12),
            };
            assert!(is_no_worse, "{label}: {before} {after}");
            match told.vertices {
                0 => {
                    assert_eq!(outcome.points, without.points, "{label}");
                    assert_eq!(told.worst[0], told.worst[1], "{label}");
                    undone += 1;
                }
                _ => improved += 1,
            }
        }
    }
    assert!(improved > 0 && undone > 0, "{improved} improved, {undone} undone");
}
