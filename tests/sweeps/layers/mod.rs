//! Boundary layers that are found and stay.

use crate::{backends, run};
use gpu_smooth::{
    Mesh, Options, Smoother, Topology,
    layers::{Elements, KeepLayers, Layers},
};
use std::f64::consts::PI;
use support::SplitMix64;

/// How quadrilaterals are cut into triangles.
#[derive(Clone, Copy, Debug)]
enum Cut {
    Aligned,
    Alternating,
    Random,
}

const CUTS: [Cut; 3] = [Cut::Aligned, Cut::Alternating, Cut::Random];

/// Weaves columns of points, from the wall upward, to a mesh. The columns come from right to left as seen from the wall if
/// they are closed to a ring, else from left to right. Columns may begin at one point.
fn woven(columns: &[Vec<[f64; 2]>], is_closed: bool, cut: Cut) -> Mesh {
    let mut mesh = Mesh::default();
    let mut index: Vec<Vec<u32>> = Vec::new();
    for (c, column) in columns.iter().enumerate() {
        let mut own = Vec::new();
        for (k, &point) in column.iter().enumerate() {
            if k == 0 && c > 0 && columns[c - 1][0] == point {
                own.push(index[c - 1][0]);
            } else {
                own.push(mesh.points.len() as u32);
                mesh.points.push(point);
            }
        }
        index.push(own);
    }
    let mut rng = SplitMix64::new(7);
    let last = columns.len() - usize::from(!is_closed);
    for c in 0..last {
        let (left, right) = (&index[c], &index[(c + 1) % columns.len()]);
        for k in 0..left.len() - 1 {
            let [p, q, r, s] = [left[k], right[k], right[k + 1], left[k + 1]];
            let is_first = match cut {
                Cut::Aligned => true,
                Cut::Alternating => c % 2 == 0,
                Cut::Random => rng.below(2) == 0,
            };
            if p == q {
                mesh.triangles.push([p, r, s]);
            } else {
                mesh.triangles.extend(match is_first {
                    true => [[p, q, r], [p, r, s]],
                    false => [[p, q, s], [q, r, s]],
                });
            }
        }
    }
    mesh
}

/// Heights of a layer's rows above the wall, and of rows of high cells beyond.
fn heights(first: f64, growth: f64, rows: usize, beyond: [f64; 2]) -> Vec<f64> {
    let mut heights = vec![0.0];
    let mut next = first;
    for row in 0..rows + beyond[1] as usize {
        let step = if row < rows { next } else { beyond[0] };
        heights.push(heights[row] + step);
        next *= growth;
    }
    heights
}

/// A flat wall of 40 edges of length 1 with a layer of `rows` rows, whose columns are moved by up to a tenth of an edge.
/// Beyond the layer, vertices are moved by up to a fifth of an edge and a row.
fn flat(aspect: f64, growth: f64, rows: usize, cut: Cut) -> (Mesh, Vec<bool>) {
    let heights = heights(1.0 / aspect, growth, rows, [1.2, 8.0]);
    let mut rng = SplitMix64::new(3);
    let mut column = |c: usize| -> Vec<[f64; 2]> {
        let point = |(k, &y): (usize, &f64)| {
            let is_inside = 0 < c && c < 40 && k > 0 && k + 1 < heights.len();
            let [along, up] = match (is_inside, k > rows) {
                (false, _) => [0.0; 2],
                (true, false) => [0.1, 0.0],
                (true, true) => [0.2, 0.24],
            };
            [c as f64 + along * rng.range(-1.0, 1.0), y + up * rng.range(-1.0, 1.0)]
        };
        heights.iter().enumerate().map(point).collect()
    };
    let columns: Vec<_> = (0..=40).map(&mut column).collect();
    let truth = (0..=40).flat_map(|_| (0..heights.len()).map(|k| k <= rows)).collect();
    (woven(&columns, false, cut), truth)
}

/// An airfoil of NACA's four digits with a layer, with a fan of columns at the sharp trailing edge.
fn airfoil(thickness: f64, rows: usize, cut: Cut) -> (Mesh, Vec<bool>) {
    let n = 50;
    let shape = |x: f64| {
        let root = 0.2969 * x.sqrt() - 0.126 * x - 0.3516 * x * x + 0.2843 * x.powi(3);
        5.0 * thickness * (root - 0.1036 * x.powi(4))
    };
    let at = |i: usize| 0.5 * (1.0 - (PI * i as f64 / f64::from(n)).cos());
    let upper = (0..=n as usize).rev().map(|i| [at(i), shape(at(i))]);
    let lower = (1..n as usize).map(|i| [at(i), -shape(at(i))]);
    let wall: Vec<[f64; 2]> = upper.chain(lower).collect();
    let heights = heights(5e-4, 1.3, rows, [0.05, 8.0]);
    let mut rng = SplitMix64::new(5);
    let mut columns: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut add = |from: [f64; 2], angle: f64| {
        let point = |(k, &h): (usize, &f64)| {
            let noise = if k > rows && k + 1 < heights.len() { 0.009 } else { 0.0 };
            let h = h + noise * rng.range(-1.0, 1.0);
            [from[0] + h * angle.cos(), from[1] + h * angle.sin()]
        };
        columns.push(heights.iter().enumerate().map(point).collect());
    };
    let count = wall.len();
    let normal = |i: usize| {
        let [p, q] = [wall[i % count], wall[(i + 1) % count]];
        (p[0] - q[0]).atan2(q[1] - p[1])
    };
    for (i, &vertex) in wall.iter().enumerate() {
        let (before, after) = (normal(i + count - 1), normal(i));
        let turn = (after - before).rem_euclid(2.0 * PI);
        let fan = if turn > 2.0 { 8 } else { 0 };
        for k in 0..=fan {
            let share = if fan == 0 { 0.5 } else { f64::from(k) / f64::from(fan) };
            add(vertex, before + share * turn);
        }
    }
    columns.reverse();
    let mesh = woven(&columns, true, cut);
    let at_wall = |p: &[f64; 2]| wall.contains(p);
    let mut truth = vec![false; mesh.points.len()];
    let mut next = 0;
    for (c, column) in columns.iter().enumerate() {
        for k in 0..column.len() {
            if k == 0 && c > 0 && columns[c - 1][0] == column[0] {
                continue;
            }
            truth[next] = k <= rows;
            next += 1;
        }
    }
    assert!(mesh.points.iter().zip(&truth).all(|(p, t)| *t || !at_wall(p)));
    (mesh, truth)
}

/// A corner of the wall with layers on both sides that cross.
fn corner(cut: Cut) -> (Mesh, Vec<bool>) {
    let steps = heights(0.02, 1.25, 14, [0.5, 20.0]);
    let mut rng = SplitMix64::new(11);
    let last = steps.len() - 1;
    let mut point = |i: usize, j: usize| {
        let noise = if i.min(j) > 14 && i.max(j) < last { 0.1 } else { 0.0 };
        [steps[i] + noise * rng.range(-1.0, 1.0), steps[j] + noise * rng.range(-1.0, 1.0)]
    };
    let columns: Vec<Vec<_>> =
        (0..=last).map(|i| (0..=last).map(|j| point(i, j)).collect()).collect();
    let truth = (0..=last).flat_map(|i| (0..=last).map(move |j| i.min(j) <= 14)).collect();
    (woven(&columns, false, cut), truth)
}

fn layers(mesh: &Mesh, keep: KeepLayers, lines: &[[u32; 2]]) -> Layers {
    assert!(support::is_valid(mesh) && support::is_ccw(mesh));
    let topology = Topology::new(mesh).unwrap();
    let elements = Elements { topology: &topology, points: &mesh.points, faces: &[], lines };
    keep.find(&elements, None).unwrap()
}

/// Returns precision and recall of the vertices inside a mesh.
fn shares(mesh: &Mesh, truth: &[bool], found: &Layers) -> [f64; 2] {
    let is_boundary = support::boundary(mesh);
    let is_inside = |v: &u32| !is_boundary[*v as usize];
    let right = found.vertices.iter().filter(|v| is_inside(v) && truth[**v as usize]).count();
    let found = found.vertices.iter().filter(|v| is_inside(v)).count();
    let all = (0..).zip(truth).filter(|(v, truth)| **truth && is_inside(v)).count();
    [right as f64 / found.max(1) as f64, right as f64 / all as f64]
}

#[test]
fn rows_of_layers_are_found_on_flat_walls_airfoils_and_in_corners() {
    let least = |mesh: &(Mesh, Vec<bool>), label: &str, least: [f64; 2]| {
        let found = layers(&mesh.0, KeepLayers::Auto, &[]);
        let shares = shares(&mesh.0, &mesh.1, &found);
        assert!(shares[0] >= least[0] && shares[1] >= least[1], "{label}: {shares:?}");
    };
    for cut in CUTS {
        for (aspect, growth, rows) in [(6.0, 1.15, 9), (42.0, 1.25, 14), (500.0, 1.3, 20)] {
            let label = format!("flat, {aspect}, {cut:?}");
            least(&flat(aspect, growth, rows, cut), &label, [0.992, 0.995]);
        }
        for thickness in [0.06, 0.12, 0.24] {
            let label = format!("airfoil, {thickness}, {cut:?}");
            least(&airfoil(thickness, 11, cut), &label, [0.9935, 0.995]);
        }
        // Where rows cross at equal spacing, triangles are not stretched and move.
        least(&corner(cut), &format!("corner, {cut:?}"), [0.995, 0.9]);
    }
}

#[test]
fn layers_on_both_sides_of_an_inner_wall_are_found() {
    let (upper, truth) = flat(42.0, 1.25, 14, Cut::Random);
    let mirrored = upper.points.iter().map(|&[x, y]| [x, -y]);
    // The vertices of the wall, at height 0, are those of both halves.
    let count = upper.points.len() as u32;
    let mut mesh = upper.clone();
    let mut of = Vec::new();
    for (v, point) in (0..).zip(mirrored) {
        of.push(if point[1] == 0.0 { v } else { mesh.points.len() as u32 });
        if point[1] != 0.0 {
            mesh.points.push(point);
        }
    }
    let lower = upper.triangles.iter().map(|&[a, b, c]| [a, c, b].map(|v| of[v as usize]));
    mesh.triangles.extend(lower);
    let wall: Vec<u32> = (0..count).filter(|&v| upper.points[v as usize][1] == 0.0).collect();
    let lines: Vec<[u32; 2]> = wall.windows(2).map(|w| [w[0], w[1]]).collect();
    let mut all = truth.clone();
    all.extend((0..count).filter(|&v| of[v as usize] != v).map(|v| truth[v as usize]));
    let found = layers(&mesh, KeepLayers::Auto, &lines);
    let [precision, recall] = shares(&mesh, &all, &found);
    assert!(precision >= 0.99 && recall >= 0.995, "{precision} {recall}");
    assert_eq!(layers(&mesh, KeepLayers::Auto, &[]).vertices, []);
}

#[test]
fn meshes_without_layers_keep_no_vertex() {
    let lattice = support::lattice(30, 30);
    let stretched = Mesh {
        points: lattice.points.iter().map(|&[x, y]| [8.0 * x, y]).collect(),
        ..lattice.clone()
    };
    let random = support::perturb_random(&lattice, 0.4, 2);
    let graded = support::perturb_random(&support::graded(40, 0.01), 0.35, 3);
    for mesh in [lattice, stretched, random, graded, support::layered(24, 60.0)] {
        assert_eq!(layers(&mesh, KeepLayers::Auto, &[]).vertices, []);
    }
}

#[test]
fn rows_and_distances_are_kept_whatever_the_heights() {
    let (mesh, _) = flat(42.0, 1.25, 14, Cut::Alternating);
    let heights = heights(1.0 / 42.0, 1.25, 14, [1.2, 8.0]);
    let is_inside = |x: f64| 0.5 < x && x < 39.5;
    for count in [1, 3] {
        let found = layers(&mesh, KeepLayers::Rows(count), &[]);
        let expected: Vec<u32> = (0..mesh.points.len() as u32)
            .filter(|&v| is_inside(mesh.points[v as usize][0]))
            .filter(|&v| mesh.points[v as usize][1] <= heights[count as usize] + 1e-9)
            .collect();
        let own = |v: &u32| is_inside(mesh.points[*v as usize][0]);
        let found: Vec<u32> = found.vertices.into_iter().filter(own).collect();
        assert_eq!(found, expected);
    }
    let found = layers(&mesh, KeepLayers::Within(0.5), &[]);
    let is_near = |v: &u32| {
        let [x, y] = mesh.points[*v as usize];
        is_inside(x) && y <= 0.5
    };
    let near = (0..mesh.points.len() as u32).filter(is_near);
    assert!(near.clone().count() > 300 && near.clone().all(|v| found.vertices.contains(&v)));
    assert!(found.vertices.iter().all(|&v| mesh.points[v as usize][1] <= 0.5));
    assert_eq!(KeepLayers::None.to_owned(), "none".parse().unwrap());
    for bad in ["", "rows", "rows=0", "rows=1001", "within=0", "within=nan", "within=", "all"] {
        assert!(bad.parse::<KeepLayers>().is_err(), "{bad}");
    }
}

#[test]
fn vertices_of_inverted_triangles_are_not_kept() {
    let (mut mesh, _) = flat(42.0, 1.25, 14, Cut::Aligned);
    let all = layers(&mesh, KeepLayers::Auto, &[]);
    let moved = all.vertices[all.vertices.len() / 2];
    mesh.points[moved as usize][1] += 0.2;
    let topology = Topology::new(&mesh).unwrap();
    let bad = topology.bad_triangles(&mesh.points).unwrap();
    assert!(!bad.is_empty());
    let elements = Elements { topology: &topology, points: &mesh.points, faces: &[], lines: &[] };
    let found = KeepLayers::Auto.find(&elements, None).unwrap();
    assert!(found.vertices.len() > 300);
    assert!(bad.iter().flat_map(|bad| bad.vertices).all(|v| !found.vertices.contains(&v)));
    assert!(Elements { points: &[], ..elements }.layers(None).is_err());
    assert!(elements.layers(Some(&[u32::MAX])).is_err());
}

#[test]
fn the_mesh_beyond_a_kept_layer_improves_on_both_engines() {
    let (mesh, _) = airfoil(0.12, 11, Cut::Random);
    let found = layers(&mesh, KeepLayers::Auto, &[]);
    let fixed = Mesh { fixed: found.vertices.clone(), ..mesh.clone() };
    let smoother = Smoother::new(&fixed).unwrap();
    for backend in backends() {
        let outcome = run(&smoother, &Options::default(), backend);
        let is_kept = |v: &u32| outcome.points[*v as usize] == mesh.points[*v as usize];
        assert!(found.vertices.iter().all(is_kept));
        let after = Mesh { points: outcome.points, ..mesh.clone() };
        assert!(support::f_imr(&after) < support::f_imr(&mesh));
    }
}
