//! Triangles for tests of the metrics.

use gpu_smooth::metric::{Corner, Ideal};
use support::SplitMix64;

pub(crate) type Vec2 = [f64; 2];

pub(crate) fn sub(u: Vec2, v: Vec2) -> Vec2 {
    [u[0] - v[0], u[1] - v[1]]
}

pub(crate) fn length(u: Vec2) -> f64 {
    u[0].hypot(u[1])
}

/// Makes a triangle seen from its first vertex, in a mesh with the given mean area and a size weight of 1.
pub(crate) fn corner([p, q, r]: [Vec2; 3], mean_area: f64) -> Corner<f64> {
    Corner { a: sub(q, p), b: sub(r, p), ideal: Ideal::of_area(mean_area) }
}

/// Returns the triangle with its vertex moved by `d`.
pub(crate) fn displaced(t: &Corner<f64>, d: Vec2) -> Corner<f64> {
    Corner { a: sub(t.a, d), b: sub(t.b, d), ..*t }
}

/// Returns the triangle as seen from its next vertex.
pub(crate) fn next_corner(t: &Corner<f64>) -> Corner<f64> {
    Corner { a: sub(t.b, t.a), b: [-t.a[0], -t.a[1]], ..*t }
}

pub(crate) fn scaled(t: &Corner<f64>, factor: f64) -> Corner<f64> {
    Corner { a: t.a.map(|x| x * factor), b: t.b.map(|x| x * factor), ..*t }
}

pub(crate) fn rotated(t: &Corner<f64>, angle: f64) -> Corner<f64> {
    let (sin, cos) = angle.sin_cos();
    let turn = |[x, y]: Vec2| [cos * x - sin * y, sin * x + cos * y];
    Corner { a: turn(t.a), b: turn(t.b), ..*t }
}

pub(crate) fn lengths(t: &Corner<f64>) -> [f64; 3] {
    [length(t.a), length(t.b), length(sub(t.b, t.a))]
}

/// Returns the height of the vertex over the opposite edge.
pub(crate) fn height(t: &Corner<f64>) -> f64 {
    t.doubled_area() / length(sub(t.b, t.a))
}

/// Returns the inverse mean ratio by the simplest formula.
pub(crate) fn imr(t: &Corner<f64>) -> f64 {
    let squares: f64 = lengths(t).iter().map(|l| l * l).sum();
    squares / (2.0 * 3f64.sqrt() * t.doubled_area())
}

/// Makes an equilateral triangle of area 1, in a mesh of mean area 1.
pub(crate) fn equilateral() -> Corner<f64> {
    let edge = (4.0 / 3f64.sqrt()).sqrt();
    corner([[0.0, 0.0], [edge, 0.0], [0.5 * edge, 3f64.sqrt() / 2.0 * edge]], 1.0)
}

/// Returns the triangle in a mesh with a random size weight, 1 in half of all cases.
fn weighted(rng: &mut SplitMix64, mut t: Corner<f64>) -> Corner<f64> {
    if rng.below(2) == 0 {
        t.ideal.size_weight = 10f64.powf(rng.range(-0.5, 2.0));
    }
    t
}

/// Makes a random triangle with an inverse mean ratio of at most `worst`, at any angle, with edges near one.
pub(crate) fn random(rng: &mut SplitMix64, worst: f64) -> Corner<f64> {
    loop {
        let vertex = [0; 3].map(|_| [0; 2].map(|_| rng.range(-1.0, 1.0)));
        let t = corner(vertex, rng.range(0.2, 1.0));
        if t.doubled_area() > 0.0 && imr(&t) <= worst {
            return weighted(rng, t);
        }
    }
}

/// Makes a triangle with an inverse mean ratio near `ratio`, seen from a random vertex. A `needle` has one short edge,
/// other triangles have three long edges.
pub(crate) fn thin(rng: &mut SplitMix64, ratio: f64, needle: bool) -> Corner<f64> {
    let thickness = 1.0 / ratio;
    let tip = if needle { [0.3 * thickness, thickness] } else { [rng.range(0.2, 0.8), thickness] };
    let mut t = corner([[0.0, 0.0], [1.0, 0.0], tip], rng.range(0.2, 1.0));
    for _ in 0..rng.below(3) {
        t = next_corner(&t);
    }
    let t = rotated(&t, rng.range(0.0, 7.0));
    weighted(rng, t)
}
