//! Targets that keep adapted meshes: sizes and the spacing at walls, on both engines.

use crate::{backends, name, run, with_free_layers};
use gpu_smooth::{
    Mesh, Metric, Options, Outcome, Smoother, Stop, TargetField, Targets, Topology,
    measure::Change,
    targets::{Adaptation, Surface},
};
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

fn smoother<'m>(mesh: &'m Mesh, targets: &Targets) -> Smoother<'m> {
    // Targets are judged on all triangles, those of boundary layers included.
    let mut smoother = with_free_layers(mesh);
    smoother.set_targets(targets).unwrap();
    smoother
}

fn size_change(mesh: &Mesh, outcome: &Outcome) -> f64 {
    let topology = Topology::new(mesh).unwrap();
    Change::between(&topology, &mesh.points, &outcome.points).unwrap().size.p95
}

fn by(metric: Metric) -> Options {
    Options::default().scheme(metric.into())
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
