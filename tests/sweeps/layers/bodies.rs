//! Closed bodies with layers: airfoils, cylinders, squares and plates.

use std::f64::consts::PI;

use super::grown::{Cut, Grown};
use super::shapes::Rows;

/// The wall of a body, clockwise: the fluid is on the left.
pub(super) type Wall = Vec<[f64; 2]>;

/// An airfoil of NACA's four digits with `edges` edges on each side, sharp or blunt at the trailing edge.
pub(super) fn naca(thickness: f64, edges: usize, is_blunt: bool) -> Wall {
    let last = if is_blunt { 0.1015 } else { 0.1036 };
    let shape = |x: f64| {
        let root = 0.2969 * x.sqrt() - 0.126 * x - 0.3516 * x * x + 0.2843 * x.powi(3);
        5.0 * thickness * (root - last * x.powi(4))
    };
    let at = |i: usize| 0.5 * (1.0 - (PI * i as f64 / edges as f64).cos());
    let mut wall: Wall = (0..=edges).rev().map(|i| [at(i), -shape(at(i))]).collect();
    wall.extend((1..=edges).map(|i| [at(i), shape(at(i))]));
    if is_blunt {
        wall.push([1.0, 0.0]);
    } else {
        wall.pop();
    }
    wall
}

/// A circle of radius one half.
pub(super) fn circle(edges: usize) -> Wall {
    let angle = |i: usize| -2.0 * PI * i as f64 / edges as f64;
    (0..edges).map(|i| [0.5 * angle(i).cos(), 0.5 * angle(i).sin()]).collect()
}

/// A square of side 1.
pub(super) fn square(edges: usize) -> Wall {
    let along = |i: usize| i as f64 / edges as f64 - 0.5;
    let side = |to: fn(f64) -> [f64; 2]| (0..edges).map(move |i| to(along(i)));
    let left = side(|s| [-0.5, s]).chain(side(|s| [s, 0.5]));
    left.chain(side(|s| [0.5, -s])).chain(side(|s| [-s, -0.5])).collect()
}

/// A plate without thickness: its upper side from left to right, then its lower side.
pub(super) fn plate(edges: usize) -> Wall {
    let at = |i: usize| 0.5 * (1.0 - (PI * i as f64 / edges as f64).cos());
    let upper = (0..edges).map(|i| [at(i), 0.0]);
    upper.chain((1..=edges).rev().map(|i| [at(i), 0.0])).collect()
}

/// Returns the mean length of a wall's edges.
pub(super) fn mean_edge(wall: &Wall) -> f64 {
    let count = wall.len();
    let edge = |i: usize| {
        let [[ax, ay], [bx, by]] = [wall[i], wall[(i + 1) % count]];
        (bx - ax).hypot(by - ay)
    };
    (0..count).map(edge).sum::<f64>() / count as f64
}

/// Returns the directions of columns: that of the bisector, or those of a fan where the wall turns by 60 degrees or more.
/// `fan` is the number of columns per half turn; 0 for no fans.
fn directions(wall: &Wall, at: usize, fan: u32) -> Vec<[f64; 2]> {
    let count = wall.len();
    let normal = |i: usize| {
        let [[ax, ay], [bx, by]] = [wall[i % count], wall[(i + 1) % count]];
        let size = (bx - ax).hypot(by - ay);
        [(ay - by) / size, (bx - ax) / size]
    };
    let [before, after] = [normal(at + count - 1), normal(at)];
    let cross = before[0] * after[1] - before[1] * after[0];
    let dot = before[0] * after[0] + before[1] * after[1];
    // The wall turns clockwise around a convex corner.
    let turn = match (-cross).atan2(dot) {
        turn if turn < -3.1 => PI,
        turn => turn,
    };
    if fan > 0 && turn > PI / 3.0 {
        let parts = (turn / PI * f64::from(fan)).round().max(2.0);
        let angle = |k: usize| before[1].atan2(before[0]) - turn * k as f64 / parts;
        return (0..=parts as usize).map(|k| [angle(k).cos(), angle(k).sin()]).collect();
    }
    let middle = [before[0] + after[0], before[1] + after[1]];
    let size = middle[0].hypot(middle[1]);
    if size < 1e-6 {
        // Behind a sharp edge, the column continues the edge.
        return vec![[before[1], -before[0]]];
    }
    let middle = middle.map(|x| x / size);
    let cosine = (middle[0] * after[0] + middle[1] * after[1]).max(0.4);
    let is_convex = 0.0 < turn && turn < 100.0_f64.to_radians();
    let stretched = cosine.max(if is_convex { 0.6 } else { 0.7 });
    vec![middle.map(|x| x / stretched)]
}

/// Returns the columns above the wall of a body.
fn columns(wall: &Wall, rows: Rows, fan: u32) -> Vec<Vec<[f64; 2]>> {
    let heights = rows.heights();
    let mut columns = Vec::new();
    for (i, &[x, y]) in wall.iter().enumerate() {
        for [dx, dy] in directions(wall, i, fan) {
            columns.push(heights.iter().map(|h| [x + h * dx, y + h * dy]).collect());
        }
    }
    columns
}

/// Surrounds bodies with layers by triangles up to a circle.
pub(super) fn bodies(walls: &[Wall], rows: Rows, fan: u32, cut: Cut) -> Grown {
    let mut grown = Grown::default();
    let mut loops = Vec::new();
    for wall in walls {
        let own = Grown::woven(&columns(wall, rows, fan), true, rows.count, cut);
        let offset = grown.mesh.points.len() as u32;
        loops.push(own.columns.iter().map(|c| c[rows.count] + offset).collect());
        grown.append(own);
    }
    let outer = (0..40).map(|i| {
        let angle = PI * f64::from(i) / 20.0;
        grown.add([0.5 + 6.0 * angle.cos(), 6.0 * angle.sin()], None)
    });
    loops.push(outer.collect());
    grown.surround(&loops, 0.6);
    grown
}

/// A body with layers, as [`bodies`].
pub(super) fn body(wall: &Wall, rows: Rows, fan: u32, cut: Cut) -> Grown {
    bodies(std::slice::from_ref(wall), rows, fan, cut)
}

/// A plate without thickness inside a mesh, with layers on both sides: a crack, or an inner wall of lines.
pub(super) fn sheet(is_crack: bool, rows: Rows, cut: Cut) -> Grown {
    let edges = 40;
    let mut grown = body(&plate(edges), rows, 6, cut);
    let mut starts: Vec<u32> = Vec::new();
    for column in &grown.columns {
        if starts.last() != Some(&column[0]) {
            starts.push(column[0]);
        }
    }
    if !is_crack {
        // The lower side, from right to left, gets the vertices of the upper side.
        grown.merge((1..edges).map(|i| [starts[edges + i], starts[edges - i]]));
        grown.lines = starts[..=edges].windows(2).map(|w| [w[0], w[1]]).collect();
    }
    grown
}

/// A C-grid around an airfoil: rows along the lower side of the wake, the airfoil, and the upper side of the wake. Returns
/// the vertices of the wake too.
pub(super) fn c_grid(thickness: f64, cut: Cut) -> (Grown, Vec<u32>) {
    let wall = naca(thickness, 60, false);
    let heights = Rows { first: 2e-4, growth: 1.25, count: 36 }.heights();
    let behind = Rows { first: 4e-3, growth: 1.15, count: 30 }.heights();
    let wake = |i: usize| [1.0 + behind[i], 0.0];
    let mut all = Vec::new();
    let column = |[x, y]: [f64; 2], [dx, dy]: [f64; 2]| -> Vec<[f64; 2]> {
        heights.iter().map(|h| [x + h * dx, y + h * dy]).collect()
    };
    all.extend((1..=30).rev().map(|i| column(wake(i), [0.0, -1.0])));
    all.push(column(wall[0], [0.0, -1.0]));
    for i in 1..wall.len() {
        let [dx, dy] = directions(&wall, i, 0)[0];
        let size = dx.hypot(dy);
        // Columns that lean backward would cross those of the wake.
        let dx = if wall[i][0] > 0.3 { 0.0 } else { dx };
        all.push(column(wall[i], [dx / size, dy / size]));
    }
    all.push(column(wall[0], [0.0, 1.0]));
    all.extend((1..=30).map(|i| column(wake(i), [0.0, 1.0])));
    let mut grown = Grown::woven(&all, false, 36, cut);
    let starts: Vec<u32> = grown.columns.iter().map(|column| column[0]).collect();
    let count = starts.len();
    grown.merge((0..=30).map(|i| [starts[count - 1 - i], starts[i]]));
    // The last vertex of the wake is on the boundary.
    (grown, starts[1..30].to_vec())
}
