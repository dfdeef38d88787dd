//! Comparison of each metric's WGSL, both value and hand-written derivatives, with the dual numbers of the CPU engine
//! on equal single-precision input.

use crate::device::{Device, probe};
use crate::oracles::{SHARPNESS, Scales, ULP, mistakes, scales};
use crate::triangles::*;
use gpu_smooth::{
    Metric,
    gpu::Kernel,
    internal::Dual,
    metric::{Corner, Ideal},
    options::Derivatives,
};
use support::SplitMix64;

/// Input of an invocation: the triangle, its ideal (the mean area and the size weight), and the width of differences.
type Row = [f32; 7];

/// Output of an invocation, in the order of the fields.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Found {
    derivatives: [f32; 6],
    model: f32,
    excess: f32,
    direction: [f32; 2],
    slope: f32,
    imr: f32,
}

fn wgsl(metric: Metric, derivatives: Derivatives) -> String {
    let name = metric.name().replace('-', "_");
    let of_corner = format!("{name}_excess");
    let excess = match metric.properties().wgsl.contains(&of_corner) {
        true => format!("{of_corner}(t)"),
        false => format!("{name}_value(invariants(t))"),
    };
    let body = format!(
        "    sharpness = {SHARPNESS}u;
    let t = Corner(vec2(x[0], x[1]), vec2(x[2], x[3]), Ideal(vec2(x[4], 0.0), x[5]));
    let d = metric_derivatives(t, x[6]);
    let down = descent(d.gradient, d.hessian);
    y = array<f32, 12>(d.value, d.gradient.x, d.gradient.y, d.hessian.x, d.hessian.y, d.hessian.z,
        metric_model(t), {excess}, down.x, down.y, down.z, inverse_mean_ratio(t));"
    );
    Kernel::Sweep(metric, derivatives).wgsl() + &probe(7, 12, &body)
}

/// Returns ordinary, tiny, huge, nearly flat and needle-like triangles, and triangles with equal edges.
fn rows() -> Vec<Row> {
    let mut rng = SplitMix64::new(31);
    let mut all = Vec::new();
    for i in 0..900 {
        let t = match i % 3 {
            0 => random(&mut rng, 20.0),
            n => {
                let ratio = 10f64.powf(rng.range(0.0, 4.0));
                thin(&mut rng, ratio, n == 1)
            }
        };
        all.push(t);
    }
    all.extend((0..7).map(|i| rotated(&equilateral(), f64::from(i))));
    for apex in [0.1, 0.5, 0.86, 0.87, 1.5, 5.0] {
        all.push(corner([[0.5, apex], [0.0, 0.0], [1.0, 0.0]], 0.4));
    }
    let of = |(i, t): (usize, Corner<f64>)| {
        let size = [1.0, 1e-6, 1e6][i / 3 % 3];
        let row = [t.a[0], t.a[1], t.b[0], t.b[1]].map(|x| (x * size) as f32);
        let [ax, ay, bx, by] = row;
        let mean_area = (t.ideal.area * size * size) as f32;
        let width = 1e-2 * height(&t) * size;
        [ax, ay, bx, by, mean_area, t.ideal.size_weight as f32, width as f32]
    };
    let mut rows: Vec<Row> = all.into_iter().enumerate().map(of).collect();
    // Rounding may have flattened the flattest triangles further.
    rows.retain(|row| {
        let t = triangle(row);
        t.doubled_area() > 0.0 && imr(&t) < 1.2e4
    });
    assert!(rows.len() > 880, "{}", rows.len());
    rows
}

/// Returns the triangle as rounded for the device.
fn triangle(row: &Row) -> Corner<f64> {
    let [ax, ay, bx, by, area, size_weight, _] = row.map(f64::from);
    Corner { a: [ax, ay], b: [bx, by], ideal: Ideal { size_weight, ..Ideal::of_area(area) } }
}

fn parts(d: &Dual) -> [&[f64]; 3] {
    [std::slice::from_ref(&d.value), &d.gradient, &d.hessian]
}

fn found_parts(found: &Found) -> [Vec<f64>; 3] {
    let d = found.derivatives.map(f64::from);
    [vec![d[0]], d[1..3].to_vec(), d[3..].to_vec()]
}

/// Returns the largest errors of value, gradient and Hessian, in units of [`ULP`] times their scales and condition.
fn errors(metric: Metric, rows: &[Row], found: &[Found]) -> [f64; 3] {
    let mut worst = [0f64; 3];
    for (row, found) in rows.iter().zip(found) {
        let t = triangle(row);
        let Scales { sizes, conditions } = scales(metric, &t);
        let exact = metric.derivatives(&t, SHARPNESS);
        for (i, (got, want)) in found_parts(found).iter().zip(parts(&exact)).enumerate() {
            for (got, want) in got.iter().zip(want) {
                worst[i] = worst[i].max(error(*got, *want) / (sizes[i] * conditions[i] * ULP));
            }
        }
    }
    worst
}

/// Returns the absolute difference; infinite for NaN.
fn error(got: f64, want: f64) -> f64 {
    Some((got - want).abs()).filter(|error| error.is_finite()).unwrap_or(f64::INFINITY)
}

/// Bound on errors in units of their scales. Approximately ten operations round, and the divisions and square roots of
/// a GPU may have errors of a few units. Software adapters stay below 6.
const BOUND: f64 = 16.0;

/// Bound on errors of finite differences, which only the rounding of two values causes. Software adapters stay below 2.
const DIFFERENCE_BOUND: f64 = 8.0;

#[test]
fn values_and_derivatives_are_those_of_dual_numbers() {
    let (device, rows) = (Device::open(), rows());
    for &metric in Metric::ALL {
        let found: Vec<Found> = device.run(&wgsl(metric, Derivatives::Analytic), &rows);
        let worst = errors(metric, &rows, &found);
        assert!(worst.iter().all(|&error| error < BOUND), "{metric}: {worst:.1?}");
        for (row, found) in rows.iter().zip(&found) {
            let t = triangle(row);
            let Scales { sizes, conditions } = scales(metric, &t);
            let bound = BOUND * sizes[0] * conditions[0] * ULP;
            let model = metric.model(&t, SHARPNESS);
            assert!(error(found.model.into(), model) <= bound, "{metric}: {t:?}");
            assert!(error(found.excess.into(), metric.excess(&t)) <= bound, "{metric}: {t:?}");
            let ratio = imr(&t);
            let bound = 8.0 * ULP * ratio * (1.0 + ratio);
            assert!(error(found.imr.into(), ratio) <= bound, "{metric}: {t:?}");
        }
    }
}

#[test]
fn a_wrong_derivative_is_detected() {
    let (device, rows) = (Device::open(), rows());
    let of = |&metric: &Metric| mistakes(metric).map(|[right, wrong]| (metric, right, wrong));
    for (metric, right, wrong) in Metric::ALL.iter().flat_map(of) {
        let source = wgsl(metric, Derivatives::Analytic);
        assert_eq!(source.matches(right).count(), 1, "{metric}: {right}");
        let found: Vec<Found> = device.run(&source.replace(right, wrong), &rows);
        let worst = errors(metric, &rows, &found);
        assert!(worst.iter().any(|&e| e > 10.0 * BOUND), "{metric}, {wrong}: {worst:.1?}");
        assert!(worst[0] < BOUND, "the value is not concerned");
    }
}

/// Returns gradient and Hessian by forward differences, in the form used by both engines.
fn forward(metric: Metric, t: &Corner<f64>, h: f64) -> Dual {
    let value = |x: f64, y: f64| metric.model(&displaced(t, [x * h, y * h]), SHARPNESS);
    let gradient = |x: f64, y: f64| {
        let here = value(x, y);
        [(value(x + 1.0, y) - here) / h, (value(x, y + 1.0) - here) / h]
    };
    let (here, right, up) = (gradient(0.0, 0.0), gradient(1.0, 0.0), gradient(0.0, 1.0));
    let mixed = 0.5 * ((right[1] - here[1]) + (up[0] - here[0]));
    let hessian = [right[0] - here[0], mixed, up[1] - here[1]].map(|x| x / h);
    Dual { value: value(0.0, 0.0), gradient: here, hessian }
}

/// Returns the largest errors of finite differences, in units of the error caused by rounding of the values.
fn difference_errors(metric: Metric, rows: &[Row], found: &[Found]) -> [f64; 3] {
    let mut worst = [0f64; 3];
    for (row, found) in rows.iter().zip(found) {
        let (t, h) = (triangle(row), f64::from(row[6]));
        let Scales { sizes, conditions } = scales(metric, &t);
        // A moved edge is rounded too, by its length relative to the shortest relevant edge.
        let [a, b, c] = lengths(&t);
        let displaced = (a + b) * sizes[1] / sizes[0] + (a + b) / c;
        let noise = sizes[0] * (conditions[0] + displaced) * ULP;
        let exact = forward(metric, &t, h);
        for (i, (got, want)) in found_parts(found).iter().zip(parts(&exact)).enumerate() {
            let unit = noise / h.powi(i as i32);
            for (got, want) in got.iter().zip(want) {
                worst[i] = worst[i].max(error(*got, *want) / unit);
            }
        }
    }
    worst
}

#[test]
fn differences_on_the_device_are_those_in_double_precision() {
    let (device, rows) = (Device::open(), rows());
    for &metric in Metric::ALL {
        let source = wgsl(metric, Derivatives::FiniteDifference);
        let found: Vec<Found> = device.run(&source, &rows);
        let worst = difference_errors(metric, &rows, &found);
        assert!(worst.iter().all(|&error| error < DIFFERENCE_BOUND), "{metric}: {worst:.1?}");
    }
}

#[test]
fn differences_of_the_wrong_values_are_detected() {
    let (device, rows) = (Device::open(), rows());
    for &metric in Metric::ALL {
        for (right, wrong) in [
            ("values[2] - values[0]", "values[6] - values[0]"),
            ("vec3(right.x - here.x,", "vec3(right.x - here.y,"),
        ] {
            let source = wgsl(metric, Derivatives::FiniteDifference);
            assert_eq!(source.matches(right).count(), 1, "{right}");
            let found: Vec<Found> = device.run(&source.replace(right, wrong), &rows);
            let worst = difference_errors(metric, &rows, &found);
            assert!(
                worst.iter().any(|&e| e > 10.0 * DIFFERENCE_BOUND),
                "{metric}, {wrong}: {worst:.1?}"
            );
        }
    }
}

/// Returns the direction -|H|⁻¹g, computed in the eigenvectors of H, and the slope along that direction.
fn newton(gradient: Vec2, [xx, xy, yy]: [f64; 3], floor: f64) -> (Vec2, f64) {
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let (sin, cos) = angle.sin_cos();
    let along = [cos * gradient[0] + sin * gradient[1], cos * gradient[1] - sin * gradient[0]];
    let curvature = [
        cos * cos * xx + 2.0 * sin * cos * xy + sin * sin * yy,
        sin * sin * xx - 2.0 * sin * cos * xy + cos * cos * yy,
    ]
    .map(f64::abs);
    let least = floor * curvature[0].max(curvature[1]);
    let step = [0, 1].map(|i| -along[i] / curvature[i].max(least));
    let slope = step[0] * along[0] + step[1] * along[1];
    ([cos * step[0] - sin * step[1], sin * step[0] + cos * step[1]], slope)
}

#[test]
fn the_newton_direction_is_that_of_absolute_eigenvalues() {
    let (device, rows) = (Device::open(), rows());
    for &metric in Metric::ALL {
        let found: Vec<Found> = device.run(&wgsl(metric, Derivatives::Analytic), &rows);
        let floor = metric.properties().eigenvalue_floor;
        for found in &found {
            let [_, gx, gy, xx, xy, yy] = found.derivatives.map(f64::from);
            let (direction, slope) = newton([gx, gy], [xx, xy, yy], floor);
            if length([gx, gy]) < 1e-30 {
                continue;
            }
            // The smaller eigenvalue is known up to the rounding of the larger one, and is at least the floor.
            let bound = 8.0 * ULP / floor;
            let got = found.direction.map(f64::from);
            let off = length(sub(got, direction)) / length(direction);
            assert!(off < bound, "{metric}: {off:e} off, {found:?}");
            assert!(error(found.slope.into(), slope) < 2.0 * bound * slope.abs(), "{metric}");
            assert!(found.slope < 0.0, "{metric}: no descent, {found:?}");
        }
    }
}
