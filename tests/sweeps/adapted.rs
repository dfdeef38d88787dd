//! Targets that keep adapted meshes: sizes and the spacing at walls, on both engines.

use crate::{backends, name, run};
use gpu_smooth::{
    Mesh, Metric, Options, Outcome, Smoother, Stop, TargetField, Targets, Topology,
    measure::Change,
    targets::{Adaptation, Surface},
};
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use support::SplitMix64;

/// Returns a perturbed lattice on the unit square, with its points mapped by `to`.
fn mapped(columns: usize, to: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let lattice = support::perturb_random(&support::lattice(columns, columns), 0.35, 3);
    let width = columns as f64;
    let height = lattice.points.iter().map(|p| p[1]).fold(0.0, f64::max);
    let points = lattice.points.iter().map(|&[x, y]| to([x / width, y / height])).collect();
    Mesh { points, ..lattice }
}

/// Compresses a mesh of the unit square toward a curved shock and a wall below, with stretchings of up to `1 / least`,
/// and toward a vortex.
fn of_several_solutions(columns: usize, least: f64) -> Mesh {
    mapped(columns, |[x, y]| {
        let x = x - 0.1 * (1.0 - least) * ((x - 0.4) / 0.1).tanh();
        let y = y - 0.2 * (1.0 - least) * (y / 0.2).tanh();
        let [x, y] = [x + 0.1 * y * y, y + 0.05 * (TAU * x).sin()];
        let [u, v] = [x - 0.8, y - 0.6];
        let shrink = 1.0 - 0.5 * (-(u * u + v * v) / 0.02).exp();
        [0.8 + shrink * u, 0.6 + shrink * v]
    })
}

/// Returns a boundary layer around a circle: rows of quadrilaterals, each cut along one of its diagonals at random. The
/// rows at the wall are 1e-3 high and their edges 0.05 long, so that an edge turns against its neighbor by more than
/// twice the angle between the diagonal and the wall. Vertices are moved by up to a tenth of an edge or a row.
fn curved_layer() -> Mesh {
    let (around, rows) = (120, 20);
    let mut rng = SplitMix64::new(4);
    let mut mesh = Mesh::default();
    let (mut radius, mut gap) = (1.0, 1e-3);
    for row in 0..=rows {
        for i in 0..around {
            let is_noisy = row > 0 && row < rows;
            let mut noise = || if is_noisy { rng.range(-0.1, 0.1) } else { 0.0 };
            let angle = TAU * (f64::from(i) + noise()) / f64::from(around);
            let radius = radius + gap * noise();
            mesh.points.push([radius * angle.cos(), radius * angle.sin()]);
        }
        radius += gap;
        gap *= 1.2;
    }
    for row in 0..rows {
        for i in 0..around {
            let [a, b] = [i, (i + 1) % around].map(|i| row * around + i);
            let [c, d] = [a + around, b + around];
            let is_rising = rng.below(2) == 0;
            mesh.triangles.extend(match is_rising {
                true => [[a, c, d], [a, d, b]],
                false => [[a, c, b], [b, c, d]],
            });
        }
    }
    mesh
}

/// Returns the factor by which the spacing at 19 of 20 boundary vertices changes at most. The spacing at a boundary
/// vertex is the mean height of the triangles at its boundary edges, over these edges. Triangles with three vertices on
/// the boundary do not count.
fn spacing_change(mesh: &Mesh, after: &[[f64; 2]]) -> f64 {
    let topology = Topology::new(mesh).unwrap();
    let is_boundary = support::boundary(mesh);
    let edges = topology.boundary_edges();
    let mut sums = vec![[0.0; 2]; mesh.points.len()];
    for &[a, b] in &edges {
        let with_edge = topology.star(a).iter().map(|&t| topology.triangles()[t as usize]);
        let triangle = with_edge.into_iter().find(|t| t.contains(&b)).unwrap();
        let apex = triangle.into_iter().find(|v| ![a, b].contains(v)).unwrap();
        if is_boundary[apex as usize] {
            continue;
        }
        let height = |points: &[[f64; 2]]| {
            let [p, q, r] = [a, b, apex].map(|v| points[v as usize]);
            support::check::orient([p, q, r]).abs() / (q[0] - p[0]).hypot(q[1] - p[1])
        };
        for v in [a, b] {
            sums[v as usize][0] += height(&mesh.points);
            sums[v as usize][1] += height(after);
        }
    }
    let at_walls = sums.into_iter().filter(|sums| sums[0] > 0.0);
    let mut factors: Vec<f64> =
        at_walls.map(|[before, after]| (after / before).ln().abs().exp()).collect();
    factors.sort_by(f64::total_cmp);
    factors[factors.len() * 19 / 20]
}

fn smoother<'m>(mesh: &'m Mesh, targets: &Targets) -> Smoother<'m> {
    let mut smoother = Smoother::new(mesh).unwrap();
    smoother.set_targets(targets).unwrap();
    smoother
}

fn size_change(mesh: &Mesh, outcome: &Outcome) -> f64 {
    let topology = Topology::new(mesh).unwrap();
    Change::between(&topology, &mesh.points, &outcome.points).unwrap().size.p95
}

fn by(metric: Metric) -> Options {
    Options { scheme: metric.into(), ..Options::default() }
}

#[test]
fn keep_size_keeps_sizes_of_adapted_meshes_within_1_3() {
    let graded = support::perturb_random(&support::graded(40, 0.01), 0.35, 3);
    let isotropic = mapped(50, |[x, y]| {
        let scale = (2.5 * x).exp();
        [scale * y.cos(), scale * y.sin()]
    });
    let several = [0.35, 0.1, 0.02].map(|least| of_several_solutions(50, least));
    let layer = support::perturb_random(&support::layered(40, 1e3), 0.2, 3);
    for mesh in [graded, isotropic, curved_layer(), layer].into_iter().chain(several) {
        let topology = Topology::new(&mesh).unwrap();
        let targets = Targets::keep_size(&topology, &mesh.points, Surface::Plane, 0).unwrap();
        let smoother = smoother(&mesh, &targets);
        for backend in backends() {
            let outcome = run(&smoother, &by(Metric::Tmop94), backend);
            let label = format!("{} after {} sweeps", name(backend), outcome.sweeps);
            assert!(outcome.stop == Stop::Converged && outcome.sweeps <= 200, "{label}");
            let change = size_change(&mesh, &outcome);
            assert!(change < 1.3, "{label}: {change}");
            let [before, after] = [&mesh.points, &outcome.points]
                .map(|points| Smoother::new(&mesh).unwrap().f(Metric::Imr, points).unwrap());
            assert!(after < before, "{label}: {after} for {before}");
        }
    }
    // Shapes weigh more by SOFT-SIZE, so that the sizes of stretched triangles change more.
    let mesh = of_several_solutions(50, 0.35);
    let topology = Topology::new(&mesh).unwrap();
    let targets = Targets::keep_size(&topology, &mesh.points, Surface::Plane, 2).unwrap();
    let outcome = run(&smoother(&mesh, &targets), &by(Metric::SoftSize), &backends()[0]);
    let change = size_change(&mesh, &outcome);
    assert!(change > 1.3, "{change}");
}

#[test]
fn sizes_weigh_more_on_stretched_meshes() {
    for (mesh, is_weighted) in [
        (support::perturb_random(&support::lattice(30, 30), 0.35, 3), false),
        (support::perturb_random(&support::graded(40, 0.01), 0.35, 3), false),
        (of_several_solutions(50, 0.1), true),
    ] {
        let topology = Topology::new(&mesh).unwrap();
        let stretching =
            Adaptation::of(&topology, &mesh.points, Surface::Plane).unwrap().stretching;
        let targets = Targets::keep_size(&topology, &mesh.points, Surface::Plane, 0).unwrap();
        let weight = targets.size_weight();
        // The weight depends on the stretching around more vertices.
        let expected = 1.0 + 0.5 * (stretching - 2.5).max(0.0);
        assert!((weight / expected - 1.0).abs() < 0.2, "{weight} for {expected}");
        assert_eq!(weight > 1.0, is_weighted, "{weight}");
        // f has the weight, also if the targets belong to places.
        let of_vertices = smoother(&mesh, &targets);
        let mut of_places = Smoother::new(&mesh).unwrap();
        of_places.set_target_field(TargetField::new(&mesh, &targets).unwrap()).unwrap();
        let [f, f_of_places] =
            [&of_vertices, &of_places].map(|of| of.f(Metric::Tmop94, &mesh.points).unwrap());
        assert!((f_of_places / f - 1.0).abs() < 1e-9, "{f_of_places} for {f}");
        let unweighted = Targets::keep_shape(&topology, &mesh.points, 0).unwrap().size_weight();
        assert_eq!(unweighted, 1.0);
    }
}

#[test]
fn keep_shape_keeps_the_spacing_at_walls_of_adapted_meshes_within_1_1() {
    let graded = support::perturb_random(&support::graded(40, 0.01), 0.35, 3);
    for mesh in [graded, of_several_solutions(60, 0.1), curved_layer()] {
        assert!(support::is_valid(&mesh) && support::is_ccw(&mesh));
        let topology = Topology::new(&mesh).unwrap();
        let targets = Targets::keep_shape(&topology, &mesh.points, 1).unwrap();
        let fixed = targets.first_layer(&topology, &mesh.points).unwrap();
        let mesh = Mesh { fixed, ..mesh.clone() };
        let smoother = smoother(&mesh, &targets);
        for backend in backends() {
            let outcome = run(&smoother, &by(Metric::Imr), backend);
            let label = format!("{} after {} sweeps", name(backend), outcome.sweeps);
            assert!(outcome.stop == Stop::Converged && outcome.sweeps <= 200, "{label}");
            let change = spacing_change(&mesh, &outcome.points);
            assert!(change < 1.1, "{label}: {change}");
            let [before, after] =
                [&mesh.points, &outcome.points].map(|p| smoother.f(Metric::Imr, p).unwrap());
            assert!(after < before, "{label}: {after} for {before}");
        }
    }
    // If the first layer is free, the spacing at the curved wall changes.
    let mesh = curved_layer();
    let topology = Topology::new(&mesh).unwrap();
    let targets = Targets::keep_shape(&topology, &mesh.points, 1).unwrap();
    let outcome = run(&smoother(&mesh, &targets), &by(Metric::Imr), &backends()[0]);
    let change = spacing_change(&mesh, &outcome.points);
    assert!(change > 1.2, "{change}");
}

#[test]
fn the_first_layer_omits_outliers() {
    let mesh = of_several_solutions(40, 0.2);
    let layer = |mesh: &Mesh| {
        let topology = Topology::new(mesh).unwrap();
        let targets = Targets::keep_shape(&topology, &mesh.points, 1).unwrap();
        targets.first_layer(&topology, &mesh.points).unwrap()
    };
    let all = layer(&mesh);
    let is_boundary = support::boundary(&mesh);
    let topology = Topology::new(&mesh).unwrap();
    let edges = topology.boundary_edges();
    let has_edge = |t: &&[u32; 3]| edges.iter().any(|[a, b]| t.contains(a) && t.contains(b));
    let at_edges: BTreeSet<u32> =
        mesh.triangles.iter().filter(has_edge).flatten().copied().collect();
    let expected: Vec<u32> = at_edges.into_iter().filter(|&v| !is_boundary[v as usize]).collect();
    assert_eq!(all, expected);
    // A vertex that is nearly on the boundary makes a triangle far below the height of its neighbors.
    let moved = all[all.len() / 2];
    let edge = edges.iter().find(|&[a, b]| {
        mesh.triangles.iter().any(|t| t.contains(a) && t.contains(b) && t.contains(&moved))
    });
    let [a, b] = edge.unwrap().map(|v| mesh.points[v as usize]);
    let mut flat = mesh.clone();
    let middle = [0, 1].map(|x| 0.5 * (a[x] + b[x]));
    let point = &mut flat.points[moved as usize];
    *point = [0, 1].map(|x| middle[x] + 0.1 * (point[x] - middle[x]));
    assert!(support::is_valid(&flat));
    let left: Vec<u32> = all.iter().copied().filter(|&v| v != moved).collect();
    assert_eq!(layer(&flat), left);
    // A mesh whose free vertices are all in the first layer keeps these vertices free.
    assert_eq!(layer(&support::lattice(3, 3)), []);
    let errors = [Targets::equilateral(3), Targets::equilateral(mesh.points.len())];
    assert!(errors[0].first_layer(&topology, &mesh.points).is_err());
    assert!(errors[1].first_layer(&topology, &mesh.points[1..]).is_err());
}
