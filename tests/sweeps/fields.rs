//! Targets that belong to places: fields on a background mesh, on both engines.

use crate::{backends, history, name, run};
use gpu_smooth::{
    Backend, Goal, Mesh, MeshError, Metric, OptionError, Options, Slide, SmoothError, Smoother,
    Stop, Stopping, TargetField, Targets, options::Feature, targets::Surface,
};

/// Makes a square of two triangles, with target sizes four times larger on the right than on the left.
fn background(width: f64, height: f64) -> (Mesh, Targets) {
    let points = vec![[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
    let mesh = Mesh { points, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    (mesh, Targets::sizes(&[1.0, 4.0, 4.0, 1.0]).unwrap())
}

/// Makes an even mesh with a perturbed interior and its lower left corner at the origin. Also returns its size.
fn even() -> (Mesh, [f64; 2]) {
    let mut mesh = support::lattice(24, 20);
    let low = mesh.points.iter().fold([f64::INFINITY; 2], |[a, b], [x, y]| [a.min(*x), b.min(*y)]);
    mesh.points.iter_mut().for_each(|point| *point = [point[0] - low[0], point[1] - low[1]]);
    let high = mesh.points.iter().fold([0.0_f64; 2], |[a, b], [x, y]| [a.max(*x), b.max(*y)]);
    (support::perturb_random(&mesh, 0.6, 7), high)
}

#[test]
fn sizes_are_those_wanted_where_vertices_have_moved_to() {
    let (mesh, [width, height]) = even();
    let (square, targets) = background(width, height);
    let field = TargetField::new(&square, &targets).unwrap();
    let options = Options::default().scheme(Metric::ShapeSize.into());
    let mut smoother = Smoother::new(&mesh).unwrap();
    let (start, outside) = field.at(&mesh.points).unwrap();
    assert_eq!(outside.count, 0);
    smoother.set_targets(&start).unwrap();
    let carried = run(&smoother, &options, &Backend::Cpu);
    assert_eq!(smoother.set_target_field(field.clone()).unwrap().count, 0);
    let of_vertices = smoother.f(Metric::ShapeSize, &carried.points).unwrap();
    for backend in backends() {
        let outcome = run(&smoother, &options, backend);
        let label = name(backend);
        assert_eq!(outcome.stop, Stop::Converged, "{label}");
        let of_places = smoother.f(Metric::ShapeSize, &outcome.points).unwrap();
        assert!(of_places < 0.98 * of_vertices, "{label}: {of_places} {of_vertices}");
        // f uses the targets at the final positions, so a smoother with these targets evaluates an equal f.
        let f = *history(&outcome, Metric::ShapeSize).last().unwrap();
        assert!((smoother.f(Metric::ShapeSize, &outcome.points).unwrap() / f - 1.0).abs() < 1e-6);
        let moved = Mesh { points: outcome.points.clone(), ..mesh.clone() };
        let mut again = Smoother::new(&moved).unwrap();
        again.set_target_field(field.clone()).unwrap();
        assert!((again.f(Metric::ShapeSize, &moved.points).unwrap() / f - 1.0).abs() < 1e-6);
        // Targets and vertices have converged: a further run gains almost nothing.
        let further = run(&again, &options, backend);
        let least = *history(&further, Metric::ShapeSize).last().unwrap();
        assert!((least / f - 1.0).abs() < 1e-4, "{label}: {f} {least}");
    }
}

#[test]
fn a_field_of_one_size_changes_nothing() {
    let (mesh, [width, height]) = even();
    let (square, _) = background(width, height);
    let field = TargetField::new(&square, &Targets::equilateral(4)).unwrap();
    let mut smoother = Smoother::new(&mesh).unwrap();
    let plain = run(&smoother, &Options::default(), &Backend::Cpu);
    smoother.set_target_field(field).unwrap();
    let outcome = run(&smoother, &Options::default(), &Backend::Cpu);
    assert_eq!(outcome.stop, Stop::Converged);
    let f = [&plain, &outcome].map(|outcome| *history(outcome, Metric::Imr).last().unwrap());
    assert!((f[0] / f[1] - 1.0).abs() < 2e-6, "{f:?}");
}

#[test]
fn options_that_do_not_go_with_a_target_field_are_refused() {
    let (mesh, [width, height]) = even();
    let (square, targets) = background(width / 2.0, height);
    assert!(TargetField::new(&mesh, &targets).is_err());
    let field = TargetField::new(&square, &targets).unwrap();
    let mut smoother = Smoother::new(&mesh).unwrap();
    // Half of the mesh lies outside of the field, at distances up to half of the mesh's width.
    let outside = smoother.set_target_field(field).unwrap();
    assert!(outside.count > mesh.points.len() / 3, "{outside:?}");
    assert!((outside.most / width - 0.5).abs() < 0.05, "{outside:?}");
    let refused = |smoother: &Smoother, options: &Options| {
        let error = smoother.run(options).on(&Backend::Cpu).block();
        let Err(SmoothError::Option(OptionError::Conflict { features, .. })) = error else {
            panic!("{error:?}")
        };
        assert!(features.contains(&Feature::TargetField), "{features:?}");
    };
    let stopping = Stopping::Goal(Goal { fraction: 0.95, desired: Some(1.0) });
    refused(&smoother, &Options::default().stopping(stopping));
    refused(&smoother, &Options::default().max_move(Some(1.0)));
    refused(&smoother, &Options::default().scheme(Metric::Edge.into()));
    smoother.set_slide(Some(&Slide::default())).unwrap();
    refused(&smoother, &Options::default());
}

/// A strip from 170 to 190 degrees east, with longitudes continued beyond 180, and sizes that grow eastward.
#[test]
fn places_around_the_globe_are_found_whichever_way_longitudes_are_written() {
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for column in 0..=10_u32 {
        let x = 170.0 + 2.0 * f64::from(column);
        points.extend([[x, 0.0], [x, 5.0]]);
        if column < 10 {
            let a = 2 * column;
            triangles.extend([[a, a + 2, a + 3], [a, a + 3, a + 1]]);
        }
    }
    let sizes: Vec<f64> = points.iter().map(|[x, _]| (0.1 * (x - 170.0)).exp()).collect();
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    let field = TargetField::new(&mesh, &Targets::sizes(&sizes).unwrap()).unwrap();
    let places = [[171.0, 1.0], [179.5, 4.0], [180.5, 2.0], [189.0, 3.0]];
    let written = places.map(|[x, y]| [if x > 180.0 { x - 360.0 } else { x }, y]);
    let (flat, outside) = field.at(&written).unwrap();
    assert_eq!(outside.count, 2);
    let field = field.seen_on(Surface::Sphere);
    let (wanted, outside) = field.at(&places).unwrap();
    assert_eq!(outside.count, 0);
    assert_ne!(flat, wanted, "a degree of longitude is shorter there");
    for turns in [-360.0, 0.0, 360.0, 720.0] {
        let turned = written.map(|[x, y]| [x + turns, y]);
        let (found, outside) = field.at(&turned).unwrap();
        assert_eq!(outside.count, 0, "{turns}");
        assert_eq!(found, wanted, "{turns}");
    }
    // Outside, the nearer end of the strip determines the size: at 190 or at 170 degrees east.
    let ends = [[-169.0, 1.0], [169.0, 1.0], [-100.0, 1.0], [100.0, 1.0]];
    let (found, outside) = field.at(&ends).unwrap();
    let ends = [[190.0, 1.0], [170.0, 1.0], [190.0, 1.0], [170.0, 1.0]];
    let (wanted, _) = field.at(&ends).unwrap();
    assert_eq!(found, wanted);
    assert_eq!((outside.count, outside.most), (4, 70.0));
    let wrong = field.at(&[[0.0, 0.0], [f64::NAN, 0.0]]);
    assert!(matches!(wrong, Err(MeshError::NotFinite { vertex: 1 })), "{wrong:?}");
}
