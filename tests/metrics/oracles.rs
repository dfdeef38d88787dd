//! The independent oracle of each metric: all data that tests need beyond the metric's two files and its row. A metric
//! without an oracle does not compile.

use crate::triangles::lengths;
use gpu_smooth::{
    Metric,
    metric::{Corner, Ideal},
};

/// Half a unit in the last place of a float close to 1.
pub(crate) const ULP: f64 = 1.0 / 16_777_216.0;
/// Binary logarithm of the exponent of EDGE's p-norm.
pub(crate) const SHARPNESS: u32 = 4;

/// Returns q by the simplest formula in the lengths and the area of a triangle, and in the ideal of the mesh.
pub(crate) fn quality(metric: Metric, [a, b, c]: [f64; 3], area: f64, ideal: Ideal) -> f64 {
    let Ideal { area: mean_area, size_weight, .. } = ideal;
    let squares = a * a + b * b + c * c;
    // For T = A W⁻¹, with W the equilateral triangle of mean area: |T|² and τ = det T.
    let (norm, det) = (squares / (12f64.sqrt() * mean_area), area / mean_area);
    // μ₂ = |T|² / 2τ - 1, μ₅₆ = (τ + 1/τ) / 2 - 1 and μ₇₇ = (τ - 1/τ)² / 2.
    let shape = norm / (2.0 * det) - 1.0;
    let (linear, square) = (0.5 * (det + 1.0 / det) - 1.0, (det - 1.0 / det).powi(2) / 2.0);
    let (linear, square) = (size_weight * linear, size_weight * square);
    let root = |square: f64| square.max(0.0).sqrt();
    match metric {
        Metric::Edge => a.max(b).max(c) / a.min(b).min(c),
        Metric::Area => (area - mean_area).abs() / mean_area,
        Metric::Rms => (squares / 3.0).sqrt() / (4.0 * mean_area / 3f64.sqrt()).sqrt(),
        Metric::Imr => squares / (4.0 * 3f64.sqrt() * area),
        Metric::Ar => 3f64.sqrt() * squares / (12.0 * area),
        // |T|² (1 + 1/det² T) - 4.
        Metric::ShapeSize => root(norm * (1.0 + 1.0 / (det * det)) - 4.0),
        Metric::Tmop80 => root(0.5 * (shape + square)),
        Metric::Tmop94 => root(shape + 1.5 * linear),
        Metric::SoftSize => root(shape + 0.4 * linear),
        Metric::Tmop2 => root(shape),
        Metric::Acute => {
            let sides = [a, b, c].map(|side| side * side);
            let cotangent = |k: usize| {
                let [opposite, one, two] = [0, 1, 2].map(|i| sides[(k + i) % 3]);
                (one + two - opposite) / (4.0 * area)
            };
            root([0, 1, 2].map(cotangent).into_iter().map(acute_share).sum::<f64>() + 2.0 / 3.0)
        }
        Metric::AcuteSize => {
            let acute = quality(Metric::Acute, [a, b, c], area, ideal);
            let imr = quality(Metric::Imr, [a, b, c], area, ideal);
            root(acute * acute - imr * imr + shape + 0.4 * linear)
        }
        _ => panic!("{metric}: write the formula of q here, another way than src/metric does"),
    }
}

/// Returns the share of an angle in q² by ACUTE, from its cotangent.
fn acute_share(cotangent: f64) -> f64 {
    let penalty = |x: f64| match x {
        ..=0.0 => 0.0,
        ..=0.2 => x.powi(3) / 0.6,
        _ => 0.04 / 3.0 + (x - 0.2) * x,
    };
    cotangent * cotangent / 3.0 + 300.0 * penalty(0.2 - cotangent) + 30.0 * penalty(cotangent - 1.3)
}

/// Returns whether q² of a large triangle is nearly linear in the area, so that second derivatives cancel.
pub(crate) fn is_linear_in_size(metric: Metric) -> bool {
    match metric {
        Metric::SoftSize | Metric::Tmop94 | Metric::AcuteSize => true,
        Metric::Edge
        | Metric::Area
        | Metric::Rms
        | Metric::Imr
        | Metric::Ar
        | Metric::ShapeSize
        | Metric::Tmop80
        | Metric::Tmop2
        | Metric::Acute => false,
        _ => {
            panic!("{metric}: say here whether q² of a large triangle is nearly linear in the area")
        }
    }
}

/// Returns two mistakes for the WGSL of a metric's derivatives, in the gradient or in the Hessian: a text that occurs
/// once in the file, and its replacement. A test must detect each mistake.
pub(crate) fn mistakes(metric: Metric) -> [[&'static str; 2]; 2] {
    match metric {
        Metric::Edge => {
            [["own + k * spread", "own - k * spread"], ["q * g, q *", "1.001 * q * g, q *"]]
        }
        Metric::Area => {
            [["0.0, 0.0, 2.0)", "0.0, 0.0, 1.0)"], ["0.0, 2.0 * q,", "0.0, 2.001 * q,"]]
        }
        Metric::Rms => [
            ["rms_value(t), 1.0, 1.0", "rms_value(t), 1.0, 1.001"],
            ["slopes.excess * (2.0 *", "slopes.excess * (2.002 *"],
        ],
        Metric::Imr => {
            [["m * (3.0 * m + 2.0)", "m * (3.003 * m + 2.0)"], ["-m * excess", "m * excess"]]
        }
        Metric::Ar => [
            ["2.0 * (1.0 - q) * q", "2.0 * (1.0 + q) * q"],
            ["2.0 * (1.0 - 2.0 * q)", "2.0 * (1.0 - 2.002 * q)"],
        ],
        Metric::ShapeSize => [
            ["2.0 * e * cube", "2.01 * e * cube"],
            ["3.0 * e * inverse + 1.0", "3.0 * e * inverse + 1.01"],
        ],
        Metric::Tmop80 => [
            [
                "weight * size * (square + 1.0) - e * square",
                "weight * size * (square + 1.0) + e * square",
            ],
            ["3.0 * square * square", "3.01 * square * square"],
        ],
        Metric::Tmop94 => [
            ["(weight * off * (t.area", "(1.01 * weight * off * (t.area"],
            ["2.0 * (e + weight", "2.0 * (e + 1.01 * weight"],
        ],
        Metric::SoftSize => [
            ["t.size_weight - e)", "t.size_weight + e)"],
            ["2.0 * (e + weight", "2.0 * (1.01 * e + weight"],
        ],
        Metric::Tmop2 => [["1.0, -m, 0.0", "1.01, -m, 0.0"], ["2.0 * m)", "2.01 * m)"]],
        Metric::Acute | Metric::AcuteSize => [
            ["penalties.y * unit * area_slope", "penalties.y * unit * 1.01 * area_slope"],
            ["dot(t.b, c), -c, 0.0", "dot(t.b, c), c, 0.0"],
        ],
        _ => panic!("{metric}: add two mistakes that a test must notice in its WGSL"),
    }
}

/// Sizes of the terms in value, gradient and Hessian of q², and the factors by which the terms amplify an error in the
/// last place of an edge.
pub(crate) struct Scales {
    pub(crate) sizes: [f64; 3],
    pub(crate) conditions: [f64; 3],
}

/// Returns the scales of a metric's errors on a device, for a triangle seen from one vertex.
pub(crate) fn scales(metric: Metric, t: &Corner<f64>) -> Scales {
    let [a, b, c] = lengths(t);
    let doubled = t.doubled_area();
    let q = metric.quality(t);
    match metric {
        Metric::Edge => {
            let (k, shortest) = (f64::from(1u32 << SHARPNESS), a.min(b));
            // The third edge is the difference of the two edges that move with the vertex. The power k amplifies the
            // error of the shares.
            let canceled = 1.0 + a.max(b) / c;
            Scales {
                sizes: [q * q, q * q / shortest, k * q * q / (shortest * shortest)],
                conditions: [canceled, k * canceled, k * canceled],
            }
        }
        Metric::Area => {
            let (q, per_length) = (1.0 + a * b / t.ideal.area, c / t.ideal.area);
            let sizes = [q * q, q * per_length, per_length * per_length];
            Scales { sizes, conditions: [1.0; 3] }
        }
        Metric::Rms => {
            let squares = a * a + b * b + c * c;
            let sizes = [1.0 + squares / t.ideal.area, (a + b) / t.ideal.area, 1.0 / t.ideal.area];
            Scales { sizes, conditions: [1.0; 3] }
        }
        Metric::Imr | Metric::Ar | Metric::Tmop2 => {
            // TMOP-2 is the ratio itself, without the square, and less one.
            let q = if metric == Metric::Tmop2 { 1.0 + q * q } else { q };
            let per_length = c / doubled + (a + b) / (q * doubled);
            let bend = 6.0 * q * q * per_length * per_length + 2.0 * q / doubled;
            // The area is a difference of products of the edges.
            Scales {
                sizes: [q * q, 2.0 * q * q * per_length, bend],
                conditions: [1.0 + a * b / doubled; 3],
            }
        }
        Metric::Acute | Metric::AcuteSize => {
            // A cotangent changes by 1 / sin² of its angle, which is at most the product of two edges squared over the
            // squared area. The penalties are at most 300 (x + 0.2)², and the second derivative at most 600.
            let most = (a.max(b).max(c).powi(2) / doubled).max(1.0);
            let per_length = (a + b + c) * most / doubled;
            // ACUTE-SIZE has terms of size beside them.
            let size =
                if metric == Metric::Acute { None } else { Some(scales(Metric::SoftSize, t)) };
            let [value, gradient, hessian] = size.map_or([0.0; 3], |scales| scales.sizes);
            Scales {
                sizes: [
                    300.0 * (most + 0.2) * (most + 0.2) + value,
                    600.0 * (most + 0.2) * per_length + gradient,
                    600.0 * (most + 1.0) * per_length * per_length + hessian,
                ],
                conditions: [1.0 + a * b / doubled; 3],
            }
        }
        Metric::ShapeSize => {
            let mean = 2.0 * t.ideal.area;
            let (tau, norm) = (doubled / mean, (a * a + b * b + c * c) / mean);
            // Derivatives by the squared norm and by the determinant, followed by second derivatives.
            let (by_norm, by_det) =
                (1.0 + 1.0 / (tau * tau), 1.0 + (1.0 + norm / tau) / (tau * tau));
            let (of_norm, of_det) = ((a + b) / mean, (a + b + c) / mean);
            let mixed = 4.0 / tau.powi(3);
            let bend = by_norm * 2.0 / mean
                + mixed * (of_norm * of_det + (1.0 + 3.0 * norm / tau) * of_det * of_det);
            Scales {
                sizes: [4.0 + norm * by_norm, by_norm * of_norm + 2.0 * by_det * of_det, bend],
                conditions: [1.0 + a * b / doubled; 3],
            }
        }
        Metric::Tmop80 | Metric::Tmop94 | Metric::SoftSize => {
            let mean = 2.0 * t.ideal.area;
            let (tau, norm) = (doubled / mean, (a * a + b * b + c * c) / mean);
            // Derivatives by the squared norm and by the determinant, for both parts of the metric, followed by second
            // derivatives.
            let weight = t.ideal.size_weight;
            let (by_norm, by_det) =
                (1.0 / tau, norm / (tau * tau) + weight * (tau + 1.0 / tau.powi(3)));
            let (of_norm, of_det) = ((a + b) / mean, (a + b + c) / mean);
            let second = norm / tau.powi(3) + weight * (1.0 + 3.0 / tau.powi(4));
            let bend =
                by_norm * 2.0 / mean + of_norm * of_det / (tau * tau) + second * of_det * of_det;
            let value = norm / tau + weight * (tau * tau + 1.0 / (tau * tau));
            Scales {
                sizes: [value, by_norm * of_norm + by_det * of_det, bend],
                conditions: [1.0 + a * b / doubled; 3],
            }
        }
        _ => panic!("{metric}: write the sizes of its value and derivatives here"),
    }
}
