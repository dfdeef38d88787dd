//! Random planar meshes and options on both engines, with checks that must hold for all of them.
//!
//! - `GPU_SMOOTH_RANDOM_MESHES=N` takes N meshes instead of a few.
//! - `GPU_SMOOTH_RANDOM_SEED=K` takes the meshes from seed K on.
//! - `GPU_SMOOTH_RANDOM_VERTICES=V` lets each part of a mesh have up to V vertices.
//!
//! A failure prints the seed of its mesh. Failing meshes are not shrunk (as by proptest): with one triangle, point or
//! map less, most failures disappear, and most meshes are small anyway.

use crate::floor::worst;
use crate::{all_schemes, backends, history, name, with_points};
use gpu_smooth::{
    Backend, Goal, Mesh, MeshError, Method, Metric, Options, Outcome, Quality, SmoothError,
    Smoother, Stopping,
    options::{Derivatives, PNormExponent, Paper, Precision, Relaxed},
};
use mesh_io::MeshFile;
use spade::{DelaunayTriangulation, Point2, Triangulation};
use support::SplitMix64;

/// Returns a random number from 10^low to 10^high, uniform in the logarithm.
fn decades(rng: &mut SplitMix64, low: f64, high: f64) -> f64 {
    10f64.powf(rng.range(low, high))
}

/// Returns the largest number of vertices in a part of a mesh.
fn most_vertices() -> usize {
    setting("GPU_SMOOTH_RANDOM_VERTICES", 65) as usize
}

/// Makes a Delaunay mesh of random points in a square, a disk or clusters. The number of vertices is at least one,
/// uniform in the logarithm.
pub(crate) fn scattered(rng: &mut SplitMix64) -> Mesh {
    let most = most_vertices() as f64;
    let count = decades(rng, 0.0, most.log10()).ceil() as usize;
    let kind = rng.below(3);
    let mut all = DelaunayTriangulation::<Point2<f64>>::new();
    for _ in 0..count {
        let [x, y] = [rng.range(-1.0, 1.0), rng.range(-1.0, 1.0)];
        let [x, y] = match kind {
            0 => [x, y],
            1 => [x * (1.0 - y * y).sqrt(), y],
            _ => [x * x * x + (4.0 * y).round(), y * y * y],
        };
        all.insert(Point2::new(x, y)).unwrap();
    }
    Mesh {
        points: all.vertices().map(|v| [v.position().x, v.position().y]).collect(),
        triangles: all
            .inner_faces()
            .map(|f| f.vertices().map(|v| v.fix().index() as u32))
            .collect(),
        ..Mesh::default()
    }
}

/// Makes a mesh of triangles between a vertex and up to a hundred vertices around it, in one or several rings.
fn hub(rng: &mut SplitMix64) -> Mesh {
    let around = 3 + rng.below(100) as u32;
    let rings = 1 + rng.below(3) as u32;
    let mut mesh =
        Mesh { points: vec![[rng.range(-0.2, 0.2), rng.range(-0.2, 0.2)]], ..Mesh::default() };
    for ring in 0..rings {
        for k in 0..around {
            let [cos, sin] = support::trig::on_circle(
                (f64::from(k) + 0.5 * f64::from(ring)) / f64::from(around),
            );
            mesh.points.push([f64::from(ring + 1) * cos, f64::from(ring + 1) * sin]);
        }
        for k in 0..around {
            let at = |ring: u32, k: u32| 1 + ring * around + k % around;
            let (a, b) = (at(ring, k), at(ring, k + 1));
            match ring {
                0 => mesh.triangles.push([0, a, b]),
                _ => {
                    let (c, d) = (at(ring - 1, k), at(ring - 1, k + 1));
                    mesh.triangles.extend([[c, a, d], [a, b, d]]);
                }
            }
        }
    }
    mesh
}

/// Makes a mesh of a random kind, without distortion.
fn plain(rng: &mut SplitMix64) -> Mesh {
    match rng.below(5) {
        0 | 1 => scattered(rng),
        2 => hub(rng),
        3 => {
            let side = ((most_vertices() as f64).sqrt() as usize).max(12);
            support::lattice(2 + rng.below(side), 2 + rng.below(side))
        }
        // A strip.
        _ => support::lattice(2 + rng.below(60), 2),
    }
}

/// Joins two meshes as components of one mesh, the second on the right of the first.
fn beside(mut left: Mesh, right: &Mesh) -> Mesh {
    let end = |mesh: &Mesh, sign: f64| {
        mesh.points.iter().fold(f64::NEG_INFINITY, |end, point| end.max(sign * point[0]))
    };
    let (shift, first) = (end(&left, 1.0) + end(right, -1.0) + 1.0, left.points.len() as u32);
    left.points.extend(right.points.iter().map(|[x, y]| [x + shift, *y]));
    left.triangles.extend(right.triangles.iter().map(|triangle| triangle.map(|v| v + first)));
    left
}

/// Applies a map to all points, unless the map inverts a triangle.
fn mapped(mesh: Mesh, map: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let after = with_points(&mesh, &mesh.points.iter().map(|&p| map(p)).collect::<Vec<_>>());
    if support::is_ccw(&after) { after } else { mesh }
}

/// Makes a random planar mesh of counterclockwise triangles.
fn random_mesh(rng: &mut SplitMix64) -> Mesh {
    let mut mesh = plain(rng);
    if rng.below(5) == 0 {
        mesh = beside(mesh, &plain(rng));
    }
    if mesh.triangles.is_empty() {
        return mesh;
    }
    if rng.below(2) == 0 {
        mesh = support::perturb_random(&mesh, rng.range(0.2, 1.0), rng.next_u64());
    }
    // Makes slivers by moving a vertex almost onto the opposite edge.
    if rng.below(3) == 0 {
        let held = support::check::held(&mesh);
        let [t, corner] = [rng.below(mesh.triangles.len()), rng.below(3)];
        let [v, a, b] = [0, 1, 2].map(|i| mesh.triangles[t][(corner + i) % 3] as usize);
        if !held[v] {
            let height = decades(rng, -17.0, -1.0);
            let points = &mesh.points;
            let to = [0, 1].map(|x| {
                (points[a][x] + points[b][x]) / 2.0 * (1.0 - height) + points[v][x] * height
            });
            let moved = mesh.clone();
            mesh.points[v] = to;
            if !support::is_ccw(&mesh) {
                mesh = moved;
            }
        }
    }
    // Grades the mesh toward a random point, stretches, turns, scales and shifts it.
    if rng.below(3) == 0 {
        let power = rng.range(1.0, 12.0);
        let about = [rng.range(-1.0, 1.0), rng.range(-1.0, 1.0)];
        mesh = mapped(mesh, |[x, y]| {
            let [x, y] = [x - about[0], y - about[1]];
            let factor = (x.hypot(y) / 3.0).powf(power);
            [about[0] + x * factor, about[1] + y * factor]
        });
    }
    if rng.below(3) == 0 {
        let stretch = decades(rng, 0.0, 6.0);
        mesh = mapped(mesh, |[x, y]| [x * stretch, y]);
    }
    if rng.below(3) == 0 {
        let [cos, sin] = support::trig::on_circle(rng.unit());
        mesh = mapped(mesh, |[x, y]| [cos * x - sin * y, sin * x + cos * y]);
    }
    if rng.below(3) == 0 {
        let far = [decades(rng, 0.0, 14.0), -decades(rng, 0.0, 14.0)];
        mesh = mapped(mesh, |[x, y]| [x + far[0], y + far[1]]);
    }
    if rng.below(3) == 0 {
        let scale = decades(rng, -80.0, 80.0);
        mesh = mapped(mesh, |[x, y]| [x * scale, y * scale]);
    }
    // Adds holes, fixed vertices, and vertices that no triangle uses.
    if rng.below(3) == 0 {
        let keep = rng.range(0.7, 1.0);
        mesh.triangles.retain(|_| rng.unit() < keep);
    }
    if rng.below(3) == 0 {
        let count = mesh.points.len();
        mesh.fixed = (0..rng.below(4)).map(|_| rng.below(count) as u32).collect();
        mesh.points.push([rng.range(-9.0, 9.0), 7.0]);
    }
    mesh
}

fn random_options(rng: &mut SplitMix64) -> Options {
    let mut schemes = all_schemes();
    let mut options = Options::default()
        .scheme(schemes.swap_remove(rng.below(schemes.len())))
        .max_sweeps(rng.below(60) as u32)
        .stopping(Stopping::Tolerance([0.0, 1e-3, 1e-6, 1e-12][rng.below(4)]))
        .track_all(rng.below(4) == 0);
    match rng.below(8) {
        0 => options.method = Method::RELAXED,
        1 => {
            let omega = Some(rng.range(0.1, 1.99));
            options.method = Method::Relaxed(Relaxed { omega, ..Relaxed::default() });
        }
        2 => {
            let newton_steps = 1 + rng.below(4) as u32;
            options.method = Method::Paper(Paper { newton_steps, ..Paper::default() });
        }
        3 => options.edge_norm = Some(PNormExponent::CONTINUED),
        4 => {
            let derivatives = Derivatives::FiniteDifference;
            options.method = Method::Paper(Paper { derivatives, ..Paper::default() });
        }
        5 => options.stored = Precision::Single,
        6 => {
            let fraction = rng.range(0.1, 1.0);
            let desired = Some(rng.range(0.5, 2.0));
            options.stopping = Stopping::Goal(Goal { fraction, desired });
        }
        _ => {}
    }
    options
}

/// Returns the length of the shortest edge, divided by the rounding of the largest coordinate in single precision, in
/// which options may request results.
fn digits(mesh: &Mesh) -> f64 {
    let size = mesh.points.as_flattened().iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    let edges = mesh.triangles.iter().flat_map(|&t| support::check::edges(t));
    let squared = |[a, b]: [u32; 2]| {
        support::check::squared_distance(mesh.points[a as usize], mesh.points[b as usize])
    };
    edges.map(squared).fold(f64::INFINITY, f64::min).sqrt() / (size * f64::from(f32::EPSILON))
}

/// Checks the properties of every outcome. `near` is the allowed relative error of f on the engine.
fn check(mesh: &Mesh, smoother: &Smoother<'_>, options: &Options, outcome: &Outcome, near: f64) {
    let base = options.scheme.base();
    let after = with_points(mesh, &outcome.points);
    assert!(support::is_ccw(&after), "a triangle is inverted");
    assert!(outcome.points.as_flattened().iter().all(|x| x.is_finite()));
    let held = support::check::held(mesh);
    for (v, (was, is)) in mesh.points.iter().zip(&after.points).enumerate() {
        let same = was.map(f64::to_bits) == is.map(f64::to_bits);
        assert!(same || !held[v], "the fixed vertex {v} has moved");
        let single = is.iter().all(|&x| f64::from(x as f32) == x);
        assert!(options.stored == Precision::Double || single, "vertex {v} is not as stored");
    }
    let f = |points: &[[f64; 2]]| Quality::of(points, smoother.topology()).unwrap().f(base);
    let (before, end) = (f(&mesh.points), f(&outcome.points));
    assert!(end <= before, "f rose from {before} to {end}");
    assert_eq!(outcome.best_sweep == 0, outcome.points == mesh.points, "{}", outcome.best_sweep);
    if is_by_default(options) {
        check_worst(mesh, outcome, &held);
    }
    let history = history(outcome, base);
    assert_eq!(history.len() as u32, outcome.sweeps + 1);
    assert!(outcome.sweeps <= options.max_sweeps);
    assert!(history.iter().all(|f| f.is_finite()), "{history:?}");
    // f by AREA may be 0, so small values are compared absolutely.
    assert!(
        (history[0] - before).abs() <= near * before.max(1e-3),
        "f begins at {} for {before}",
        history[0]
    );
    let swept = history[outcome.best_sweep as usize];
    let is_as_swept =
        outcome.returned == 0 && outcome.floored.is_none() && outcome.large_angles.is_none();
    if let Some(large) = outcome.large_angles.filter(|_| outcome.best_sweep > 0) {
        let told = large.f[1];
        assert!((told - end).abs() <= 1e-9 * end, "f is {end}, told after large angles is {told}");
    }
    if outcome.best_sweep > 0 && is_as_swept && digits(mesh) > 1e3 {
        let near = near.max(1.0 / digits(mesh)) * end.max(1e-3);
        assert!((swept - end).abs() <= near, "f is {end}, told is {swept}");
    }
}

/// Returns whether a run has a floor under the worst triangles.
fn is_by_default(options: &Options) -> bool {
    options.scheme == Metric::Imr.into()
        && options.method == Method::Auto
        && matches!(options.stopping, Stopping::Tolerance(_))
}

/// Checks that neither the least angle nor the worst inverse mean ratio of a triangle with a free vertex is worse than
/// before.
fn check_worst(mesh: &Mesh, outcome: &Outcome, held: &[bool]) {
    let free: Vec<bool> = held.iter().map(|held| !held).collect();
    let [before, after] = [&mesh.points, &outcome.points].map(|points| worst(mesh, points, &free));
    for (before, after) in before.into_iter().zip(after) {
        // The area of a sliver has few correct digits.
        let most = before * (1.0 + 2e-9 + 1e-14 * before);
        assert!(after <= most, "worst shape from {before} to {after}: {:?}", outcome.floored);
    }
}

/// Checks that a result is preserved when written to a mesh file and read again.
fn check_file(mesh: &Mesh, outcome: &Outcome) {
    let folder = tempfile::tempdir().unwrap();
    let [input, output] = ["in.node", "out.node"].map(|name| folder.path().join(name));
    let [node, ele] = support::triangle_text(mesh, "random");
    std::fs::write(&input, node).unwrap();
    std::fs::write(input.with_extension("ele"), ele).unwrap();
    let file = MeshFile::read(&input).unwrap();
    let bits = |points: &[[f64; 2]]| points.iter().map(|p| p.map(f64::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(file.points()), bits(&mesh.points), "the mesh is not as written");
    file.write(&output, &outcome.points).unwrap();
    let written = MeshFile::read(&output).unwrap();
    assert_eq!(bits(written.points()), bits(&outcome.points), "the result is not as written");
    assert_eq!(written.triangles(), mesh.triangles);
}

fn setting(name: &str, default: u64) -> u64 {
    match std::env::var(name) {
        Ok(value) => value.parse().unwrap_or_else(|_| panic!("{name} is not a number: {value}")),
        Err(_) => default,
    }
}

/// Smooths the meshes of `seeds` on each engine, and checks the outcomes. Returns the number of runs.
fn smooth_all(seeds: std::ops::Range<u64>) -> u64 {
    let mut smoothed = 0;
    for seed in seeds {
        let rng = &mut SplitMix64::new(seed);
        let mut mesh = random_mesh(rng);
        let options = random_options(rng);
        if options.stored == Precision::Single {
            mesh.points.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
        }
        if !support::is_ccw(&mesh) {
            continue;
        }
        let smoother = match Smoother::new(&mesh) {
            Ok(smoother) => smoother,
            Err(MeshError::Empty | MeshError::OutOfRange { .. }) => continue,
            Err(error) => panic!("seed {seed}: {error}"),
        };
        for backend in backends() {
            // On a device, positions are rounded to at most 1e-4 of a triangle's altitude, and so are areas of flat
            // triangles.
            let flat = 1e-6 * Quality::of(&mesh.points, smoother.topology()).unwrap().worst_imr;
            let near = if matches!(backend, Backend::Cpu) { 1e-9 } else { 1e-3 + flat };
            let label = format!("seed {seed} on the {}, {options:?}", name(backend));
            let once = || smoother.run(&options).on(backend).block();
            let outcome = match once() {
                Ok(outcome) => outcome,
                Err(SmoothError::Mesh(
                    MeshError::BeyondPrecision { .. } | MeshError::NothingFree { .. },
                )) => continue,
                Err(error) => panic!("{label}: {error}"),
            };
            let result = std::panic::catch_unwind(|| {
                check(&mesh, &smoother, &options, &outcome, near);
                check_file(&mesh, &outcome);
            });
            assert!(result.is_ok(), "{label}");
            let again = once().unwrap();
            assert!(
                again.points == outcome.points && again.stop == outcome.stop,
                "{label}: not the same again"
            );
            smoothed += 1;
        }
    }
    smoothed
}

#[test]
fn every_mesh_comes_back_finite_feasible_and_no_worse() {
    let first = setting("GPU_SMOOTH_RANDOM_SEED", 1);
    let count = setting("GPU_SMOOTH_RANDOM_MESHES", 150);
    let smoothed = smooth_all(first..first + count);
    assert!(smoothed > count, "only {smoothed} runs of {count} meshes");
}

/// Runs by default have a floor under the worst triangles.
#[test]
fn runs_by_default_leave_no_worse_triangle() {
    let first = setting("GPU_SMOOTH_RANDOM_SEED", 1);
    let count = setting("GPU_SMOOTH_RANDOM_MESHES", 60);
    let (mut runs, mut floored) = (0, 0);
    for seed in first..first + count {
        let rng = &mut SplitMix64::new(seed);
        let mut mesh = random_mesh(rng);
        let stored = [Precision::Double, Precision::Single][rng.below(2)];
        if stored == Precision::Single {
            mesh.points.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
        }
        if !support::is_ccw(&mesh) {
            continue;
        }
        let Ok(smoother) = Smoother::new(&mesh) else { continue };
        let options = Options::default().stored(stored);
        let held = support::check::held(smoother.mesh());
        for backend in backends() {
            // The test above tells which meshes a run may refuse.
            let Ok(outcome) = smoother.run(&options).on(backend).block() else { continue };
            assert!(support::is_ccw(&with_points(&mesh, &outcome.points)), "seed {seed}");
            let checked = std::panic::catch_unwind(|| check_worst(&mesh, &outcome, &held));
            assert!(checked.is_ok(), "seed {seed} on the {}, {stored:?}", name(backend));
            runs += 1;
            floored += u64::from(outcome.floored.is_some());
        }
    }
    assert!(runs > count / 2, "only {runs} runs of {count} meshes");
    assert!(floored > 0 || count < 60, "no run needed the floor");
}

/// A former defect: f by AREA, which was 0 up to rounding, rose from 1.3e-30 to 1.7e-30.
#[test]
fn a_change_of_f_by_rounding_alone_is_no_gain() {
    assert!(smooth_all(10211..10212) > 0);
}
