//! Properties of each metric, as stated in the metric's file.

use crate::oracles;
use crate::triangles::*;
use gpu_smooth::{
    Metric,
    metric::{Corner, Ideal},
};
use support::SplitMix64;

const COUNT: usize = 500;
const WORST: f64 = 50.0;

/// Returns the allowed rounding error for a triangle: a few operations, amplified by cancellation of the area
/// in bad shapes.
fn rounding(t: &Corner<f64>) -> f64 {
    16.0 * f64::EPSILON * (1.0 + imr(t))
}

fn all_random(mut check: impl FnMut(Metric, &Corner<f64>)) {
    for (seed, &metric) in Metric::ALL.iter().enumerate() {
        let mut rng = SplitMix64::new(seed as u64);
        (0..COUNT).for_each(|_| check(metric, &random(&mut rng, WORST)));
    }
}

fn close(a: f64, b: f64, bound: f64) -> bool {
    (a - b).abs() <= bound * a.abs().max(b.abs()).max(1.0)
}

/// Returns the area from the lengths alone, by Kahan's form of Heron's formula, which does not cancel.
fn heron(t: &Corner<f64>) -> f64 {
    let mut l = lengths(t);
    l.sort_unstable_by(f64::total_cmp);
    let [c, b, a] = l;
    ((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))).sqrt() / 4.0
}

#[test]
fn the_equilateral_triangle_of_mean_area_is_ideal() {
    for &metric in Metric::ALL {
        let mut t = rotated(&equilateral(), 0.3);
        for _ in 0..3 {
            let excess = metric.excess(&t);
            let rounding = 4e-15 * metric.ideal_squared().max(1.0);
            assert!(excess.abs() < rounding, "{metric}: {excess:e}");
            assert!(close(metric.quality(&t), metric.properties().ideal, 1e-7), "{metric}");
            t = next_corner(&t);
        }
    }
}

#[test]
fn no_triangle_of_mean_area_is_better_than_ideal() {
    all_random(|metric, t| {
        let t = Corner { ideal: Ideal { area: 0.5 * t.doubled_area(), ..t.ideal }, ..*t };
        let least = metric.properties().ideal;
        assert!(metric.quality(&t) >= least - rounding(&t), "{metric}: {t:?}");
        if metric != Metric::Area && imr(&t) > 1.01 {
            assert!(metric.quality(&t) > least + 1e-3, "{metric}: {t:?}");
        }
    });
}

#[test]
fn quality_is_that_of_the_formula_in_lengths_and_area() {
    all_random(|metric, t| {
        let wanted = oracles::quality(metric, lengths(t), heron(t), t.ideal);
        let got = metric.quality(t);
        // The error of Heron's area: rounding of the lengths, amplified by the shape.
        assert!(close(got, wanted, 4.0 * rounding(t)), "{metric}: {got} for {wanted}, {t:?}");
    });
}

#[test]
fn excess_is_the_square_of_quality_less_that_of_the_ideal() {
    all_random(|metric, t| {
        let (whole, q) = (metric.excess(t) + metric.ideal_squared(), metric.quality(t));
        assert!(close(whole, q * q, 4.0 * f64::EPSILON), "{metric}: {whole} for {}", q * q);
    });
}

#[test]
fn excess_keeps_its_digits_near_the_ideal() {
    // A vertex moved by s changes q² - 1 by approximately s², which early rounding of q² would lose.
    for metric in [Metric::Imr, Metric::Ar] {
        let moved = displaced(&equilateral(), [3e-7, 2e-7]);
        let by_imr = Metric::Imr.excess(&moved);
        assert!((1e-14..1e-12).contains(&by_imr), "{by_imr:e}");
        // AR computes q first, so the rounding of q is allowed in addition.
        assert!((metric.excess(&moved) - by_imr).abs() < 2e-15, "{metric}");
    }
}

#[test]
fn quality_does_not_depend_on_the_corner_or_a_rotation() {
    all_random(|metric, t| {
        let q = metric.quality(t);
        let second = next_corner(t);
        for same in [second, next_corner(&second), rotated(t, 1.0), rotated(t, -2.5)] {
            assert!(close(metric.quality(&same), q, 2.0 * rounding(t)), "{metric}: {t:?}");
        }
    });
}

#[test]
fn the_size_weight_changes_the_metrics_of_which_the_table_says_so() {
    all_random(|metric, t| {
        let ideal = Ideal { size_weight: 2.0 * t.ideal.size_weight, ..t.ideal };
        let is_equal = metric.excess(&Corner { ideal, ..*t }) == metric.excess(t);
        assert_eq!(is_equal, !metric.has_size_weight(), "{metric}: {t:?}");
    });
}

#[test]
fn metrics_depend_on_size_as_the_table_says() {
    all_random(|metric, t| {
        let q = metric.quality(t);
        for factor in [1e-6, 0.5, 3.0, 1e6] {
            let larger = scaled(t, factor);
            let alike = close(metric.quality(&larger), q, rounding(t));
            assert_eq!(alike, metric.properties().scale_invariant, "{metric} times {factor}");
            // A change of the unit of length changes nothing, because the mean area has that unit.
            let ideal = Ideal { area: t.ideal.area * factor * factor, ..t.ideal };
            let same = Corner { ideal, ..larger };
            assert!(close(metric.quality(&same), q, rounding(t)), "{metric} in units of {factor}");
        }
    });
}

#[test]
fn a_barrier_grows_without_bound_and_the_others_do_not() {
    for &metric in Metric::ALL {
        let flat = |height: f64| corner([[0.5, height], [0.0, 0.0], [1.0, 0.0]], 0.4);
        let quality = |height: f64| metric.quality(&flat(height));
        if metric.properties().barrier {
            // q grows at least like the root of 1 / height, because q² grows at least like 1 / height.
            assert!(quality(1e-6) > 500.0 && quality(1e-9) > 30.0 * quality(1e-6), "{metric}");
            for height in [0.0, -1e-3, -1.0] {
                assert_eq!(quality(height), f64::INFINITY, "{metric} at {height}");
            }
        } else {
            assert!(quality(0.0) < 3.0 && close(quality(1e-9), quality(0.0), 1e-8), "{metric}");
        }
        // Without a barrier or a shape guard, triangles could invert.
        let properties = metric.properties();
        assert!(properties.barrier || properties.shape_guard.is_finite(), "{metric}");
    }
}

#[test]
fn a_quadratic_metric_has_one_hessian_wherever_the_vertex_is() {
    let mut rng = SplitMix64::new(7);
    for &metric in Metric::ALL {
        let mut differ = 0;
        for _ in 0..COUNT {
            let t = random(&mut rng, 5.0);
            let moved = displaced(&t, [0.2 * height(&t), 0.1 * height(&t)]);
            let [here, there] = [&t, &moved].map(|t| metric.derivatives(t, 4).hessian);
            let scale = here.iter().fold(0f64, |m, x| m.max(x.abs()));
            let same = here.iter().zip(there).all(|(x, y)| (x - y).abs() < 1e-12 * scale);
            differ += usize::from(!same);
        }
        let expected = if metric.properties().quadratic { 0 } else { COUNT };
        assert_eq!(differ, expected, "{metric}");
    }
}

#[test]
fn imr_and_ar_are_the_same_number() {
    let mut rng = SplitMix64::new(3);
    for i in 0..COUNT {
        let ratio = 10f64.powf(rng.range(0.5, 4.0));
        let t =
            if i % 2 == 0 { random(&mut rng, WORST) } else { thin(&mut rng, ratio, i % 4 == 1) };
        let [imr, ar] = [Metric::Imr, Metric::Ar].map(|metric| metric.quality(&t));
        assert!(close(imr, ar, rounding(&t)), "{imr} {ar}");
        let [di, da] = [Metric::Imr, Metric::Ar].map(|metric| metric.derivatives(&t, 4));
        let scale = di.hessian.iter().fold(0f64, |m, x| m.max(x.abs()));
        for (x, y) in di.hessian.into_iter().zip(da.hessian) {
            // The Hessian has two more derivatives than the value, each with equal cancellation.
            assert!((x - y).abs() <= 8.0 * rounding(&t) * scale, "{x} {y} of {scale}");
        }
    }
}

#[test]
fn the_p_norm_of_edge_is_exact_at_equilateral_and_comes_up_from_below() {
    assert!((0..=10).all(|sharpness| Metric::Edge.model(&equilateral(), sharpness).abs() < 1e-14));
    let mut rng = SplitMix64::new(5);
    for i in 0..COUNT {
        let mut t = random(&mut rng, WORST);
        if i % 3 == 0 {
            // Isosceles, with the two equal edges either the longest or the shortest.
            let apex = [0.5, rng.range(0.1, 2.0)];
            t = corner([[0.0, 0.0], [1.0, 0.0], apex], 0.4);
        }
        let exact = Metric::Edge.excess(&t) + 1.0;
        let mut before = 0.0;
        for sharpness in 0..=10 {
            let norm = Metric::Edge.model(&t, sharpness) + 1.0;
            let k = 2f64.powi(sharpness as i32);
            // In both factors, the mean of three powers is at least a third of the largest, which is one.
            let least = exact * 9f64.powf(-1.0 / k);
            let slack = 1e-13 * exact;
            assert!(norm <= exact + slack && norm >= least - slack, "k = {k}: {norm} for {exact}");
            assert!(norm >= before - slack, "k = {k}: {norm} after {before}");
            before = norm;
        }
        assert!(before > 0.997 * exact, "{before} for {exact}");
    }
}

#[test]
fn the_model_is_the_metric_itself_but_for_edge() {
    all_random(|metric, t| {
        let (model, excess) = (metric.model(t, 4), metric.excess(t));
        let derived = metric.derivatives(t, 4).value;
        assert_eq!(model == excess, metric.is_smooth(), "{metric}");
        assert!(close(derived, model, 64.0 * f64::EPSILON), "{metric}: {derived} for {model}");
    });
}
