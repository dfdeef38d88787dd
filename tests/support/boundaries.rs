//! Meshes tangled by moves of the boundary or of inner lines, without the vertices inside. All of them can be
//! untangled.

use super::Mesh;
use super::check::held;
use super::generate::{lattice, triangulate};
use super::outline::Outline;
use super::rng::SplitMix64;
use super::trig::on_circle;
use std::f64::consts::TAU;

/// Returns the mesh with `to` applied to the vertices on the boundary and the fixed vertices.
pub fn dragged(mesh: &Mesh, mut to: impl FnMut([f64; 2]) -> [f64; 2]) -> Mesh {
    let mut dragged = mesh.clone();
    for (point, held) in dragged.points.iter_mut().zip(held(mesh)) {
        if held {
            *point = to(*point);
        }
    }
    dragged
}

fn is_near([x, y]: [f64; 2], [cx, cy]: [f64; 2], radius: f64) -> bool {
    (x - cx).hypot(y - cy) < radius
}

/// Returns the mesh with all held vertices within a radius of the origin rotated by `turn` full turns.
pub fn turned_inside(mesh: &Mesh, radius: f64, turn: f64) -> Mesh {
    let [cos, sin] = on_circle(turn);
    dragged(mesh, |[x, y]| match is_near([x, y], [0.0, 0.0], radius) {
        true => [cos * x - sin * y, sin * x + cos * y],
        false => [x, y],
    })
}

/// Centers of the holes of [`two_holes`]; `RADIUS` is the radius of both.
const HOLES: [[f64; 2]; 2] = [[1.5, 1.5], [4.0, 1.5]];
const RADIUS: f64 = 0.4;

/// Makes a plate with two equal round holes.
pub fn two_holes(vertices: usize) -> Mesh {
    let holes = HOLES.map(|[x, y]| format!("circle {x} {y} {RADIUS} 36\n")).concat();
    let outline = Outline::parse(&format!("loop\n0 0\n6 0\n6 3\n0 3\n{holes}")).unwrap();
    triangulate(&outline, vertices).unwrap()
}

/// Drags the first hole of [`two_holes`] past the second to a random position behind it.
pub fn past(mesh: &Mesh, seed: u64) -> Mesh {
    let mut rng = SplitMix64::new(seed);
    let [cos, sin] = on_circle(rng.range(-0.15, 0.15));
    let apart = rng.range(1.0, 1.4);
    let by = [HOLES[1][0] - HOLES[0][0] + apart * cos, apart * sin];
    dragged(mesh, |[x, y]| match is_near([x, y], HOLES[0], 1.2 * RADIUS) {
        true => [x + by[0], y + by[1]],
        false => [x, y],
    })
}

/// Nearly exchanges the holes of [`two_holes`], and rotates one of them.
pub fn swapped(mesh: &Mesh, seed: u64) -> Mesh {
    let mut rng = SplitMix64::new(seed);
    let up = rng.range(-0.5, 0.5);
    let [cos, sin] = on_circle(rng.range(0.0, 1.0));
    let [[ax, ay], [bx, by]] = HOLES;
    dragged(mesh, |[x, y]| {
        if is_near([x, y], HOLES[0], 1.2 * RADIUS) {
            let (x, y) = (x - ax, y - ay);
            [bx + cos * x - sin * y, by + up + sin * x + cos * y]
        } else if is_near([x, y], HOLES[1], 1.2 * RADIUS) {
            [x - bx + ax, y - up]
        } else {
            [x, y]
        }
    })
}

/// Makes a plate with `count` equal round holes in a row.
pub fn holes(count: usize, vertices: usize) -> Mesh {
    let width = 2.5 * count as f64 + 0.5;
    let mut outline = format!("loop\n0 0\n{width} 0\n{width} 3\n0 3\n");
    for i in 0..count {
        outline += &format!("circle {} 1.5 {RADIUS} 36\n", 1.5 + 2.5 * i as f64);
    }
    triangulate(&Outline::parse(&outline).unwrap(), vertices).unwrap()
}

/// Permutes the [`holes`] cyclically, and rotates every hole by a random angle.
pub fn permuted(mesh: &Mesh, count: usize, seed: u64) -> Mesh {
    let mut rng = SplitMix64::new(seed);
    let center = |i: usize| [1.5 + 2.5 * (i % count) as f64, 1.5];
    let turns: Vec<f64> = (0..count).map(|_| rng.range(-0.2, 0.2)).collect();
    dragged(mesh, |[x, y]| {
        let Some(i) = (0..count).find(|&i| is_near([x, y], center(i), 1.2 * RADIUS)) else {
            return [x, y];
        };
        let ([cx, cy], [tx, ty], [cos, sin]) = (center(i), center(i + 1), on_circle(turns[i]));
        let (x, y) = (x - cx, y - cy);
        [tx + cos * x - sin * y, ty + sin * x + cos * y]
    })
}

/// Pushes the side y = 0 of a lattice through it as a bump, by half to nine tenths of the height.
pub fn bumped(mesh: &Mesh, columns: usize, seed: u64) -> Mesh {
    let mut rng = SplitMix64::new(seed);
    let columns = columns as f64;
    let height = rng.range(0.5, 0.9) * columns * 3f64.sqrt() / 2.0;
    let (reach, middle) = (rng.range(0.12, 0.34) * columns, rng.range(0.35, 0.65) * columns);
    let share = |x: f64| (1.0 - ((x - middle) / reach).powi(2)).max(0.0).powi(2);
    dragged(mesh, |[x, y]| if y == 0.0 { [x, height * share(x)] } else { [x, y] })
}

/// Bends the boundary of a mesh in the first quadrant along an arc of `turn` full turns.
pub fn bent(mesh: &Mesh, turn: f64) -> Mesh {
    let most = |i: usize| mesh.points.iter().map(|p| p[i]).fold(0.0, f64::max);
    let (width, height) = (most(0), most(1));
    // The arc through the middle keeps the length of the mesh, and the inner side keeps a positive length.
    let radius = width / (turn * std::f64::consts::TAU);
    let thickness = radius.min(height);
    dragged(mesh, |[x, y]| {
        let [cos, sin] = on_circle((x / width - 0.5) * turn);
        let radius = radius + 0.6 * thickness - thickness * y / height;
        [radius * sin, radius * cos]
    })
}

/// Makes rings of triangles around a hole of radius one half. At the hole, layers are a hundredth as thick as edges are
/// long.
pub fn layers(around: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let edge = std::f64::consts::PI / around as f64;
    let (mut radius, mut thickness) = (0.5, edge / 100.0);
    let mut rings = 0;
    while radius < 3.0 {
        let shift = if rings % 2 == 0 { 0.0 } else { 0.5 };
        for i in 0..around {
            let [cos, sin] = on_circle((i as f64 + shift) / around as f64);
            mesh.points.push([radius * cos, radius * sin]);
        }
        rings += 1;
        radius += thickness;
        thickness = (1.2 * thickness).min(edge * radius / 0.5);
    }
    for ring in 1..rings {
        let at = |ring: usize, i: usize| (ring * around + i % around) as u32;
        for i in 0..around {
            let (a, b) = (at(ring - 1, i), at(ring - 1, i + 1));
            let (c, d) = (at(ring, i), at(ring, i + 1));
            mesh.triangles.extend(match ring % 2 {
                1 => [[a, c, b], [b, c, d]],
                _ => [[a, d, b], [a, c, d]],
            });
        }
    }
    mesh
}

/// Makes a rectangle of three regions: a disk around the origin, and the two sides of a line. Vertices between regions
/// are fixed.
pub fn regions(vertices: usize) -> Mesh {
    let mut text = String::from("loop\n-3 -2\n3 -2\n3 2\n-3 2\nline\n");
    for i in 0..=40 {
        let [cos, sin] = on_circle(f64::from(i % 40) / 40.0);
        text += &format!("{cos} {sin}\n");
    }
    text += "line\n1.6 -2\n1.7 -1\n1.9 0\n1.6 1\n1.8 2\n";
    triangulate(&Outline::parse(&text).unwrap(), vertices).unwrap()
}

/// Makes a straight channel whose boundary is bent: the middle line turns by up to 0.9 turns and swings to both sides.
pub fn channel(vertices: usize, seed: u64) -> Mesh {
    let mut rng = SplitMix64::new(seed);
    let length = rng.range(6.0, 20.0);
    let rows = (vertices as f64 / length).sqrt();
    let mesh = lattice((vertices as f64 / rows) as usize, rows as usize);
    let most = |i: usize| mesh.points.iter().map(|p| p[i]).fold(0.0, f64::max);
    let size = [most(0), most(1)];
    let (turn, waves, phase) = (rng.range(0.0, 0.9), rng.range(0.5, 1.5), rng.range(0.0, 1.0));
    // Curvatures stay below 1.9, so the inner side, at the distance 0.5, has a positive length.
    let swing = (1.9 - turn * TAU / length).clamp(0.0, 1.0) * length / (TAU * waves) / TAU;
    let heading = |s: f64| {
        let [_, sin] = on_circle(waves * s / length + phase);
        on_circle(turn * s / length + swing * sin)
    };
    const STEPS: usize = 2000;
    let step = length / STEPS as f64;
    let mut line = vec![[0.0, 0.0]];
    for i in 0..STEPS {
        let ([x, y], [cos, sin]) = (line[i], heading((i as f64 + 0.5) * step));
        line.push([x + step * cos, y + step * sin]);
    }
    dragged(&mesh, |[x, y]| {
        let (x, y) = (x / size[0] * length, y / size[1] - 0.5);
        let ([cx, cy], [cos, sin]) = (line[((x / step).round() as usize).min(STEPS)], heading(x));
        [cx - y * sin, cy + y * cos]
    })
}

/// Makes a square whose four sides are pushed in, each as a bump past which the bumps of other sides reach.
pub fn pushed(vertices: usize, seed: u64) -> Mesh {
    let mut rng = SplitMix64::new(seed);
    let outline = Outline::parse("loop\n0 0\n1 0\n1 1\n0 1\n").unwrap();
    let mesh = triangulate(&outline, vertices).unwrap();
    let middle = rng.range(0.25, 0.38);
    let reach = rng.range(0.12, 0.2);
    let [deep, flat] = [rng.range(0.6, 0.9), rng.range(0.0, 0.2)];
    let bump = |s: f64, middle: f64| (1.0 - ((s - middle) / reach).powi(2)).max(0.0).powi(2);
    dragged(&mesh, |[x, y]| {
        if y == 0.0 {
            [x, deep * bump(x, middle)]
        } else if y == 1.0 {
            [x, 1.0 - deep * bump(x, 1.0 - middle)]
        } else if x == 0.0 {
            [flat * bump(y, 0.5), y]
        } else {
            [1.0 - flat * bump(y, 0.5), y]
        }
    })
}
