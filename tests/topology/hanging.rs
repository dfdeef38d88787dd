//! Detection of hanging nodes, and of intentional slits without hanging nodes.

use gpu_smooth::{Mesh, Topology, topology::HangingNode};
use support::SplitMix64;

fn found(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<HangingNode> {
    let mesh = Mesh { points: points.to_vec(), triangles: triangles.to_vec(), ..Mesh::default() };
    Topology::new(&mesh).unwrap().hanging_nodes(points).unwrap()
}

/// Makes a triangle below the line from 0 to 1, and a fan above it with `inside` vertices on the line.
fn fan(inside: u32, turned: impl Fn([f64; 2]) -> [f64; 2]) -> (Vec<[f64; 2]>, Vec<[u32; 3]>) {
    let mut points = vec![[0.0, 0.0], [1.0, 0.0], [0.5, -1.0], [0.5, 1.0]];
    points.extend((1..=inside).map(|k| [f64::from(k) / f64::from(inside + 1), 0.0]));
    let mut line = vec![0];
    line.extend(4..4 + inside);
    line.push(1);
    let mut triangles = vec![[2, 1, 0]];
    triangles.extend(line.windows(2).map(|ends| [ends[0], ends[1], 3]));
    (points.into_iter().map(turned).collect(), triangles)
}

#[test]
fn nodes_inside_an_edge_hang() {
    for inside in [1, 2, 5] {
        let (points, triangles) = fan(inside, |point| point);
        let expected: Vec<_> =
            (4..4 + inside).map(|vertex| HangingNode { vertex, edge: [1, 0] }).collect();
        assert_eq!(found(&points, &triangles), expected);
        // Either winding, any position and direction, with the digits of a text file.
        let reversed: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert_eq!(found(&points, &reversed).len(), inside as usize);
        for k in 0..40 {
            let (sine, cosine) = (f64::from(k) * 0.3).sin_cos();
            let turn = |[x, y]: [f64; 2]| {
                [7.0 + cosine * x - sine * y, -3.0 + sine * x + cosine * y]
                    .map(|x| (1e5 * x).round() / 1e5)
            };
            let (points, triangles) = fan(inside, turn);
            assert_eq!(found(&points, &triangles), expected, "{k}");
        }
    }
}

/// In one half of a square, each cell is cut into four triangles around its center. Nodes hang only along the diagonal
/// between the halves.
#[test]
fn refined_parts_have_a_node_on_each_edge_between() {
    let n = 40_u32;
    let at = |x: u32, y: u32| y * (2 * n + 1) + x;
    let point = |k: u32| [f64::from(k % (2 * n + 1)), f64::from(k / (2 * n + 1))];
    let points: Vec<_> = (0..(2 * n + 1) * (2 * n + 1)).map(point).collect();
    let mut triangles = Vec::new();
    for (x, y) in (0..n).flat_map(|x| (0..n).map(move |y| (x, y))) {
        let mut field = |x: u32, y: u32, size: u32| {
            let [a, b] = [at(x, y), at(x + size, y)];
            let [c, d] = [at(x + size, y + size), at(x, y + size)];
            triangles.extend([[a, b, c], [a, c, d]]);
        };
        match 2 * x < n {
            true => field(2 * x, 2 * y, 2),
            false => {
                let all = [(0, 0), (1, 0), (1, 1), (0, 1)];
                all.into_iter().for_each(|(i, j)| field(2 * x + i, 2 * y + j, 1));
            }
        }
    }
    let nodes = found(&points, &triangles);
    let expected: Vec<_> = (0..n)
        .map(|y| HangingNode { vertex: at(n, 2 * y + 1), edge: [at(n, 2 * y), at(n, 2 * y + 2)] })
        .collect();
    assert_eq!(nodes, expected);
    // The result must not depend on the order of triangles.
    SplitMix64::new(5).shuffle(&mut triangles);
    assert_eq!(found(&points, &triangles), expected);
}

/// A slit between 0 and 1 with double vertices, at equal or different positions, and parts that only touch.
#[test]
fn slits_and_interfaces_have_none() {
    for places in [[0.5, 0.5], [0.3, 0.7]] {
        let mut points = vec![[0.0, 0.0], [1.0, 0.0], [0.5, -1.0], [0.5, 1.0]];
        points.extend(places.map(|x| [x, 0.0]));
        let triangles = [[2, 4, 0], [2, 1, 4], [0, 5, 3], [5, 1, 3]];
        assert_eq!(found(&points, &triangles), []);
    }
    // An interface with separate end vertices on each side.
    let (mut points, mut triangles) = fan(1, |point| point);
    points.extend([points[0], points[1]]);
    triangles[0] = [2, 6, 5];
    assert_eq!(found(&points, &triangles), []);
    // An actual hole between the same vertices.
    let (mut points, triangles) = fan(1, |point| point);
    points[4][1] = 0.05;
    assert_eq!(found(&points, &triangles), []);
    points[4][1] = 0.0;
    assert_eq!(found(&points, &triangles).len(), 1);
    assert!(
        Topology::new(&Mesh { points: points.clone(), triangles, ..Mesh::default() })
            .unwrap()
            .hanging_nodes(&points[1..])
            .is_err()
    );
}

/// Directions on either side of the negative x axis must be neighbors in the sorted order around a vertex.
#[test]
fn directions_go_on_at_the_negative_axis() {
    let mut points = vec![[0.0, 0.0], [-2.0, -1e-4], [-1.0, 1e-4], [-1.0, 1.0], [-1.0, -1.0]];
    let mut triangles = vec![[1, 0, 3], [0, 2, 4], [2, 1, 4]];
    for k in 0..200 {
        let at = |k: f64| {
            let (sine, cosine) = (-2.0 + 0.02 * k).sin_cos();
            [cosine, sine]
        };
        let v = points.len() as u32;
        points.extend([at(f64::from(k)), at(f64::from(k) + 0.5)]);
        triangles.push([0, v, v + 1]);
    }
    assert_eq!(found(&points, &triangles), [HangingNode { vertex: 2, edge: [1, 0] }]);
}

/// A hundred thousand separate needles around a common vertex.
#[test]
fn hubs_are_searched_by_direction() {
    let count = 100_000;
    let mut points = vec![[0.0, 0.0]];
    let mut triangles = Vec::new();
    for k in 0..count {
        let at = |k: f64| {
            let (sine, cosine) = (k * std::f64::consts::TAU / f64::from(count)).sin_cos();
            [cosine, sine]
        };
        let v = points.len() as u32;
        points.extend([at(f64::from(k)), at(f64::from(k) + 0.5)]);
        triangles.push([0, v, v + 1]);
    }
    assert_eq!(found(&points, &triangles), []);
}
