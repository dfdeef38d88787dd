//! Meshes of quadrilaterals, alone and mixed with triangles: topology, runs on the CPU and what they keep.

use gpu_smooth::{
    Element, Mesh, MeshError, Metric, Options, Outcome, Quality, Slide, Smoother, Topology,
    Untangle, layers::Layers, options::WorstBy, topology,
};
use std::borrow::Cow;

/// Makes a square of `n` times `n` cells of side 1. `is_cut` tells which cells are two triangles instead of a quadrilateral.
fn lattice(n: u32, is_cut: impl Fn(u32, u32) -> bool) -> Mesh {
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let mut mesh = Mesh::default();
    for j in 0..=n {
        mesh.points.extend((0..=n).map(|i| [f64::from(i), f64::from(j)]));
    }
    for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        match is_cut(i, j) {
            true => mesh.triangles.extend([[a, b, c], [a, c, d]]),
            false => mesh.quadrilaterals.push([a, b, c, d]),
        }
    }
    mesh
}

fn squares(n: u32) -> Mesh {
    lattice(n, |_, _| false)
}

/// A lattice in which a third of the cells, at irregular places, are triangles.
fn mixed(n: u32) -> Mesh {
    lattice(n, |i, j| (i * 7 + j * 5 + i * j) % 3 == 0)
}

/// A generator of random numbers from -1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    }
}

/// Returns the mesh with each vertex inside displaced by up to `most` along both axes.
fn perturbed(mesh: &Mesh, most: f64) -> Mesh {
    let topology = Topology::new(mesh).unwrap();
    let mut random = Random(7);
    let mut mesh = mesh.clone();
    for (point, _) in mesh.points.iter_mut().zip(topology.free()).filter(|(_, free)| **free) {
        *point = point.map(|x| x + most * random.next());
    }
    mesh
}

/// Prepares a mesh whose boundary layers may move.
fn prepared(mesh: &Mesh) -> Smoother<'_> {
    Smoother::keeping(Cow::Borrowed(mesh), Layers::default()).unwrap()
}

fn run(mesh: &Mesh, options: &Options) -> Outcome {
    prepared(mesh).run(options).block().unwrap()
}

/// Returns the corners of all elements: triangles, and four triangles for each quadrilateral.
fn corners(mesh: &Mesh) -> Vec<[u32; 3]> {
    let of = |&[a, b, c, d]: &[u32; 4]| [[a, b, d], [b, c, a], [c, d, b], [d, a, c]];
    mesh.triangles.iter().copied().chain(mesh.quadrilaterals.iter().flat_map(of)).collect()
}

fn doubled_area(points: &[[f64; 2]], corner: [u32; 3]) -> f64 {
    let [p, q, r] = corner.map(|v| points[v as usize]);
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

/// Returns whether all corners are counter-clockwise, with a margin for rounding.
fn is_convex(mesh: &Mesh, points: &[[f64; 2]]) -> bool {
    corners(mesh).into_iter().all(|corner| doubled_area(points, corner) > 1e-12)
}

/// Returns the squared inverse mean ratio of a corner by its definition: (|a|² + |b|²) / 2 a×b for a quadrilateral, and
/// (|a|² + |b|² + |b - a|²) / 2√3 a×b for a triangle.
fn squared_imr(points: &[[f64; 2]], corner: [u32; 3], is_right: bool) -> f64 {
    let [p, q, r] = corner.map(|v| points[v as usize]);
    let square = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2);
    let (sides, third) = (square(p, q) + square(p, r), square(q, r));
    let area = doubled_area(points, corner);
    let ratio =
        if is_right { sides / (2.0 * area) } else { (sides + third) / (12f64.sqrt() * area) };
    ratio * ratio
}

/// Returns f by imr: the mean over elements, a quadrilateral by the mean over its corners.
fn f(mesh: &Mesh, points: &[[f64; 2]]) -> f64 {
    let triangles = mesh.triangles.len();
    let sum: f64 = (0..)
        .zip(corners(mesh))
        .map(|(k, corner)| match k < triangles {
            true => squared_imr(points, corner, false),
            false => 0.25 * squared_imr(points, corner, true),
        })
        .sum();
    sum / (triangles + mesh.quadrilaterals.len()) as f64
}

#[test]
fn a_disturbed_lattice_becomes_squares_by_each_metric() {
    let squares = squares(12);
    let mesh = perturbed(&squares, 0.3);
    for &metric in Metric::ALL {
        let outcome = run(&mesh, &Options::default().scheme(metric.into()));
        assert!(is_convex(&mesh, &outcome.points), "{metric}");
        let off = outcome.points.iter().zip(&squares.points);
        let off = off.map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1])).fold(0.0, f64::max);
        assert!(off < 0.02, "{metric}: {off}");
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
        let outcome = run(&mesh, &Options::default());
        let after = f(&mesh, &outcome.points);
        let told = outcome.history[outcome.best_sweep as usize].of(Metric::Imr).unwrap();
        assert!((told / after - 1.0).abs() < 1e-9 && after < expected, "{told} {after}");
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
        for metric in [Metric::Imr, Metric::Rms, Metric::ShapeSize, Metric::Tmop80] {
            let outcome = run(&mesh, &Options::default().scheme(metric.into()).max_sweeps(200));
            let smoother = prepared(&mesh);
            let f = |points: &[[f64; 2]]| smoother.f(metric, points).unwrap();
            let least = f(&outcome.points);
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

/// Brute force: a boundary edge belongs to a single element, and a free vertex to no boundary edge.
#[test]
fn boundary_and_free_vertices_are_those_of_the_edges() {
    let mut random = Random(3);
    for round in 0..40 {
        let mut mesh = mixed(7);
        let share = 0.5 * f64::from(round % 10) / 10.0;
        mesh.quadrilaterals.retain(|_| random.next() > 2.0 * share - 1.0);
        mesh.triangles.retain(|_| random.next() > 2.0 * share - 1.0);
        let mut uses = std::collections::HashMap::new();
        let sides = |vertices: &[u32]| {
            let next = vertices.iter().cycle().skip(1);
            vertices.iter().zip(next).map(|(&a, &b)| [a, b]).collect::<Vec<_>>()
        };
        let elements = mesh.triangles.iter().map(|t| &t[..]);
        let elements = elements.chain(mesh.quadrilaterals.iter().map(|q| &q[..]));
        let all: Vec<[u32; 2]> = elements.flat_map(sides).collect();
        for &[a, b] in &all {
            *uses.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
        }
        let mut expected: Vec<[u32; 2]> =
            all.iter().copied().filter(|&[a, b]| uses[&[a.min(b), a.max(b)]] == 1).collect();
        expected.sort_unstable();
        let topology = Topology::new(&mesh).unwrap();
        let mut found = topology.boundary_edges();
        found.sort_unstable();
        assert_eq!(found, expected);
        let free =
            |v: u32| all.iter().any(|edge| edge[0] == v) && !expected.as_flattened().contains(&v);
        for v in 0..mesh.points.len() as u32 {
            assert_eq!(topology.free()[v as usize], free(v), "vertex {v}");
        }
        let loops: usize = topology.boundary_loops().iter().map(Vec::len).sum();
        assert_eq!(loops, expected.len());
    }
}

#[test]
fn quadrilaterals_that_are_not_convex_are_refused_with_their_corners() {
    let mut mesh = squares(3);
    // The vertex is moved through the diagonal of the upper right quadrilateral around it.
    mesh.points[5] = [1.7, 1.6];
    let refused = Smoother::new(&mesh).unwrap_err();
    let MeshError::Infeasible { triangles, quadrilaterals } = &refused else { panic!("{refused}") };
    assert!(triangles.is_empty());
    let bad: Vec<_> =
        quadrilaterals.iter().map(|q| (q.quadrilateral, q.vertices[q.corner], q.flat)).collect();
    assert_eq!(bad, [(4, 5, false)]);
    assert_eq!(
        refused.to_string(),
        "1 corner of quadrilaterals is not convex: 4 (concave at vertex 5)"
    );
    mesh.points[5] = [1.5, 1.5];
    let flat = Smoother::new(&mesh).unwrap_err().to_string();
    assert!(flat.contains("4 (flat at vertex 5)"), "{flat}");
}

#[test]
fn a_vertex_between_two_elements_is_refused_as_a_doublet() {
    // The middle vertex is between two quadrilaterals alone.
    let points = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0]];
    let quadrilaterals = vec![[0, 1, 2, 4], [0, 4, 2, 3]];
    let mesh = Mesh { points, quadrilaterals, ..Mesh::default() };
    let expected = MeshError::Doublet {
        vertex: 4,
        elements: [Element::Quadrilateral(0), Element::Quadrilateral(1)],
    };
    assert_eq!(Topology::new(&mesh).unwrap_err(), expected);
    let mixed = Mesh { triangles: vec![[2, 3, 0]], quadrilaterals: vec![[0, 1, 2, 4]], ..mesh };
    assert!(Topology::new(&mixed).is_ok());
}

#[test]
fn errors_name_quadrilaterals() {
    let mesh = squares(3);
    let with = |quadrilateral| {
        let mut mesh = mesh.clone();
        mesh.quadrilaterals[2] = quadrilateral;
        Topology::new(&mesh).unwrap_err().to_string()
    };
    assert_eq!(with([0, 1, 99, 4]), "vertex 99 does not exist: the mesh has 16, counted from 0");
    assert_eq!(with([2, 3, 2, 6]), "quadrilateral 2 uses vertex 2 twice");
    let mut three = mesh.clone();
    three.quadrilaterals.extend([[0, 1, 5, 9], [0, 1, 5, 8]]);
    let error = Topology::new(&three).unwrap_err().to_string();
    assert!(error.ends_with("belongs to 3 quadrilaterals"), "{error}");
    three.triangles.push([0, 1, 10]);
    let error = Topology::new(&three).unwrap_err().to_string();
    assert!(error.ends_with("elements"), "{error}");
}

#[test]
fn vertices_of_elements_that_are_not_convex_are_set_back() {
    let mesh = squares(4);
    let topology = Topology::new(&mesh).unwrap();
    let mut points = mesh.points.clone();
    // The first vertex makes its quadrilaterals concave, the second leaves them convex.
    points[6] = [1.6, 1.6];
    points[18] = [3.2, 2.9];
    assert_eq!(topology::certify(&topology, &mesh.points, &mut points), Ok(1));
    assert_eq!((points[6], points[18]), ([1.0, 1.0], [3.2, 2.9]));
    // A drag ends before the corner becomes flat.
    let share =
        topology.move_clamped(&mut points, &[(6, [1.0 + 0.8, 1.0 + 0.8])], f64::INFINITY).unwrap();
    assert!((share - 0.625).abs() < 1e-6, "{share}");
    assert_eq!(topology.bad_quadrilaterals(&points), Ok(vec![]));
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
    let kept = run(&mesh, &Options::default().keep_altitude(true));
    assert!(altitude(&kept.points) >= altitude(&mesh.points) * (1.0 - 1e-12));
    let near = run(&mesh, &Options::default().max_move(Some(0.05)));
    let moves = near.points.iter().zip(&mesh.points);
    let most = moves.map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1])).fold(0.0, f64::max);
    // Distances are in units of the mean edge at each vertex, which is below 1.6.
    assert!(most <= 0.05 * 1.6 && most > 0.04, "{most}");
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
    let outcome = smoother.run(&Options::default()).block().unwrap();
    assert!(is_convex(&mesh, &outcome.points));
    let off = outcome.points.iter().zip(&squares.points);
    let off = off.map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1])).fold(0.0, f64::max);
    assert!(off < 0.03, "{off}");
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

/// Returns the number of corners that are not convex.
fn concave(mesh: &Mesh, points: &[[f64; 2]]) -> usize {
    corners(mesh).into_iter().filter(|&corner| doubled_area(points, corner) <= 0.0).count()
}

#[test]
fn tangled_quadrilaterals_are_untangled() {
    for (lattice, most) in
        [(squares(10), 1.0), (squares(10), 4.0), (mixed(10), 1.0), (mixed(14), 6.0)]
    {
        let mesh = perturbed(&lattice, most);
        let untangled = Untangle::new(&mesh).run().unwrap();
        assert_eq!(untangled.bad_before, concave(&mesh, &mesh.points), "{most}");
        assert!(untangled.is_feasible() && is_convex(&mesh, &untangled.points), "{most}");
        let free = Topology::by_area(&mesh).unwrap().free().to_vec();
        let stays = |v: usize| free[v] || untangled.points[v] == mesh.points[v];
        assert!((0..free.len()).all(stays));
        let smoothed = run(&Mesh { points: untangled.points, ..mesh.clone() }, &Options::default());
        assert!(f(&mesh, &smoothed.points) < 1.5);
    }
}

#[test]
fn corners_of_fixed_vertices_that_are_not_convex_are_hopeless() {
    let mut mesh = squares(4);
    // The corner at the vertex 0 of the first quadrilateral has fixed vertices alone.
    mesh.points[0] = [1.2, 1.2];
    let untangled = Untangle::new(&mesh).run().unwrap();
    let corner = |bad: &topology::BadQuadrilateral| (bad.quadrilateral, bad.vertices[bad.corner]);
    assert_eq!(untangled.hopeless_quadrilaterals.iter().map(corner).collect::<Vec<_>>(), [(0, 0)]);
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
    let mut random = Random(5);
    let topology = Topology::new(&layers).unwrap();
    for (v, _) in topology.free().iter().enumerate().filter(|(_, free)| **free) {
        let height = layers.points[v + 13][1] - layers.points[v][1];
        mesh.points[v][0] += 0.2 * random.next();
        mesh.points[v][1] += 0.2 * height * random.next();
    }
    let mut smoother = prepared(&mesh);
    let targets = gpu_smooth::Targets::keep_shape(&topology, &layers.points, 0).unwrap();
    smoother.set_targets(&targets).unwrap();
    let outcome = smoother.run(&Options::default().scheme(Metric::Tmop80.into())).block().unwrap();
    assert!(is_convex(&mesh, &outcome.points));
    for v in (13..143).filter(|v| v % 13 > 0 && v % 13 < 12) {
        let spacing = |points: &[[f64; 2]]| points[v + 13][1] - points[v][1];
        let ratio = spacing(&outcome.points) / spacing(&layers.points);
        assert!((ratio - 1.0).abs() < 0.1, "vertex {v}: {ratio}");
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
