//! Periodic pairs of vertices, which slide together on both engines.

use crate::{backends, name, run};
use gpu_smooth::{
    Backend, Mesh, MeshError, Method, Metric, Options, Slide, SmoothError, Smoother, Stop,
    Stopping, Topology,
    options::{Precision, Relaxed},
    slide::{Motion, Periodic},
    topology,
};
use support::{SplitMix64, check, trig};

const COLUMNS: u32 = 10;
const ROWS: u32 = 6;

fn at(row: u32, column: u32) -> u32 {
    row * (COLUMNS + 1) + column
}

/// Makes a perturbed lattice of cells with two triangles each, mapped from the unit square by `to`. Vertices of the
/// first and last columns are perturbed equally along the columns, and likewise those of the first and last rows.
fn lattice(to: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let mut random = SplitMix64::new(11);
    let mut places = vec![[0.0; 2]; at(ROWS, COLUMNS) as usize + 1];
    let mut triangles = Vec::new();
    for row in 0..=ROWS {
        for column in 0..=COLUMNS {
            let mut off = |held: bool| if held { 0.0 } else { random.range(-0.3, 0.3) };
            let u = (f64::from(column) + off(column % COLUMNS == 0)) / f64::from(COLUMNS);
            let v = (f64::from(row) + off(row % ROWS == 0)) / f64::from(ROWS);
            places[at(row, column) as usize] = [u, v];
            if row < ROWS && column < COLUMNS {
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
                triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
    }
    for row in 0..=ROWS {
        places[at(row, COLUMNS) as usize][1] = places[at(row, 0) as usize][1];
    }
    for column in 0..=COLUMNS {
        places[at(ROWS, column) as usize][0] = places[at(0, column) as usize][0];
    }
    Mesh { points: places.into_iter().map(to).collect(), triangles, ..Mesh::default() }
}

fn sides() -> Vec<[u32; 2]> {
    (0..=ROWS).map(|row| [at(row, 0), at(row, COLUMNS)]).collect()
}

fn ends() -> Vec<[u32; 2]> {
    (0..=COLUMNS).map(|column| [at(0, column), at(ROWS, column)]).collect()
}

/// Maps the unit square to a sector of a ring with bent sides. A rotation by a ninth of a turn maps one side to the
/// other.
fn sector([u, v]: [f64; 2]) -> [f64; 2] {
    let bend = 0.008 * trig::on_circle(0.8 * v)[1];
    trig::on_circle(u / 9.0 + bend).map(|x| (1.0 + 0.6 * v) * x)
}

fn turn() -> Motion {
    let [cos, sin] = trig::on_circle(1.0 / 9.0);
    [[cos, -sin, 0.0], [sin, cos, 0.0]]
}

fn sliding<'m>(mesh: &'m Mesh, slide: &Slide) -> (Smoother<'m>, usize) {
    let mut smoother = Smoother::new(mesh).unwrap();
    let count = smoother.set_slide(Some(slide)).unwrap();
    (smoother, count)
}

fn periodic(pairs: Vec<[u32; 2]>) -> Slide {
    let periodic = vec![Periodic { pairs, motion: None }];
    Slide { periodic, ..Slide::default() }
}

/// Returns the largest distance between the second vertex of a pair and the image of the first vertex under the motion.
fn apart(points: &[[f64; 2]], pairs: &[[u32; 2]], [x, y]: Motion) -> f64 {
    let off = |&[a, b]: &[u32; 2]| {
        let [from, to] = [a, b].map(|v| points[v as usize]);
        let there = [x, y].map(|row| row[0] * from[0] + row[1] * from[1] + row[2]);
        check::squared_distance(there, to).sqrt()
    };
    pairs.iter().map(off).fold(0.0, f64::max)
}

fn translation(x: f64, y: f64) -> Motion {
    [[1.0, 0.0, x], [0.0, 1.0, y]]
}

#[test]
fn partners_of_a_translation_slide_together_on_both_engines() {
    let mesh = lattice(|[u, v]| [2.0 * u, v]);
    let alone = Slide { held: sides().concat(), ..Slide::default() };
    let slide = periodic(sides());
    let (smoother, count) = sliding(&mesh, &slide);
    let inner = [ROWS, COLUMNS].map(|count| count as usize - 1);
    assert_eq!(count, 2 * (inner[0] + inner[1]));
    assert_eq!(smoother.pairs(), [inner[0], 0]);
    let held = run(&sliding(&mesh, &alone).0, &Options::default(), &Backend::Cpu);
    let topology = Topology::new(&mesh).unwrap();
    let by_sweeps = Options::default().method(Method::Relaxed(Relaxed::default()));
    let methods = [Options::default(), by_sweeps];
    for (backend, options) in backends().iter().flat_map(|b| methods.each_ref().map(|o| (b, o))) {
        let label = name(backend);
        let outcome = run(&smoother, options, backend);
        assert_eq!(outcome.stop, Stop::Converged, "{label}");
        let slid = outcome.slid.unwrap();
        assert_eq!((slid.moved, slid.pairs), (count, inner[0]), "{label}");
        assert!(apart(&outcome.points, &sides(), translation(2.0, 0.0)) < 1e-15, "{label}");
        let f = |points: &[[f64; 2]]| smoother.f(Metric::Imr, points).unwrap();
        assert!(f(&outcome.points) < f(&held.points) - 1e-3, "{label}");
        let bad = topology::infeasible(&outcome.points, smoother.topology().triangles()).unwrap();
        assert!(bad.is_empty(), "{label}");
        let misplaced = |points: &[[f64; 2]]| {
            slide.misplaced(&topology, &mesh.points, points, Precision::Double)
        };
        assert!(misplaced(&outcome.points).is_empty(), "{label}");
        // First, one vertex of a pair has moved on alone; then one has moved back alone.
        let mut spoiled = outcome.points.clone();
        spoiled[at(2, 0) as usize][1] += 1e-4;
        assert_eq!(misplaced(&spoiled), [at(2, 0), at(2, COLUMNS)], "{label}");
        spoiled[at(2, 0) as usize] = mesh.points[at(2, 0) as usize];
        assert_eq!(misplaced(&spoiled), [at(2, COLUMNS)], "{label}");
        // If one vertex of a pair is reset, its partner is reset too.
        let mut points = outcome.points.clone();
        points[at(2, 0) as usize] = mesh.points[at(2, 0) as usize];
        smoother.certify(&mut points).unwrap();
        assert_eq!(points[at(2, COLUMNS) as usize], mesh.points[at(2, COLUMNS) as usize]);
    }
}

/// At the minimum, moving a pair along its sides must raise the sum of f over both patches.
#[test]
fn a_pair_rests_where_both_patches_together_are_best() {
    let mesh = lattice(|[u, v]| [2.0 * u, v]);
    let (smoother, _) = sliding(&mesh, &periodic(sides()));
    let options = Options::default().stopping(Stopping::Tolerance(1e-10));
    let outcome = run(&smoother, &options, &Backend::Cpu);
    let f = |points: &[[f64; 2]]| smoother.f(Metric::Imr, points).unwrap();
    let best = f(&outcome.points);
    for [a, b] in sides()[1..ROWS as usize].iter().copied() {
        for way in [-1e-3, 1e-3] {
            let mut points = outcome.points.clone();
            [a, b].iter().for_each(|&v| points[v as usize][1] += way);
            assert!(f(&points) > best, "{a}, {b}: {}", f(&points) - best);
        }
    }
}

#[test]
fn partners_of_a_rotation_slide_together_along_curved_sides() {
    let mesh = lattice(sector);
    let topology = Topology::new(&mesh).unwrap();
    let inner = ROWS as usize - 1;
    // Pairs may be given by their motion, or as two sides.
    let mut by_motion = Slide::default();
    assert_eq!(by_motion.pair_by(&topology, &mesh.points, turn()), inner + 2);
    let mut by_sides = Slide::default();
    let [left, right] = [0, 1].map(|k| sides().iter().map(|pair| pair[k]).collect::<Vec<_>>());
    let found = by_sides.pair_sides(&topology, &mesh.points, [&right, &left]);
    assert_eq!(found, inner + 2);
    assert!(by_sides.periodic[0].pairs.iter().all(|&[b, a]| sides().contains(&[a, b])));
    let mut results = Vec::new();
    for slide in [periodic(sides()), by_motion, by_sides] {
        let (smoother, _) = sliding(&mesh, &slide);
        assert_eq!(smoother.pairs(), [inner, 0]);
        let outcome = run(&smoother, &Options::default(), &Backend::Cpu);
        assert!(outcome.slid.unwrap().moved > 2 * inner);
        assert!(apart(&outcome.points, &sides(), turn()) < 1e-14);
        let moved = |&[a, _]: &[u32; 2]| mesh.points[a as usize] != outcome.points[a as usize];
        assert_eq!(sides().iter().filter(|pair| moved(pair)).count(), inner);
        assert!(
            slide.misplaced(&topology, &mesh.points, &outcome.points, Precision::Double).is_empty()
        );
        results.push(smoother.f(Metric::Imr, &outcome.points).unwrap());
    }
    // The choice of the leading side changes only rounding.
    assert!(results.iter().all(|f| (f / results[0] - 1.0).abs() < 1e-6), "{results:?}");
}

#[test]
fn a_bound_and_an_altitude_hold_for_both_of_a_pair() {
    let mesh = lattice(sector);
    let slide = periodic(sides());
    let (smoother, _) = sliding(&mesh, &slide);
    let bounds = [
        Options::default().max_move(Some(0.1)),
        Options::default().keep_altitude(true),
        Options::default().stored(Precision::Single),
    ];
    for options in bounds {
        let outcome = run(&smoother, &options, &Backend::Cpu);
        assert!(outcome.slid.unwrap().moved > 10);
        let rounding = if options.stored == Precision::Single { 3e-7 } else { 1e-14 };
        assert!(apart(&outcome.points, &sides(), turn()) < rounding, "{options:?}");
    }
}

#[test]
fn corners_of_a_doubly_periodic_square_stay_and_all_else_slides_in_pairs() {
    let mesh = lattice(|place| place);
    let both = |pairs| Periodic { pairs, motion: None };
    let slide = Slide { periodic: vec![both(sides()), both(ends())], ..Slide::default() };
    let (smoother, count) = sliding(&mesh, &slide);
    let inner = [ROWS, COLUMNS].map(|count| count as usize - 1);
    assert_eq!(count, 2 * (inner[0] + inner[1]));
    assert_eq!(smoother.pairs(), [inner[0] + inner[1], 0]);
    let outcome = run(&smoother, &Options::default(), &Backend::Cpu);
    assert!(apart(&outcome.points, &sides(), translation(1.0, 0.0)) < 1e-15);
    assert!(apart(&outcome.points, &ends(), translation(0.0, 1.0)) < 1e-15);
    for corner in [at(0, 0), at(0, COLUMNS), at(ROWS, 0), at(ROWS, COLUMNS)] {
        assert_eq!(outcome.points[corner as usize], mesh.points[corner as usize]);
    }
}

#[test]
fn a_corner_on_one_periodic_side_holds_its_partner_too() {
    let mesh = lattice(|[u, v]| [2.0 * u, v]);
    let mut slide = periodic(sides());
    slide.held = vec![at(3, COLUMNS)];
    let (smoother, count) = sliding(&mesh, &slide);
    let inner = [ROWS, COLUMNS].map(|count| count as usize - 1);
    assert_eq!(count, 2 * (inner[0] - 1 + inner[1]));
    let outcome = run(&smoother, &Options::default(), &Backend::Cpu);
    let still = at(3, 0) as usize;
    assert_eq!(outcome.points[still], mesh.points[still]);
    assert!(apart(&outcome.points, &sides(), translation(2.0, 0.0)) < 1e-15);
}

#[test]
fn pairs_that_are_not_alike_stay_and_impossible_pairs_are_errors() {
    let inner = [ROWS, COLUMNS].map(|count| count as usize - 1);
    let mut mesh = lattice(|[u, v]| [2.0 * u, v]);
    mesh.points[at(3, COLUMNS) as usize][1] += 0.01;
    let (smoother, count) = sliding(&mesh, &periodic(sides()));
    // The displaced pair stays, and so do its neighbors, because the curves through the pair differ.
    assert_eq!(count, 2 * (inner[0] - 3 + inner[1]));
    assert_eq!(smoother.pairs(), [inner[0] - 3, 1]);
    // A chain in which each vertex is paired with the next, and a vertex paired with itself.
    let row: Vec<[u32; 2]> = (1..COLUMNS - 1).map(|c| [at(0, c), at(0, c + 1)]).collect();
    let own = vec![[at(2, 0); 2]];
    for (pairs, still) in [(row, inner[1]), (own, 1)] {
        let (smoother, count) = sliding(&mesh, &periodic(pairs));
        assert_eq!(count, 2 * (inner[0] + inner[1]) - still);
        run(&smoother, &Options::default(), &Backend::Cpu);
    }
    let mut smoother = Smoother::new(&mesh).unwrap();
    let error = smoother.set_slide(Some(&periodic(vec![[0, 9999]]))).unwrap_err();
    assert!(matches!(error, SmoothError::Mesh(MeshError::IndexOutOfRange { .. })), "{error}");
    let topology = Topology::new(&mesh).unwrap();
    let mut slide = Slide::default();
    for motion in [translation(0.5, 0.0), translation(f64::NAN, 0.0), [[2.0, 0.0, 0.0]; 2]] {
        assert_eq!(slide.pair_by(&topology, &mesh.points, motion), 0);
    }
    assert_eq!(slide.pair_by(&topology, &mesh.points, translation(0.0, 0.0)), 0);
    let [left, right] = [0, 1].map(|k| sides().iter().map(|pair| pair[k]).collect::<Vec<_>>());
    assert_eq!(slide.pair_sides(&topology, &mesh.points, [&left, &right]), 0);
    assert_eq!(slide.pair_sides(&topology, &mesh.points, [&left, &[]]), 0);
    assert_eq!(slide, Slide::default());
}

/// Makes a strip, two cells wide up to the third row and one cell wide above. In the upper part, a triangle contains
/// both vertices of a pair, so the effect of a joint move is not the sum of two single moves.
#[test]
fn partners_of_one_triangle_stay() {
    let row =
        |k: u32, places: &[f64]| places.iter().map(|&x| [x, f64::from(k)]).collect::<Vec<_>>();
    let wide = (0..3).flat_map(|k| row(k, &[0.0, 0.5, 1.0]));
    let points: Vec<[f64; 2]> = wide.chain((3..6).flat_map(|k| row(k, &[0.0, 1.0]))).collect();
    let field = |a: u32, b: u32, c: u32, d: u32| [[a, b, d], [a, d, c]];
    let mut triangles: Vec<[u32; 3]> = vec![[6, 7, 9], [7, 8, 10], [7, 10, 9]];
    for k in [0, 1, 3, 4] {
        triangles.extend(field(k, k + 1, k + 3, k + 4));
    }
    triangles.extend([field(9, 10, 11, 12), field(11, 12, 13, 14)].concat());
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    let mut slide = Slide::default();
    assert_eq!(slide.pair_by(&topology, &mesh.points, translation(1.0, 0.0)), 6);
    let (smoother, count) = sliding(&mesh, &slide);
    // Two pairs slide, and one vertex of the lower end.
    assert_eq!((count, smoother.pairs()), (5, [2, 0]));
    run(&smoother, &Options::default(), &Backend::Cpu);
}
