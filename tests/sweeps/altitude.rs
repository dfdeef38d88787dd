//! Runs with `keep_altitude`, which preserves the smallest altitude of a mesh.

use crate::random::scattered;
use crate::{backends, history, name, plate, run, with_free_layers};
use gpu_smooth::{
    Backend, Guard, Mesh, Metric, OptionError, Options, Quality, Slide, SmoothError, Smoother,
    Stop, TargetField, Targets,
    measure::Change,
    options::{Feature, Precision},
    topology,
};

/// Makes a square of cells that are all cut along one diagonal. Rows become lower toward one side, against which
/// smoothing presses triangles.
pub(crate) fn fields(count: u32) -> Mesh {
    let across = count + 1;
    let points = (0..across * across)
        .map(|v| [f64::from(v % across), f64::from((v / across).pow(2)) / f64::from(count)]);
    let of = |k: u32| {
        let a = k / count * across + k % count;
        [[a, a + 1, a + across + 1], [a, a + across + 1, a + across]]
    };
    let triangles = (0..count * count).flat_map(of).collect();
    Mesh { points: points.collect(), triangles, ..Mesh::default() }
}

#[test]
fn the_least_altitude_does_not_fall_if_it_is_to_be_kept() {
    let mesh = fields(12);
    let smoother = with_free_layers(&mesh);
    let altitudes = |points: &[[f64; 2]]| {
        Change::between(smoother.topology(), &mesh.points, points).unwrap().least_altitude
    };
    for (backend, stored) in backends().iter().zip([Precision::Double, Precision::Single]) {
        let label = name(backend);
        let free = run(&smoother, &Options::default().stored(stored), backend);
        let [before, after] = altitudes(&free.points);
        assert!(after < 0.95 * before, "{label}: {before} {after}");
        let options = Options::default().stored(stored).keep_altitude(true);
        let kept = run(&smoother, &options, backend);
        let [before, after] = altitudes(&kept.points);
        assert!(after >= before, "{label}: {before} {after}");
        assert_eq!(kept.stop, Stop::Converged, "{label}");
        // The low rows have the smallest altitudes, so preserving them costs much of the gain, but not all.
        let f = history(&kept, Metric::Imr);
        assert!(f.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{label}: {f:?}");
        let least = *history(&free, Metric::Imr).last().unwrap();
        let share = (f[0] - f[f.len() - 1]) / (f[0] - least);
        assert!((0.05..1.0).contains(&share), "{label}: {share}");
        let bad = topology::infeasible(&kept.points, smoother.topology().triangles()).unwrap();
        assert!(bad.is_empty(), "{label}");
    }
}

#[test]
fn options_that_do_not_go_with_kept_altitudes_are_refused() {
    let mesh = fields(4);
    let mut smoother = Smoother::new(&mesh).unwrap();
    let refused = |smoother: &Smoother, options: Options| {
        let options = options.keep_altitude(true);
        let error = smoother.run(&options).on(&backends()[0]).block();
        let Err(SmoothError::Option(OptionError::Conflict { features, .. })) = error else {
            panic!("{error:?}")
        };
        assert!(features.contains(&Feature::KeepAltitude), "{features:?}");
    };
    let targets = Targets::equilateral(mesh.points.len());
    let field = TargetField::new(&mesh, &targets).unwrap();
    smoother.set_target_field(field).unwrap();
    refused(&smoother, Options::default());
}

/// Boundary vertices may slide as well.
#[test]
fn the_least_altitude_is_kept_where_vertices_slide() {
    let mesh = support::perturb_random(&plate(300), 0.5, 3);
    let mut smoother = Smoother::new(&mesh).unwrap();
    let slide = Slide { corner_angle: 180.0, ..Slide::default() };
    smoother.set_slide(Some(&slide)).unwrap();
    let altitudes = |points: &[[f64; 2]]| {
        Change::between(smoother.topology(), &mesh.points, points).unwrap().least_altitude
    };
    for (backend, stored) in backends().iter().zip([Precision::Double, Precision::Single]) {
        let label = name(backend);
        let options = Options::default().stored(stored).keep_altitude(true);
        let kept = run(&smoother, &options, backend);
        let [before, after] = altitudes(&kept.points);
        assert!(after >= before, "{label}: {before} {after}");
        assert!(kept.slid.unwrap().moved > 20, "{label}: {:?}", kept.slid);
        let misplaced = slide.misplaced(smoother.topology(), &mesh.points, &kept.points, stored);
        assert_eq!(misplaced, [], "{label}");
        let f = history(&kept, Metric::Imr);
        assert!(f[f.len() - 1] < f[0], "{label}: {f:?}");
        let bad = topology::infeasible(&kept.points, smoother.topology().triangles()).unwrap();
        assert!(bad.is_empty(), "{label}");
    }
}

/// Vertices that go back to keep an altitude may leave a neighboring triangle worse than both before and after.
#[test]
fn the_worst_triangle_does_not_get_worse_where_altitudes_are_kept_too() {
    for seed in 5700..6000 {
        let mut rng = support::SplitMix64::new(seed);
        let mut mesh = scattered(&mut rng);
        let factor = rng.range(0.05, 1.0);
        mesh.points.iter_mut().for_each(|point| point[1] *= factor);
        let Ok(smoother) = Smoother::new(&mesh) else { continue };
        if smoother.topology().check_smoothable(&mesh.points).is_err() {
            continue;
        }
        for (metric, guard) in [(Metric::Imr, Guard::Worst), (Metric::Area, Guard::ByMetric)] {
            let options = Options::default().scheme(metric.into()).guard(guard).keep_altitude(true);
            // Some meshes are too flat for double precision.
            let Ok(outcome) = smoother.run(&options).on(&Backend::Cpu).block() else { continue };
            let [before, after] = [&mesh.points, &outcome.points].map(|points| {
                let quality = Quality::of(points, smoother.topology()).unwrap();
                quality.worst_imr
            });
            assert!(after <= before * (1.0 + 1e-12), "{metric}, mesh {seed}: {before} {after}");
        }
    }
}
