//! Measures of quadrilaterals compared with VTK's numbers in `verdict.txt`, with known values, and with plain loops.

use super::{assert_close, assert_statistics};
use gpu_smooth::measure::{Better, Measure, Measured};
use gpu_smooth::targets::Surface;
use gpu_smooth::{Mesh, Metric, Quality, Topology};
use support::SplitMix64;

type Corners = [[f64; 2]; 4];

const SQUARE: Corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Returns the measures that quadrilaterals have.
fn all_measures() -> impl Iterator<Item = Measure> {
    Measure::ALL.iter().copied().filter(|measure| measure.of_quadrilateral())
}

/// Returns the measures that quadrilaterals have, but those between neighbors.
fn measures() -> impl Iterator<Item = Measure> {
    let between =
        [Measure::SizeRatio, Measure::Orthogonality, Measure::FlowLink, Measure::Smoothness];
    all_measures().filter(move |measure| !between.contains(measure))
}

/// Returns the value of a quadrilateral whose winding is preserved: the topology belongs to a square.
fn value_on(surface: Surface, measure: Measure, points: Corners) -> f64 {
    let quadrilaterals = vec![[0, 1, 2, 3]];
    let mesh = Mesh { points: SQUARE.to_vec(), quadrilaterals, ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    Measured::on(surface, &points, &topology).unwrap().value(measure, 0)
}

fn value(measure: Measure, points: Corners) -> f64 {
    value_on(Surface::Plane, measure, points)
}

/// Returns the rows of `verdict.txt`: the vertices of a quadrilateral, and its values.
fn stored() -> Vec<(Corners, Vec<(Measure, f64)>)> {
    let text = include_str!("verdict.txt");
    let names = text.lines().nth(1).unwrap().split(", ").skip(1);
    let measures: Vec<Measure> = names.map(|name| name.parse().unwrap()).collect();
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let corners = [0, 1, 2, 3].map(|k| [numbers[2 * k], numbers[2 * k + 1]]);
        (corners, measures.iter().copied().zip(numbers[8..].iter().copied()).collect())
    };
    text.lines().filter(|line| !line.starts_with('#')).map(row).collect()
}

#[test]
fn convex_quadrilaterals_have_the_values_of_verdict() {
    let stored = stored();
    assert_eq!(stored.len(), 40);
    for (corners, values) in stored {
        // Metrics and no other measures lack a column.
        let own = measures().filter(|measure| !matches!(measure, Measure::Metric(_)));
        assert!(own.eq(values.iter().map(|value| value.0)), "{values:?}");
        for (measure, expected) in values {
            let found = value(measure, corners);
            let close = (found - expected).abs() <= 1e-10 * expected.abs().max(1e-3);
            assert!(close, "{measure} of {corners:?}: {found}, not {expected}");
        }
    }
}

#[test]
fn squares_are_ideal() {
    for measure in all_measures() {
        let ideal = measure.definition().quadrilateral.unwrap().ideal;
        let is_of_size =
            matches!(measure, Measure::Metric(metric) if !metric.properties().scale_invariant);
        // At the ideal, metrics of size are roots of sums of squares that vanish up to rounding.
        let slack = if is_of_size { 1e-7 } else { 1e-12 };
        for (sin, cos, size) in [(0.0, 1.0, 1.0), (0.6, 0.8, 1e3), (-0.28, 0.96, 1e-3)] {
            let turned =
                SQUARE.map(|[x, y]| [size * (cos * x - sin * y), size * (sin * x + cos * y)]);
            let found = value(measure, turned);
            assert!(
                (found - ideal).abs() <= slack * ideal.max(1.0),
                "{measure}: {found}, not {ideal}"
            );
        }
    }
}

#[test]
fn measures_do_not_depend_on_size_place_rotation_and_first_vertex() {
    let (sin, cos) = 0.7f64.sin_cos();
    for (corners, _) in stored() {
        for measure in measures() {
            let expected = value(measure, corners);
            let range = measure.definition().quadrilateral.unwrap().range;
            assert!((range[0]..=range[1]).contains(&expected), "{measure}: {expected}");
            let close = |found: f64, what: &str| {
                assert_close(found / expected, 1.0, &format!("{measure} of {corners:?}, {what}"));
            };
            let turned = corners.map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]);
            close(value(measure, turned), "turned");
            let mirrored = [0, 3, 2, 1].map(|k: usize| [-corners[k][0], corners[k][1]]);
            close(value(measure, mirrored), "mirrored");
            for start in 1..4 {
                let mut from = corners;
                from.rotate_left(start);
                close(value(measure, from), "from another vertex");
            }
            let is_metric = matches!(measure, Measure::Metric(_));
            for scale in if is_metric { [1e-90, 1e90] } else { [1e-300, 1e300] } {
                close(value(measure, corners.map(|p| p.map(|x| scale * x))), "scaled");
            }
            let far = corners.map(|[x, y]| [x + 1024.0, y - 4096.0]);
            close(value(measure, far), "far away");
        }
    }
}

#[test]
fn known_quadrilaterals_have_known_values() {
    use Measure::*;
    let infinity = f64::INFINITY;
    // Sides 2 and 1; a rhombus of 60°; a dart whose last vertex is inside the triangle of the others.
    let rectangle = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    let root = 3f64.sqrt();
    let rhombus = [[0.0, 0.0], [2.0, 0.0], [3.0, root], [1.0, root]];
    let dart = [[0.0, 0.0], [3.0, 0.0], [0.0, 3.0], [1.0, 1.0]];
    let inverted = [rectangle[0], rectangle[3], rectangle[2], rectangle[1]];
    let two_in_one = [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0]];
    let point = [[2.0, 3.0]; 4];
    let no_number = [[0.0, 0.0], [1.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]];
    let imr = Metric(gpu_smooth::Metric::Imr);
    let cases = [
        (rectangle, MinAngle, 90.0),
        (rectangle, EdgeRatio, 2.0),
        (rectangle, AspectRatio, 1.5),
        (rectangle, RadiusRatio, 1.25),
        (rectangle, ScaledJacobian, 1.0),
        (rectangle, Condition, 1.25),
        (rectangle, MedAspectFrobenius, 1.25),
        (rectangle, imr, 1.25),
        (rhombus, MinAngle, 60.0),
        (rhombus, MaxAngle, 120.0),
        (rhombus, Skewness, 1.0 / 3.0),
        (rhombus, ScaledJacobian, root / 2.0),
        (rhombus, Shape, root / 2.0),
        (rhombus, imr, 2.0 / root),
        (dart, MaxAngle, 180.0 + 3f64.atan().to_degrees()),
        (dart, Shape, 0.0),
        (dart, Condition, infinity),
        (dart, MedAspectFrobenius, infinity),
        (dart, imr, infinity),
        (dart, Skewness, 1.0),
        (inverted, MinAngle, 90.0),
        (inverted, MaxAngle, 90.0),
        (inverted, AspectRatio, 1.5),
        (inverted, RadiusRatio, 1.25),
        (inverted, ScaledJacobian, -1.0),
        (inverted, Shape, 0.0),
        (inverted, Condition, infinity),
        (triangle, MaxAngle, 180.0),
        (triangle, ScaledJacobian, 0.0),
        (triangle, RadiusRatio, infinity),
        (triangle, Condition, infinity),
        (two_in_one, EdgeRatio, infinity),
        (two_in_one, ScaledJacobian, 0.0),
        (two_in_one, MaxAngle, 180.0),
        (point, AspectRatio, infinity),
        (point, Shape, 0.0),
        (no_number, Skewness, 1.0),
        (no_number, imr, infinity),
    ];
    for (points, measure, expected) in cases {
        assert_close(value(measure, points), expected, &format!("{measure} of {points:?}"));
    }
    assert!(value(ScaledJacobian, dart) < 0.0);
}

#[test]
fn measures_in_degrees_are_those_on_the_sphere() {
    // At a latitude of 60°, a degree of longitude is half as long as one of latitude.
    let plane = [[0.0, 0.0], [1.2, 0.1], [0.9, 1.1], [-0.1, 0.8]].map(|p| p.map(|x| 2e-5 * x));
    let degrees = plane.map(|[x, y]| [10.0 + 2.0 * x, 60.0 + y]);
    for measure in measures() {
        let (found, expected) =
            (value_on(Surface::Sphere, measure, degrees), value(measure, plane));
        assert!((found / expected - 1.0).abs() < 1e-5, "{measure}: {found}, not {expected}");
    }
}

/// Makes a mesh of quadrilaterals and triangles with random shapes, of which some are inverted.
fn mixed() -> Mesh {
    let (columns, rows) = (120, 90);
    let mut random = SplitMix64::new(11);
    let mut mesh = Mesh::default();
    for (i, j) in (0..(columns + 1) * (rows + 1)).map(|v| (v % (columns + 1), v / (columns + 1))) {
        let [x, y] = [i, j].map(|k: u32| f64::from(k) + 0.7 * random.unit());
        mesh.points.push([x, y]);
    }
    for (i, j) in (0..columns * rows).map(|k| (k % columns, k / columns)) {
        let a = j * (columns + 1) + i;
        let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
        match (i * 7 + j * 5 + i * j) % 3 {
            0 => mesh.triangles.extend([[a, b, c], [a, c, d]]),
            _ => mesh.quadrilaterals.push([a, b, c, d]),
        }
    }
    mesh
}

#[test]
fn statistics_and_lists_of_mixed_meshes_are_those_of_the_values() {
    let mesh = mixed();
    let topology = Topology::new(&mesh).unwrap();
    let measured = Measured::new(&mesh.points, &topology).unwrap();
    let (triangles, count) = (mesh.triangles.len(), measured.count());
    assert_eq!(count, triangles + mesh.quadrilaterals.len());
    let regions: Vec<u32> = (0..count).map(|element| [0, 1, 2, 1][element % 4]).collect();
    let all = measured.statistics(Measure::ALL);
    let by_region = measured.statistics_by_region(Measure::ALL, &regions, 2);
    for (i, &measure) in Measure::ALL.iter().enumerate() {
        let values = measured.values(measure);
        let own: Vec<(usize, f64)> =
            values.iter().copied().enumerate().filter(|value| !value.1.is_nan()).collect();
        let with = if measure.of_quadrilateral() { count } else { triangles };
        assert!(values.len() == count && own.len() == with, "{measure}");
        assert!(own.iter().all(|&(element, value)| measured.value(measure, element) == value));
        assert_statistics(&all[i], &own);
        for (region, statistics) in (0..).zip(&by_region) {
            let own: Vec<_> = own.iter().copied().filter(|v| regions[v.0] == region).collect();
            assert_statistics(&statistics[i], &own);
        }
        let mut order = own.clone();
        match measure.definition().better {
            Better::Higher => order.sort_by(|a, b| a.1.total_cmp(&b.1)),
            Better::Lower => order.sort_by(|a, b| b.1.total_cmp(&a.1)),
        }
        assert_eq!(measured.worst(measure, 99), order[..99], "{measure}");
        assert_eq!(measured.worst(measure, count).len(), with);
        let limit = all[i].quantiles[1];
        let below = own.iter().filter(|value| value.1 < limit).count();
        let first = own.iter().find(|value| value.1 < limit).map(|value| value.0);
        assert_eq!(measured.count_where(measure, |value| value < limit), (below, first));
        assert_eq!(measured.count_where(measure, |_| true).0, with);
        let bins = [f64::NEG_INFINITY, limit, f64::INFINITY];
        assert_eq!(measured.histogram(measure, &bins), [below, with - below]);
    }
    assert!(measured.value(Measure::Shape, count).is_nan());
}

#[test]
fn elements_are_measured_by_the_winding_of_the_mesh() {
    let mut mesh = mixed();
    let topology = Topology::new(&mesh).unwrap();
    let expected = Measured::new(&mesh.points, &topology).unwrap().values(Measure::ScaledJacobian);
    assert!(expected.iter().any(|value| *value < 0.0));
    let mut reversed = mesh.clone();
    reversed.quadrilaterals.iter_mut().step_by(3).for_each(|four| four.swap(1, 3));
    reversed.triangles.iter_mut().step_by(2).for_each(|three| three.swap(1, 2));
    let topology = Topology::new(&reversed).unwrap();
    let found = Measured::new(&mesh.points, &topology).unwrap().values(Measure::ScaledJacobian);
    assert_eq!(found, expected);
    // Values of triangles alone do not change if quadrilaterals are added.
    let triangle = mesh.triangles.len() / 2;
    mesh.quadrilaterals.clear();
    let topology = Topology::new(&mesh).unwrap();
    let alone = Measured::new(&mesh.points, &topology).unwrap();
    assert_eq!(alone.value(Measure::ScaledJacobian, triangle), expected[triangle]);
}

#[test]
fn metrics_of_elements_have_the_objective_as_the_mean_of_their_squares() {
    let mut mesh = mixed();
    // Without inverted elements, f is finite by each metric.
    let columns = 121.0;
    for (v, point) in (0..).zip(&mut mesh.points) {
        let place = [f64::from(v) % columns, (f64::from(v) / columns).floor()];
        *point = [0, 1].map(|axis| place[axis] + 0.3 * (point[axis] - place[axis]));
    }
    for surface in [Surface::Plane, Surface::Sphere] {
        let points: Vec<[f64; 2]> = mesh.points.iter().map(|p| p.map(|x| 0.1 * x)).collect();
        let topology = Topology::new(&mesh).unwrap();
        let measured = Measured::on(surface, &points, &topology).unwrap();
        let quality = Quality::on(surface, &points, &topology).unwrap();
        for &metric in Metric::ALL {
            let values = measured.values(Measure::Metric(metric));
            let mean = values.iter().map(|q| q * q).sum::<f64>() / values.len() as f64;
            assert_close(mean, quality.f(metric), metric.name());
            assert!(mean.is_finite());
        }
    }
}
