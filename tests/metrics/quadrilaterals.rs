//! Comparison of each metric's WGSL at the corners of quadrilaterals with dual numbers of the CPU engine.

use gpu_smooth::{
    Metric,
    gpu::Kernel,
    internal::Dual,
    metric::{Corner, Ideal},
    options::Derivatives,
};
use support::SplitMix64;

use crate::device::{Device, probe};
use crate::oracles::{SHARPNESS, Scales, ULP, scales};
use crate::triangles::{next_corner, random, thin};

/// Bound on errors in units of their scales, as for triangles. Software adapters stay below 3.
const BOUND: f64 = 16.0;

/// Input of an invocation: the edges of a corner, the mean area and the size weight of the ideal, and the role of the visited
/// vertex: 0 for a triangle, then the first, third and second vertex of a corner of a quadrilateral.
type Row = [f32; 7];

/// The slopes of the edges by the position of the visited vertex, by role.
const SLOPES: [[f64; 2]; 4] = [[-1.0, -1.0], [-1.0, -1.0], [0.0, 1.0], [1.0, 0.0]];

fn wgsl(metric: Metric) -> String {
    let body = format!(
        "    sharpness = {SHARPNESS}u;
    set_role(u32(x[6]));
    let plane = Corner(vec2(x[0], x[1]), vec2(x[2], x[3]), Ideal(vec2(x[4], 0.0), x[5]));
    let t = metric_form(plane);
    let d = metric_derivatives(t, 0.0);
    y = array<f32, 7>(d.value, d.gradient.x, d.gradient.y, d.hessian.x, d.hessian.y, d.hessian.z,
        metric_model(t));"
    );
    let kernel = Kernel::Sweep(metric, Derivatives::Analytic);
    kernel.wgsl_for_quadrilaterals() + &probe(7, 7, &body)
}

fn rows() -> Vec<Row> {
    let mut rng = SplitMix64::new(5);
    let corner = |i: usize| match i % 3 {
        0 => random(&mut rng, 20.0),
        n => {
            let ratio = 10f64.powf(rng.range(0.0, 3.0));
            thin(&mut rng, ratio, n == 1)
        }
    };
    let corners: Vec<Corner<f64>> = (0..600).map(corner).collect();
    let row = |(i, t): (usize, &Corner<f64>)| {
        let [ax, ay, bx, by] = [t.a[0], t.a[1], t.b[0], t.b[1]].map(|x| x as f32);
        let Ideal { area, size_weight, .. } = t.ideal;
        [ax, ay, bx, by, area as f32, size_weight as f32, (i % 4) as f32]
    };
    corners.iter().enumerate().map(row).collect()
}

/// Returns the corner as metrics see it, with dual numbers by the position of the visited vertex, and its weight.
fn dual(row: &Row) -> (Corner<Dual>, f64) {
    let [ax, ay, bx, by, area, size_weight, role] = row.map(f64::from);
    let is_right = role > 0.0;
    let [alpha, beta] = SLOPES[role as usize];
    let edge = |[x, y]: [f64; 2], slope| [Dual::variable(x, 0, slope), Dual::variable(y, 1, slope)];
    let (a, mut b) = (edge([ax, ay], alpha), edge([bx, by], beta));
    if is_right {
        // The shear that makes the corner of a square equilateral.
        b = [0, 1].map(|k| a[k] * 0.5 + b[k] * 0.75f64.sqrt());
    }
    let ideal = Ideal { size_weight, is_right, ..Ideal::of_area(area) };
    (Corner { a, b, ideal }, if is_right { 0.25 } else { 1.0 })
}

/// Returns the scales of errors at a corner. EDGE undoes the shear, by which a short edge b beside a long edge a loses digits, and
/// the visited vertex may move the shortest edge of all three.
fn scales_of(metric: Metric, seen: &Corner<f64>, row: &Row) -> Scales {
    if metric != Metric::Edge {
        // In sheared coordinates, the visited vertex may move two vertices.
        let views = [*seen, next_corner(seen), next_corner(&next_corner(seen))];
        let views = views.map(|view| scales(metric, &view));
        let most = |of: fn(&Scales) -> [f64; 3]| {
            [0, 1, 2].map(|i| views.iter().map(|view| of(view)[i]).fold(0.0, f64::max))
        };
        return Scales { sizes: most(|view| view.sizes), conditions: most(|view| view.conditions) };
    }
    let [ax, ay, bx, by, ..] = row.map(f64::from);
    let [a, b, c] = [ax.hypot(ay), bx.hypot(by), (bx - ax).hypot(by - ay)];
    let (k, q, shortest) = (f64::from(1u32 << SHARPNESS), metric.quality(seen), a.min(b).min(c));
    let canceled = 1.0 + a.max(b) / shortest;
    Scales {
        sizes: [q * q, q * q / shortest, k * q * q / (shortest * shortest)],
        conditions: [canceled, k * canceled, k * canceled],
    }
}

/// Returns the largest errors of value, gradient, Hessian and model, in units of [`ULP`] times their scales and condition.
fn errors(metric: Metric, rows: &[Row], found: &[[f32; 7]]) -> [f64; 4] {
    let mut worst = [0.0; 4];
    for (row, found) in rows.iter().zip(found) {
        let (t, weight) = dual(row);
        let values = |edge: [Dual; 2]| edge.map(|x| x.value);
        let plain = Corner { a: values(t.a), b: values(t.b), ideal: t.ideal };
        let Scales { sizes, conditions } = scales_of(metric, &plain, row);
        let Dual { value, gradient: [x, y], hessian: [xx, xy, yy] } = metric.model(&t, SHARPNESS);
        let exact = [value, x, y, xx, xy, yy, value];
        for (i, (found, exact)) in found.iter().zip(exact).enumerate() {
            let kind = [0, 1, 1, 2, 2, 2, 3][i];
            let unit = sizes[kind % 3] * conditions[kind % 3] * ULP;
            let error = (f64::from(*found) / weight - exact).abs() / unit;
            let error = Some(error).filter(|error| error.is_finite()).unwrap_or(f64::INFINITY);
            worst[kind] = error.max(worst[kind]);
        }
    }
    worst
}

#[test]
fn derivatives_at_corners_of_quadrilaterals_are_those_of_dual_numbers() {
    let (device, rows) = (Device::open(), rows());
    for &metric in Metric::ALL {
        let found: Vec<[f32; 7]> = device.run(&wgsl(metric), &rows);
        let worst = errors(metric, &rows, &found);
        assert!(worst.iter().all(|&error| error < BOUND), "{metric}: {worst:.1?}");
    }
}

/// The term of ACUTE on opposite angles is a sum of products of these cotangents.
#[test]
fn derivatives_of_cotangents_at_corners_are_those_of_dual_numbers() {
    let body = "    set_role(u32(x[6]));
    let plane = Corner(vec2(x[0], x[1]), vec2(x[2], x[3]), Ideal(vec2(x[4], 0.0), x[5]));
    let d = cotangent_derivatives(metric_form(plane));
    y = array<f32, 7>(d.value, d.gradient.x, d.gradient.y, d.hessian.x, d.hessian.y, d.hessian.z,
        cotangent_of(metric_form(plane)));";
    let kernel = Kernel::Sweep(Metric::Acute, Derivatives::Analytic);
    let (device, mut rows) = (Device::open(), rows());
    rows.retain(|row| row[6] > 0.0);
    let source = kernel.wgsl_for_quadrilaterals() + &probe(7, 7, body);
    let found: Vec<[f32; 7]> = device.run(&source, &rows);
    let mut worst = 0.0f64;
    for (row, found) in rows.iter().zip(found) {
        let [ax, ay, bx, by, _, _, role] = row.map(f64::from);
        let [alpha, beta] = SLOPES[role as usize];
        let edge =
            |[x, y]: [f64; 2], slope| [Dual::variable(x, 0, slope), Dual::variable(y, 1, slope)];
        let (a, b) = (edge([ax, ay], alpha), edge([bx, by], beta));
        let cotangent = (a[0] * b[0] + a[1] * b[1]) / (a[0] * b[1] - a[1] * b[0]);
        let Dual { value, gradient: [x, y], hessian: [xx, xy, yy] } = cotangent;
        let ([a, b], sine) = ([ax.hypot(ay), bx.hypot(by)], 1.0 / (1.0 + value * value).sqrt());
        let (shortest, canceled) = (a.min(b), 1.0 + a / b);
        for (i, exact) in [value, x, y, xx, xy, yy, value].into_iter().enumerate() {
            let order = [0, 1, 1, 2, 2, 2, 0][i];
            let size = (sine * shortest).powi(-order) / sine * (canceled / sine);
            worst = worst.max((f64::from(found[i]) - exact).abs() / (size * ULP));
        }
    }
    assert!(worst < BOUND, "{worst:.1}");
}

#[test]
fn wrong_slopes_of_corners_are_detected() {
    let (device, rows) = (Device::open(), rows());
    for &metric in Metric::ALL {
        for (right, wrong) in [
            ("select(vec2(0.0, 1.0), vec2(1.0, 0.0), role == LAST)", "vec2(0.0, 1.0)"),
            ("vec2(plane.x, 0.5 * plane.x + HEIGHT * plane.y)", "plane"),
            ("corner_weight = select(1.0, 0.25, is_right)", "corner_weight = 1.0"),
        ] {
            let source = wgsl(metric);
            assert_eq!(source.matches(right).count(), 1, "{right}");
            let found: Vec<[f32; 7]> = device.run(&source.replace(right, wrong), &rows);
            let worst = errors(metric, &rows, &found);
            assert!(worst.iter().any(|&e| e > 10.0 * BOUND), "{metric}, {wrong}: {worst:.1?}");
        }
    }
}
