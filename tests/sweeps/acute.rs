//! Runs by ACUTE, for solvers with unknowns at circumcenters.

use crate::{backends, name, perturbed, plate, run, with_points};
use gpu_smooth::measure::{InnerEdge, Measured};
use gpu_smooth::options::WorstBy;
use gpu_smooth::{
    Backend, Guard, Mesh, Metric, Options, Quality, Slide, Smoother, Stopping, Targets, Topology,
    measure::Change, targets::Surface,
};
use support::check;

/// Returns the number of edges that D-Flow FM refuses, the number of edges with short flow links, and the number of
/// triangles with an angle of 90 degrees or more.
fn counts(mesh: &Mesh, points: &[[f64; 2]]) -> [usize; 3] {
    let topology = Topology::new(mesh).unwrap();
    let edges = Measured::new(points, &topology).unwrap().edges();
    let count = |is: fn(&InnerEdge) -> bool| edges.iter().filter(|edge| is(edge)).count();
    let is_obtuse = |t: &&[u32; 3]| {
        let [p, q, r] = t.map(|v| points[v as usize]);
        let dot = |at: [f64; 2], a: [f64; 2], b: [f64; 2]| {
            (a[0] - at[0]) * (b[0] - at[0]) + (a[1] - at[1]) * (b[1] - at[1])
        };
        dot(p, q, r).min(dot(q, r, p)).min(dot(r, p, q)) <= 0.0
    };
    [
        count(|edge| edge.orthogonality > 0.5),
        count(|edge| edge.flow_link < 0.1),
        mesh.triangles.iter().filter(is_obtuse).count(),
    ]
}

fn acute() -> Options {
    Options::default().scheme(Metric::Acute.into())
}

#[test]
fn a_run_makes_nearly_all_triangles_acute_on_both_engines() {
    let mesh = perturbed();
    let smoother = Smoother::new(mesh).unwrap();
    let [_, small, obtuse] = counts(mesh, &mesh.points);
    assert!(small > 20 && obtuse > 100, "{small} {obtuse}");
    for backend in backends() {
        let outcome = run(&smoother, &acute(), backend);
        assert!(check::is_valid(&with_points(mesh, &outcome.points)));
        let after = counts(mesh, &outcome.points);
        let is_better = after[0] == 0 && after[1] <= small / 5 && after[2] <= obtuse / 3;
        assert!(is_better, "{}: {after:?} of {small} and {obtuse}", name(backend));
        let by_imr = run(&smoother, &Options::default(), backend);
        assert!(counts(mesh, &by_imr.points)[1] > 0, "{}", name(backend));
        // Shapes stay near those of a run by imr.
        let f =
            |points: &[[f64; 2]]| Quality::of(points, smoother.topology()).unwrap().f(Metric::Imr);
        assert!(f(&outcome.points) < 1.05 * f(&by_imr.points));
    }
}

#[test]
fn the_rounds_after_the_sweeps_lessen_large_angles_and_say_so() {
    let mesh = perturbed();
    let smoother = Smoother::new(mesh).unwrap();
    for backend in backends() {
        let outcome = run(&smoother, &acute(), backend);
        let large = outcome.large_angles.unwrap();
        let [swept, left] = large.triangles;
        assert!(large.moved > 0 && left < swept, "{large:?}");
        assert!(large.f[0] < large.f[1], "{large:?}");
        assert!(run(&smoother, &Options::default(), backend).large_angles.is_none());
    }
}

#[test]
fn sliding_lowers_f_and_leaves_no_more_edges_that_a_solver_refuses() {
    // Every second vertex of the lowest side is moved along the side.
    let mesh = support::boundaries::dragged(&support::lattice(24, 20), |[x, y]| {
        let is_odd = (x.round() as i64) % 2 == 1 && x < 23.5;
        if y == 0.0 && is_odd { [x + 0.4, y] } else { [x, y] }
    });
    let fixed = Smoother::new(&mesh).unwrap();
    let mut sliding = Smoother::new(&mesh).unwrap();
    sliding.set_slide(Some(&Slide::default())).unwrap();
    for backend in backends() {
        let [alone, slid] = [&fixed, &sliding].map(|smoother| {
            let outcome = run(smoother, &acute().stopping(Stopping::Tolerance(1e-4)), backend);
            let f = Quality::of(&outcome.points, smoother.topology()).unwrap().f(Metric::Acute);
            (f, counts(&mesh, &outcome.points))
        });
        assert!(slid.0 < 0.999 * alone.0, "{slid:?} {alone:?}");
        assert!((0..3).all(|k| slid.1[k] <= alone.1[k]), "{slid:?} {alone:?}");
    }
}

#[test]
fn acute_size_keeps_sizes_and_makes_triangles_acute() {
    let mesh = perturbed();
    let mut smoother = Smoother::new(mesh).unwrap();
    let topology = Topology::new(mesh).unwrap();
    let targets = Targets::keep_size(&topology, &mesh.points, Surface::Plane, 0).unwrap();
    smoother.set_targets(&targets).unwrap();
    let options = Options::default().scheme(Metric::AcuteSize.into());
    let backend = &backends()[0];
    let kept = run(&smoother, &options, backend);
    let alone = run(&Smoother::new(mesh).unwrap(), &acute(), backend);
    let of =
        |points: &[[f64; 2]]| Change::between(&topology, &mesh.points, points).unwrap().size.p95;
    assert!(of(&kept.points) < of(&alone.points));
    let [_, small, obtuse] = counts(mesh, &kept.points);
    let before = counts(mesh, &mesh.points);
    assert!(small <= before[1] / 10 && obtuse < before[2] / 4, "{small} {obtuse} of {before:?}");
}

/// A lattice of squares, each cut in two right triangles along either diagonal.
fn right_triangles(n: u32) -> Mesh {
    let corner = |row: u32, column: u32| row * (n + 1) + column;
    let cell = |k: u32| {
        let (row, column) = (k / n, k % n);
        let [a, b] = [corner(row, column), corner(row, column + 1)];
        let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
        match (k * k + 3 * row) % 5 < 2 {
            true => [[a, b, d], [a, d, c]],
            false => [[a, b, c], [b, d, c]],
        }
    };
    let point = |k: u32| [f64::from(k % (n + 1)), f64::from(k / (n + 1))];
    Mesh {
        points: (0..(n + 1) * (n + 1)).map(point).collect(),
        triangles: (0..n * n).flat_map(cell).collect(),
        ..Mesh::default()
    }
}

/// Two former defects of the rounds after the sweeps: they took place in runs without sweeps, which change no mesh, and they made
/// the worst triangle worse than its guard allows.
#[test]
fn the_rounds_after_the_sweeps_keep_the_guard_and_need_a_sweep() {
    let mut kept = 0;
    let right = right_triangles(9);
    let slide = Some(Slide::default());
    for (mesh, slide) in [(&right, None), (&right, slide.clone()), (perturbed(), slide)] {
        let mut smoother = Smoother::new(mesh).unwrap();
        let before = support::worst_imr(mesh);
        smoother.set_slide(slide.as_ref()).unwrap();
        for metric in [Metric::Acute, Metric::AcuteSize] {
            for backend in backends() {
                let options = Options::default().scheme(metric.into());
                let label = format!("{metric} on the {}", name(backend));
                let outcome = run(&smoother, &options.clone().max_sweeps(0), backend);
                assert_eq!(outcome.points, mesh.points, "{label}");
                let outcome = run(&smoother, &options.clone(), backend);
                kept += usize::from(outcome.large_angles.is_some());
                let outcome = run(&smoother, &options.guard(Guard::Worst), backend);
                let after = support::worst_imr(&with_points(mesh, &outcome.points));
                // A device measures shapes in single precision.
                let error = if matches!(backend, Backend::Cpu) { 1e-9 } else { 1e-5 };
                assert!(after <= before * (1.0 + error), "{label}: {before} {after}");
            }
        }
    }
    assert!(kept > 2, "the rounds took place {kept} times");
}

/// The rounds on large angles raised f above f of the mesh before the run, and the gain of the sweeps was lost with theirs.
#[test]
fn rounds_on_large_angles_do_not_cost_the_gain_of_the_sweeps() {
    // A lattice of four by four squares, perturbed and stretched.
    let points = vec![
        [0.0, 0.0],
        [3.9, 0.0],
        [5.1, 0.0],
        [8.0, 0.0],
        [12.0, 0.0],
        [0.0, 1.4],
        [2.1, 1.4],
        [5.9, 0.8],
        [8.5, 1.2],
        [12.0, 0.7],
        [0.0, 1.7],
        [2.2, 1.8],
        [5.8, 2.0],
        [8.0, 1.8],
        [12.0, 1.7],
        [0.0, 3.0],
        [4.0, 3.0],
        [5.2, 3.2],
        [10.1, 3.1],
        [12.0, 2.9],
        [0.0, 4.0],
        [3.8, 4.0],
        [6.4, 4.0],
        [9.9, 4.0],
        [12.0, 4.0],
    ];
    let triangles = vec![
        [0, 1, 6],
        [0, 6, 5],
        [1, 2, 6],
        [2, 7, 6],
        [2, 3, 8],
        [2, 8, 7],
        [3, 4, 9],
        [3, 9, 8],
        [5, 6, 10],
        [6, 11, 10],
        [6, 7, 12],
        [6, 12, 11],
        [7, 8, 12],
        [8, 13, 12],
        [8, 9, 14],
        [8, 14, 13],
        [10, 11, 15],
        [11, 16, 15],
        [11, 12, 17],
        [11, 17, 16],
        [12, 13, 18],
        [12, 18, 17],
        [13, 14, 18],
        [14, 19, 18],
        [15, 16, 21],
        [15, 21, 20],
        [16, 17, 22],
        [16, 22, 21],
        [17, 18, 22],
        [18, 23, 22],
        [18, 19, 24],
        [18, 24, 23],
    ];
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    let smoother = Smoother::new(&mesh).unwrap();
    let outcome = run(&smoother, &acute(), &Backend::Cpu);
    let [before, after] = outcome.movable_f;
    assert!(after < 0.5 * before, "{before} to {after}");
    let refused = |points| counts(&mesh, points)[..2].iter().sum::<usize>();
    assert!(refused(&outcome.points) <= refused(&mesh.points));
}

#[test]
fn rounds_on_large_angles_keep_the_improvement_of_the_worst_triangles() {
    let mut kept = Vec::new();
    for seed in 0..4 {
        let mesh = support::perturb_random(&plate(300), 0.5, seed);
        let smoother = Smoother::new(&mesh).unwrap();
        for by in [WorstBy::Imr, WorstBy::MinAngle, WorstBy::Altitude] {
            let outcome = run(&smoother, &acute().improve_worst(Some(by)), &Backend::Cpu);
            kept.extend(outcome.large_angles.is_some().then_some(by));
            let told = outcome.improved.unwrap();
            let [before, after] = told.worst;
            let is_better = if by == WorstBy::Imr { after < before } else { after > before };
            assert!(is_better || told.vertices == 0 && after == before, "{seed} {by:?}: {told:?}");
        }
    }
    // Limits hold mean ratios and altitudes in the rounds, which then lessen angles beside the improvement.
    assert!([WorstBy::Imr, WorstBy::Altitude].iter().all(|by| kept.contains(by)), "{kept:?}");
}
