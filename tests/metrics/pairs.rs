//! Pairs of floats, which store positions and sums: accuracy on the adapter, of at most 48 bits.

use crate::device::{Device, probe};
use gpu_smooth::{Metric, gpu::Kernel, options::Derivatives};
use support::SplitMix64;

fn split(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

fn join([high, low]: [f32; 2]) -> f64 {
    f64::from(high) + f64::from(low)
}

/// Returns a random number of either sign with magnitude near `size`.
fn number(rng: &mut SplitMix64, size: f64) -> f64 {
    rng.range(-2.0, 2.0) * size * 2f64.powf(rng.range(-4.0, 4.0))
}

#[test]
fn two_sum_loses_nothing() {
    let mut rng = SplitMix64::new(21);
    // Sizes differ by at most 2^20, so that a double holds the exact sum of two floats.
    let rows: Vec<[f32; 2]> = (0..2000)
        .map(|i| [number(&mut rng, 1.0), number(&mut rng, 2f64.powi(i % 21 - 10))])
        .map(|pair| pair.map(|x| x as f32))
        .collect();
    let body = "    let s = two_sum(x[0], x[1]); y[0] = s.x; y[1] = s.y;";
    let sums: Vec<[f32; 2]> =
        Device::open().run(&(Kernel::KeepBest.wgsl() + &probe(2, 2, body)), &rows);
    for ([a, b], sum) in rows.into_iter().zip(sums) {
        assert_eq!(join(sum), f64::from(a) + f64::from(b), "{a} + {b}");
        assert_eq!(sum[0], a + b);
    }
}

#[test]
fn sums_of_pairs_keep_44_bits() {
    let mut rng = SplitMix64::new(22);
    let rows: Vec<[[f32; 2]; 2]> = (0..2000)
        .map(|i| [number(&mut rng, 1.0), number(&mut rng, 2f64.powi(i % 41 - 20))].map(split))
        .collect();
    let body = "    let s = pair_add(vec2(x[0], x[1]), vec2(x[2], x[3])); y[0] = s.x; y[1] = s.y;";
    let sums: Vec<[f32; 2]> =
        Device::open().run(&(Kernel::KeepBest.wgsl() + &probe(4, 2, body)), &rows);
    for (terms, sum) in rows.into_iter().zip(sums) {
        let [a, b] = terms.map(join);
        // Relative to the larger term, because the sum may cancel.
        let bound = a.abs().max(b.abs()) * 2f64.powi(-44);
        assert!((join(sum) - (a + b)).abs() <= bound, "{a} + {b}: {sum:?}");
    }
}

#[test]
fn a_long_sum_of_pairs_keeps_40_bits() {
    let mut rng = SplitMix64::new(23);
    let rows: Vec<[f32; 2]> = (0..100).map(|_| split(rng.range(0.1, 1.0))).collect();
    let body = "    var s = vec2(0.0);
    for (var i = 0u; i < 1000u; i++) { s = pair_add(s, vec2(x[0], x[1])); }
    y[0] = s.x; y[1] = s.y;";
    let sums: Vec<[f32; 2]> =
        Device::open().run(&(Kernel::KeepBest.wgsl() + &probe(2, 2, body)), &rows);
    for (term, sum) in rows.into_iter().zip(sums) {
        // A thousand roundings of 2^-48 each; in the worst case, nearly all have the same direction.
        let exact = 1000.0 * join(term);
        assert!((join(sum) - exact).abs() <= exact * 2f64.powi(-40), "{term:?}: {sum:?}");
    }
}

/// A short edge far from the origin, and a move of the edge's head.
struct Far {
    tail: [f64; 2],
    head: [f64; 2],
    step: [f32; 2],
}

fn far_edges() -> Vec<Far> {
    let mut rng = SplitMix64::new(24);
    let of = |i: i32| {
        // Up to a million edges from the origin, the extent of a mesh with 10^12 triangles.
        let (size, edge) = (10f64.powi(i % 7), rng.range(0.1, 1.0));
        let tail = [0; 2].map(|_| number(&mut rng, size));
        let mut offset = |length: f64| [0; 2].map(|_| length * rng.range(-1.0, 1.0));
        let [dx, dy] = offset(edge);
        let step = offset(0.1 * edge).map(|x| x as f32);
        Far { tail, head: [tail[0] + dx, tail[1] + dy], step }
    };
    (0..2000).map(of).collect()
}

/// Returns the position as stored by the engine: high parts in xy, low parts in zw.
fn position([x, y]: [f64; 2]) -> [f32; 4] {
    let ([x, x_low], [y, y_low]) = (split(x), split(y));
    [x, y, x_low, y_low]
}

#[test]
fn edges_keep_their_digits_far_from_the_origin_and_after_moves() {
    let edges = far_edges();
    let rows: Vec<[f32; 10]> = edges
        .iter()
        .map(|far| {
            let ([a, b, c, d], [e, f, g, h]) = (position(far.tail), position(far.head));
            [a, b, c, d, e, f, g, h, far.step[0], far.step[1]]
        })
        .collect();
    let body = "    let tail = vec4(x[0], x[1], x[2], x[3]);
    let head = vec4(x[4], x[5], x[6], x[7]);
    let moved = advanced(tail, vec2(x[8], x[9]));
    let before = edge(tail, head);
    let after = edge(moved, head);
    y = array<f32, 8>(before.x, before.y, after.x, after.y, moved.x, moved.y, moved.z, moved.w);";
    let wgsl = Kernel::Sweep(Metric::Imr, Derivatives::Analytic).wgsl() + &probe(10, 8, body);
    let results: Vec<[f32; 8]> = Device::open().run(&wgsl, &rows);
    for (far, [bx, by, ax, ay, mx, my, mx_low, my_low]) in edges.iter().zip(results) {
        for (axis, before, after, moved) in [(0, bx, ax, [mx, mx_low]), (1, by, ay, [my, my_low])] {
            let (tail, head, step) = (far.tail[axis], far.head[axis], f64::from(far.step[axis]));
            // The edge is accurate to single precision, apart from the resolution of the pairs at both ends.
            let lost = (tail.abs() + head.abs()) * 2f64.powi(-48);
            let bound = |edge: f64| edge.abs() * 2f64.powi(-22) + lost;
            let exact = head - tail;
            let error = (f64::from(before) - exact).abs();
            assert!(error <= bound(exact), "edge at {tail}: {error:e}");

            let there = tail + step;
            let error = (join(moved) - there).abs();
            assert!(error <= (tail.abs() + step.abs()) * 2f64.powi(-46), "{tail} moved: {error:e}");
            // Normalized: the low part is below half a unit of the high part, so many moves lose nothing.
            assert_eq!(moved[0] + moved[1], moved[0]);
            let exact = head - there;
            let error = (f64::from(after) - exact).abs();
            assert!(error <= bound(exact) + 4.0 * lost, "edge after a move at {tail}: {error:e}");
        }
    }
}
