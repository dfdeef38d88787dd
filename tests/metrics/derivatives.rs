//! Comparison of dual numbers with central differences of the value, and of the CPU engine's derivatives with dual
//! numbers.

use crate::oracles::is_linear_in_size;
use crate::triangles::*;
use gpu_smooth::{Metric, internal::Dual, metric::Corner};
use support::SplitMix64;

fn central(metric: Metric, t: &Corner<f64>, sharpness: u32, h: f64) -> Dual {
    let value = |i: i32, j: i32| {
        metric.model(&displaced(t, [f64::from(i) * h, f64::from(j) * h]), sharpness)
    };
    let here = value(0, 0);
    let (east, west, north, south) = (value(1, 0), value(-1, 0), value(0, 1), value(0, -1));
    let mixed = value(1, 1) - value(1, -1) - value(-1, 1) + value(-1, -1);
    let xx = (east - 2.0 * here + west) / (h * h);
    let yy = (north - 2.0 * here + south) / (h * h);
    Dual {
        value: here,
        gradient: [(east - west) / (2.0 * h), (north - south) / (2.0 * h)],
        hessian: [xx, mixed / (4.0 * h * h), yy],
    }
}

/// Returns the mean differences of gradient and Hessian between central differences and the library's derivatives,
/// which `derived` may change. Units are q² over the height; `width` is relative to the height.
fn error(metric: Metric, sharpness: u32, width: f64, derived: impl Fn(Dual) -> Dual) -> [f64; 2] {
    let mut rng = SplitMix64::new(11);
    let mut sums = [0.0; 2];
    let count = 200;
    for _ in 0..count {
        let t = random(&mut rng, 5.0);
        let unit = height(&t);
        let differences = central(metric, &t, sharpness, width * unit);
        let exact = derived(metric.derivatives(&t, sharpness));
        let scale = metric.excess(&t).abs() + 1.0;
        let far = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - y).abs()).sum::<f64>();
        sums[0] += far(&exact.gradient, &differences.gradient) * unit / scale;
        sums[1] += far(&exact.hessian, &differences.hessian) * unit * unit / scale;
    }
    sums.map(|sum| sum / f64::from(count))
}

/// Returns the orders in which the errors of gradient and Hessian fall with the width of differences. Both orders are 2
/// for correct derivatives.
fn orders(metric: Metric, sharpness: u32, derived: impl Fn(Dual) -> Dual) -> [f64; 2] {
    // Narrow enough for the sharpest bend of the p-norm, and wide enough to exceed rounding.
    let width = 0.05 / 2f64.powi(sharpness as i32);
    let wide = error(metric, sharpness, width, &derived);
    let narrow = error(metric, sharpness, width / 2.0, &derived);
    [0, 1].map(|i| (wide[i] / narrow[i]).log2())
}

#[test]
fn central_differences_converge_to_the_derivatives_in_second_order() {
    for &metric in Metric::ALL.iter().filter(|metric| !metric.properties().quadratic) {
        let all = if !metric.is_smooth() { vec![1, 2, 4, 6, 9] } else { vec![0] };
        for sharpness in all {
            // The penalties of both metrics of angles have two continuous derivatives alone.
            let is_of_angles = matches!(metric, Metric::Acute | Metric::AcuteSize);
            let bound = if is_of_angles { 0.1 } else { 0.05 };
            for order in orders(metric, sharpness, |exact| exact) {
                assert!((order - 2.0).abs() < bound, "{metric}, sharpness {sharpness}: {order}");
            }
        }
    }
}

#[test]
fn central_differences_of_a_quadratic_are_its_derivatives() {
    for &metric in Metric::ALL.iter().filter(|metric| metric.properties().quadratic) {
        // The third derivatives vanish, so at any width, only rounding errors remain.
        let [gradient, hessian] = error(metric, 0, 0.3, |exact| exact);
        assert!(gradient < 1e-13 && hessian < 1e-12, "{metric}: {gradient:e} {hessian:e}");
    }
}

#[test]
fn a_derivative_wrong_by_a_percent_has_no_order() {
    let wrong_gradient = |d: Dual| Dual { gradient: d.gradient.map(|g| 1.01 * g), ..d };
    let wrong_hessian = |d: Dual| Dual { hessian: d.hessian.map(|h| 1.01 * h), ..d };
    for &metric in Metric::ALL {
        if metric.properties().quadratic {
            assert!(error(metric, 0, 0.3, wrong_gradient)[0] > 1e-3, "{metric}");
            assert!(error(metric, 0, 0.3, wrong_hessian)[1] > 1e-3, "{metric}");
        } else {
            let sharpness = if !metric.is_smooth() { 4 } else { 0 };
            assert!(orders(metric, sharpness, wrong_gradient)[0] < 1.5, "{metric}");
            assert!(orders(metric, sharpness, wrong_hessian)[1] < 1.5, "{metric}");
        }
    }
}

/// Returns the largest difference between two sets of derivatives of a triangle, relative to the largest entry.
fn distance(found: &Dual, exact: &Dual) -> f64 {
    let far = |x: &[f64], y: &[f64]| {
        let size = y.iter().fold(0f64, |most, y| most.max(y.abs()));
        x.iter().zip(y).fold(0f64, |most, (x, y)| most.max((x - y).abs())) / size
    };
    let value = (found.value - exact.value).abs() / (1.0 + exact.value.abs());
    value.max(far(&found.gradient, &exact.gradient)).max(far(&found.hessian, &exact.hessian))
}

/// Calls `check` with the derivatives of the CPU engine, those of dual numbers, and the allowed rounding error of the
/// triangle.
fn compare(metric: Metric, mut check: impl FnMut(Dual, Dual, f64)) {
    let mut rng = SplitMix64::new(17);
    for i in 0..2000 {
        let ratio = 10f64.powf(rng.range(0.5, 4.0));
        let t = if i % 2 == 0 { random(&mut rng, 50.0) } else { thin(&mut rng, ratio, i % 4 == 1) };
        let t = scaled(&t, 10f64.powf(rng.range(-3.0, 3.0)));
        let sharpness = if !metric.is_smooth() { i % 11 } else { 0 };
        // For large triangles, some metrics are nearly linear in the area, so second derivatives cancel.
        let tau = t.doubled_area() / (2.0 * t.ideal.area);
        let weight = t.ideal.size_weight.max(1.0);
        let size = if is_linear_in_size(metric) { tau.max(1.0) * weight } else { 1.0 };
        let rounding = 64.0 * f64::EPSILON * imr(&t) * 2f64.powi(sharpness as i32) * size;
        check(metric.expansion(&t, sharpness), metric.derivatives(&t, sharpness), rounding);
    }
}

#[test]
fn derivatives_of_the_cpu_engine_are_those_of_dual_numbers() {
    for &metric in Metric::ALL {
        compare(metric, |found, exact, rounding| {
            let off = distance(&found, &exact);
            assert!(off < rounding, "{metric}: {found:?} for {exact:?}, {off:e} of {rounding:e}");
        });
    }
}

#[test]
fn derivatives_wrong_by_a_millionth_are_not_those_of_dual_numbers() {
    for &metric in Metric::ALL {
        let mut told = 0;
        compare(metric, |found, exact, rounding| {
            let [xx, xy, yy] = found.hessian;
            let wrong = Dual { hessian: [xx, xy * (1.0 + 1e-6), yy * (1.0 - 1e-6)], ..found };
            told += u32::from(distance(&wrong, &exact) >= rounding);
        });
        assert!(told > 1500, "{metric}: {told}");
    }
}
