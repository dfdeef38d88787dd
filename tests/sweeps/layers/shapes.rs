//! Walls with layers: flat walls, stairs, corners, channels, airfoils, plates and wakes.

use std::f64::consts::PI;

use support::SplitMix64;

use super::grown::{Cut, Grown};

/// A layer: the height of its first row, the growth of heights from row to row, and the number of rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows {
    pub(super) first: f64,
    pub(super) growth: f64,
    pub(super) count: usize,
}

impl Rows {
    /// Returns the rows above edges of a length, with the aspect of the first row.
    pub(super) fn of_aspect(edge: f64, aspect: f64, growth: f64, count: usize) -> Self {
        Self { first: edge / aspect, growth, count }
    }

    /// Returns the heights above the wall, 0 first.
    pub(super) fn heights(self) -> Vec<f64> {
        let mut heights = vec![0.0];
        let mut step = self.first;
        for row in 0..self.count {
            heights.push(heights[row] + step);
            step *= self.growth;
        }
        heights
    }
}

/// A flat wall of 30 edges below a share of a square, with columns that lean by up to a tenth of an edge.
pub(super) fn flat(share: f64, rows: Rows, cut: Cut) -> Grown {
    stairs(share, rows, cut, |_| rows.count)
}

/// A flat wall as [`flat`]. `count` is the number of rows above each of the 31 vertices.
pub(super) fn stairs(share: f64, rows: Rows, cut: Cut, count: impl Fn(usize) -> usize) -> Grown {
    let edge = share / 30.0;
    let heights = rows.heights();
    let mut rng = SplitMix64::new(3);
    let mut column = |c: usize| -> Vec<[f64; 2]> {
        let lean = if 0 < c && c < 30 { 0.1 * edge } else { 0.0 };
        let up = heights.iter().enumerate().take(count(c) + 1);
        up.map(|(k, &y)| {
            let lean = if k > 0 { lean * rng.range(-1.0, 1.0) } else { 0.0 };
            [edge * c as f64 + lean, y]
        })
        .collect()
    };
    let columns: Vec<_> = (0..=30).map(&mut column).collect();
    let mut grown = Grown::woven(&columns, false, rows.count, cut);
    let top = |c: usize| *grown.columns[c].last().unwrap();
    let [first, last] = [0, 30].map(top);
    let at = |v: u32| grown.mesh.points[v as usize];
    let (from, to) = match share < 1.0 {
        true => (grown.columns[30][0], vec![at(first), [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]),
        false => (last, vec![at(first), [0.0, 1.0], [1.0, 1.0], at(last)]),
    };
    let mut ring = grown.outline(from, first);
    ring.extend(grown.path(&to, 3.0 * edge).drain(1..));
    if share < 1.0 {
        ring.extend(grown.path(&[[1.0, 0.0], [share, 0.0]], edge));
    }
    grown.surround(&[ring], 3.0 * edge);
    grown
}

/// A concave corner of two walls whose rows cross. Beyond, rows have equal heights.
pub(super) fn crossing(cut: Cut) -> Grown {
    let count = 19;
    let mut heights = Rows { first: 1.0 / 40.0, growth: 1.2, count: count + 1 }.heights();
    for row in count + 1..count + 22 {
        heights.push(heights[row] + 1.0);
    }
    let column = |&x: &f64| heights.iter().map(|&y| [x, y]).collect();
    let columns: Vec<Vec<_>> = heights.iter().map(column).collect();
    let mut grown = Grown::woven(&columns, false, count, cut);
    let size = heights.len();
    for (v, row) in grown.row.iter_mut().enumerate() {
        let nearest = (v / size).min(v % size);
        *row = (nearest <= count).then_some(nearest);
    }
    grown
}

/// A channel that rows from both walls fill.
pub(super) fn channel(cut: Cut) -> Grown {
    let heights = Rows::of_aspect(1.0, 100.0, 1.3, 14).heights();
    let top = 2.0 * heights[14];
    let all: Vec<f64> =
        heights.iter().copied().chain(heights[..14].iter().rev().map(|h| top - h)).collect();
    let mut rng = SplitMix64::new(9);
    let column = |c: usize| -> Vec<[f64; 2]> {
        let lean = if 0 < c && c < 40 { 0.1 * rng.range(-1.0, 1.0) } else { 0.0 };
        let is_wall = |k: usize| k == 0 || k + 1 == all.len();
        let at = |(k, &y): (usize, &f64)| [c as f64 + if is_wall(k) { 0.0 } else { lean }, y];
        all.iter().enumerate().map(at).collect()
    };
    let columns: Vec<_> = (0..=40).map(column).collect();
    Grown::woven(&columns, false, all.len(), cut)
}

/// A concave corner of two walls whose columns merge at its diagonal.
pub(super) fn merged(cut: Cut) -> Grown {
    let (edges, rows) = (30, Rows::of_aspect(1.0, 30.0, 1.2, 16));
    let heights = rows.heights();
    // Columns of the wall along x, each up to the diagonal, and their mirror images.
    let mut grown = Grown::default();
    let diagonal: Vec<u32> =
        heights.iter().enumerate().map(|(k, &h)| grown.add([h, h], Some(k))).collect();
    let mut sides: [Vec<Vec<u32>>; 2] = Default::default();
    for (side, columns) in sides.iter_mut().enumerate() {
        for c in 1..=edges {
            let x = c as f64;
            // The least distance of a column from the diagonal is half an edge.
            let below = heights.iter().take_while(|&&h| h < x - 0.5).enumerate();
            let point = |h: f64| if side == 0 { [x, h] } else { [h, x] };
            columns.push(below.map(|(k, &h)| grown.add(point(h), Some(k))).collect());
        }
    }
    let mut rng = SplitMix64::new(7);
    for (side, columns) in sides.iter().enumerate() {
        let turned = |[a, b, c]: [u32; 3]| if side == 0 { [a, b, c] } else { [a, c, b] };
        for k in 0..rows.count {
            let first = columns.iter().position(|column| column.len() > k + 1).unwrap();
            let low: Vec<u32> =
                columns.iter().filter_map(|column| column.get(k).copied()).collect();
            let skipped = columns.iter().take(first).filter(|column| column.len() > k).count();
            let mut from = diagonal[k];
            for &to in &low[..=skipped] {
                grown.mesh.triangles.push(turned([from, to, diagonal[k + 1]]));
                from = to;
            }
            let next = columns[first][k + 1];
            grown.mesh.triangles.push(turned([from, next, diagonal[k + 1]]));
            for (c, pair) in columns[first..].windows(2).enumerate() {
                let (left, right) =
                    if side == 0 { (&pair[0], &pair[1]) } else { (&pair[1], &pair[0]) };
                let quad = [left[k], right[k], right[k + 1], left[k + 1]];
                grown.fill(quad, c % 2 == 0, cut, &mut rng);
            }
        }
    }
    let top = |columns: &Vec<Vec<u32>>| -> Vec<u32> {
        columns.iter().filter_map(|column| column.get(rows.count).copied()).collect()
    };
    let mut ring: Vec<u32> = vec![diagonal[rows.count]];
    ring.extend(top(&sides[0]));
    let far = edges as f64;
    let height = heights[rows.count];
    ring.extend(grown.path(&[[far, height], [far, far], [height, far]], 2.0).drain(1..));
    ring.extend(top(&sides[1]).iter().rev());
    grown.surround(&[ring], 2.5);
    grown
}

/// Half a ring of 80 columns and 20 rows, of which 17 are in the layer. Columns and rows are moved by up to `noise` of
/// their spacings.
pub(super) fn noisy(noise: f64, cut: Cut, seed: u64) -> Grown {
    let edge = PI / 80.0;
    let heights = Rows { first: 0.0016, growth: 1.2, count: 20 }.heights();
    let mut rng = SplitMix64::new(seed);
    let mut column = |c: usize| -> Vec<[f64; 2]> {
        let point = |k: usize| {
            let is_inside = 0 < k && k < 20 && 0 < c && c < 80;
            let noise = if is_inside { noise } else { 0.0 };
            let step = heights[k] - heights[k.max(1) - 1];
            let angle = PI - edge * (c as f64 + noise * rng.range(-1.0, 1.0));
            let radius = 1.0 + heights[k] + noise * step * rng.range(-1.0, 1.0);
            [radius * angle.cos(), radius * angle.sin()]
        };
        (0..=20).map(point).collect()
    };
    let columns: Vec<_> = (0..=80).map(&mut column).collect();
    Grown::woven(&columns, false, 17, cut)
}
