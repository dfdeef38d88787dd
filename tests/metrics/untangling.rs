//! Comparison of the untangling energy in WGSL with that of the CPU, on equal single-precision input.

use crate::device::{Device, probe};
use gpu_smooth::{gpu::Kernel, internal::untangling_energy};
use support::SplitMix64;

/// Input of an invocation: two edges, and ε in units of the doubled area.
type Row = [f32; 5];
/// Output of an invocation: value, gradient and Hessian, and the value computed separately.
type Found = [f32; 7];

/// Half a unit in the last place of a float close to 1.
const ULP: f64 = 1.0 / 16_777_216.0;

/// The bound of tests/metrics/shader.rs. Software adapters stay below 6.
const BOUND: f64 = 16.0;

fn wgsl() -> String {
    let body = "    let t = Corner(vec2(x[0], x[1]), vec2(x[2], x[3]), Ideal());
    let d = energy_derivatives(t, x[4]);
    y = array<f32, 7>(d.value, d.gradient.x, d.gradient.y, d.hessian.x, d.hessian.y, d.hessian.z, energy(t, x[4]));";
    Kernel::Untangle.wgsl() + &probe(5, 7, body)
}

/// Returns triangles of either orientation, from good to flat and from tiny to huge. ε ranges from nearly 0 to more
/// than their areas.
fn rows() -> Vec<Row> {
    let mut rng = SplitMix64::new(47);
    let mut rows = Vec::new();
    for i in 0..1200 {
        let size = [1.0, 1e-6, 1e6][i % 3];
        let mut edge = || [rng.range(-1.0, 1.0) * size, rng.range(-1.0, 1.0) * size];
        let (a, mut b) = (edge(), edge());
        if i % 4 == 0 {
            // Nearly flat: b is a multiple of a with a small perpendicular offset.
            let (share, beside) = (rng.range(-1.0, 2.0), rng.range(-1e-4, 1e-4));
            b = [share * a[0] - beside * a[1], share * a[1] + beside * a[0]];
        }
        let epsilon = 10f64.powf(rng.range(-6.0, 1.0)) * size * size;
        let [[ax, ay], [bx, by]] = [a, b].map(|edge| edge.map(|x| x as f32));
        rows.push([ax, ay, bx, by, epsilon as f32]);
    }
    rows
}

/// Returns the largest errors of value, gradient and Hessian, in units of the error caused by the last place of an
/// edge.
fn errors(rows: &[Row], found: &[Found]) -> [f64; 3] {
    let mut worst = [0f64; 3];
    for (row, found) in rows.iter().zip(found) {
        let [ax, ay, bx, by, epsilon] = row.map(f64::from);
        let [a, b, c] = [[ax, ay], [bx, by], [bx - ax, by - ay]].map(|[x, y]: [f64; 2]| x.hypot(y));
        // A target area of one half makes the doubled area the unit.
        let exact = untangling_energy([[ax, ay], [bx, by]], 0.5, epsilon);
        let root = epsilon.hypot(ax * by - ay * bx);
        let value = exact[0];
        let per_length = (a + b) / (a * a + b * b + c * c) + c / root;
        let sizes = [value, value * per_length, value * per_length * per_length];
        // The doubled area is a difference of products of the edges.
        let condition = 1.0 + a * b / root;
        for (i, (got, want)) in found.iter().zip(exact.iter().chain([&value])).enumerate() {
            let of = [0, 1, 1, 2, 2, 2, 0][i];
            let error = (f64::from(*got) - want).abs() / (sizes[of] * condition * ULP);
            worst[of] = worst[of].max(if error.is_finite() { error } else { f64::INFINITY });
        }
    }
    worst
}

#[test]
fn the_energy_and_its_derivatives_are_those_of_the_cpu() {
    let rows = rows();
    let inverted = |[ax, ay, bx, by, _]: &&Row| ax * by < ay * bx;
    assert!((400..800).contains(&rows.iter().filter(inverted).count()));
    let worst = errors(&rows, &Device::open().run(&wgsl(), &rows));
    assert!(worst.iter().all(|&error| error < BOUND), "{worst:.1?}");
}

#[test]
fn a_wrong_derivative_of_the_energy_is_detected() {
    let (device, rows) = (Device::open(), rows());
    for (right, wrong) in [
        ("inverse * (ds - s * dd)", "inverse * (ds + s * dd)"),
        ("inverse * (ds - s * dd)", "inverse * (ds - 1.001 * s * dd)"),
        ("let mixed = -inverse * ds;", "let mixed = inverse * ds;"),
        ("2.0 * s * per_root", "2.002 * s * per_root"),
        ("4.0 * PER_DOUBLED_AREA * inverse", "4.004 * PER_DOUBLED_AREA * inverse"),
    ] {
        let source = wgsl();
        assert_eq!(source.matches(right).count(), 1, "{right}");
        let worst = errors(&rows, &device.run(&source.replace(right, wrong), &rows));
        assert!(worst.iter().any(|&error| error > 10.0 * BOUND), "{wrong}: {worst:.1?}");
        assert!(worst[0] < BOUND, "the value is not concerned");
    }
}
