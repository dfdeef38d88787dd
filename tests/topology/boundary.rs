//! The boundary as loops, and moves that are clamped before a triangle inverts.

use gpu_smooth::{Mesh, MeshError, Topology, topology::signed_area};
use support::{Outline, SplitMix64, check};

/// Makes a plate with two round holes.
fn plate(vertices: usize) -> Mesh {
    let text = "loop\n0 0\n3 0\n3 2\n0 2\ncircle 0.9 1 0.4 20\ncircle 2.1 1 0.3 16\n";
    support::triangulate(&Outline::parse(text).unwrap(), vertices).unwrap()
}

/// Checks that the loops consist of the edges with a single triangle, in the direction of that triangle's winding.
pub(crate) fn assert_loops_are_the_boundary(mesh: &Mesh) {
    let topology = Topology::new(mesh).unwrap();
    let loops = topology.boundary_loops();
    let mut found: Vec<[u32; 2]> = Vec::new();
    for vertices in &loops {
        assert!(vertices.len() >= 3);
        assert_eq!(vertices[0], *vertices.iter().min().unwrap());
        let mut once = vertices.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), vertices.len(), "a vertex twice in {vertices:?}");
        let next = vertices.iter().cycle().skip(1);
        found.extend(vertices.iter().zip(next).map(|(&v, &w)| [v, w]));
    }
    found.sort_unstable();
    let mut edges = topology.boundary_edges();
    edges.sort_unstable();
    assert_eq!(found, edges);
    let directed = topology.triangles().iter().flat_map(|&t| check::edges(t));
    let uses = support::edge_uses(mesh);
    let mut expected: Vec<_> =
        directed.filter(|&[v, w]| uses[&[v.min(w), v.max(w)]] == 1).collect();
    expected.sort_unstable();
    assert_eq!(edges, expected);
}

#[test]
fn loops_are_the_outside_and_the_holes() {
    let mesh = plate(600);
    for mesh in
        [mesh.clone(), support::renumbered(&mesh, 3).0, support::shuffled_windings(&mesh, 5)]
    {
        assert_loops_are_the_boundary(&mesh);
        let loops = Topology::new(&mesh).unwrap().boundary_loops();
        let mut areas: Vec<f64> = loops.iter().map(|l| signed_area(&mesh.points, l)).collect();
        areas.sort_by(f64::total_cmp);
        let polygon = |r: f64, n: f64| -0.5 * n * r * r * (std::f64::consts::TAU / n).sin();
        for (found, expected) in areas.iter().zip([polygon(0.4, 20.0), polygon(0.3, 16.0), 6.0]) {
            assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
        }
        assert_eq!(areas.len(), 3);
        assert!((areas.iter().sum::<f64>() - check::area(&mesh)).abs() < 1e-6);
    }
}

#[test]
fn signed_area_by_hand() {
    let points = [[1.0, 1.0], [4.0, 1.0], [4.0, 3.0], [1.0, 3.0]];
    assert_eq!(signed_area(&points, &[0, 1, 2, 3]), 6.0);
    assert_eq!(signed_area(&points, &[2, 1, 0]), -3.0);
    assert_eq!(signed_area(&points, &[9, 0, 1, 2, 3]), 6.0);
    assert_eq!([signed_area(&points, &[]), signed_area(&points, &[0, 1])], [0.0; 2]);
}

/// Makes a grid of unit squares, in which the squares at `squares` are missing.
fn without(side: u32, squares: &[[u32; 2]]) -> Mesh {
    let at = |x: u32, y: u32| y * (side + 1) + x;
    let all = (0..side * side).map(|i| [i % side, i / side]);
    let split = |[x, y]: [u32; 2]| {
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        [[a, b, c], [a, c, d]]
    };
    let points = (0..=side).flat_map(|y| (0..=side).map(move |x| [f64::from(x), f64::from(y)]));
    let triangles = all.filter(|square| !squares.contains(square)).flat_map(split).collect();
    Mesh { points: points.collect(), triangles, ..Mesh::default() }
}

#[test]
fn loops_that_touch_are_apart() {
    // Two holes that share a corner, a hole that shares a corner with the outside, and a part attached by one
    // vertex.
    for (squares, holes, outsides) in [
        (vec![[1, 1], [2, 2]], 2, 1),
        (vec![[1, 1], [2, 2], [3, 3]], 3, 1),
        (vec![[0, 0], [1, 1]], 1, 1),
        (vec![[0, 1], [1, 0]], 0, 2),
    ] {
        let mesh = without(5, &squares);
        assert_loops_are_the_boundary(&mesh);
        let loops = Topology::new(&mesh).unwrap().boundary_loops();
        let found = loops.iter().filter(|l| signed_area(&mesh.points, l) < 0.0).count();
        assert_eq!((found, loops.len() - found), (holes, outsides), "{squares:?}: {loops:?}");
    }
}

#[test]
fn one_triangle_is_its_own_loop() {
    let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let mesh = Mesh { points, triangles: vec![[1, 0, 2]], ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    assert_eq!(topology.boundary_loops(), [[0, 1, 2]]);
}

/// Returns random vertices with near and far targets: single vertices or with neighbors, some on the boundary.
fn random_moves(mesh: &Mesh, rng: &mut SplitMix64) -> Vec<(u32, [f64; 2])> {
    let count = 1 + rng.below(4);
    let reach = [0.01, 0.1, 1.0, 100.0][rng.below(4)];
    let mut moves = Vec::new();
    for _ in 0..count {
        let v = rng.below(mesh.points.len()) as u32;
        let [x, y] = mesh.points[v as usize];
        let to = [x + reach * rng.range(-1.0, 1.0), y + reach * rng.range(-1.0, 1.0)];
        moves.push((v, to));
        // The neighbors move as well, so that triangles rotate and shear.
        let star: Vec<_> = mesh.triangles.iter().filter(|t| t.contains(&v)).collect();
        for &w in star[rng.below(star.len())].iter().filter(|&&w| w != v) {
            let [x, y] = mesh.points[w as usize];
            moves.push((w, [x + reach * rng.range(-1.0, 1.0), y - reach * rng.range(-1.0, 1.0)]));
        }
    }
    moves
}

fn moved(mesh: &Mesh, moves: &[(u32, [f64; 2])], share: f64) -> Mesh {
    let mut there = mesh.clone();
    for &(v, to) in moves {
        let from = mesh.points[v as usize];
        there.points[v as usize] = [0, 1].map(|x| from[x] + share * (to[x] - from[x]));
    }
    there
}

#[test]
fn a_clamped_move_inverts_nothing_and_goes_as_far_as_that_allows() {
    // One of the meshes is far from the origin, where coordinates have a coarse resolution.
    let meshes = [
        support::perturb_random(&plate(300), 0.8, 1),
        support::transformed(&plate(300), 1.0, [3e5, -2e5]),
        support::transformed(&plate(200), 1e-60, [0.0, 0.0]),
    ];
    let mut rng = SplitMix64::new(11);
    let (mut clamped, mut whole) = (0, 0);
    for (which, mesh) in meshes.iter().enumerate() {
        let topology = Topology::new(mesh).unwrap();
        let unit = [1.0, 1.0, 1e-60][which];
        for turn in 0..400 {
            let mut moves = random_moves(mesh, &mut rng);
            if which == 2 {
                for (v, to) in &mut moves {
                    let from = mesh.points[*v as usize];
                    *to = [0, 1].map(|x| from[x] + unit * (to[x] - from[x]));
                }
            }
            let mut points = mesh.points.clone();
            let share = topology.move_clamped(&mut points, &moves, f64::INFINITY).unwrap();
            let result = Mesh { points, ..mesh.clone() };
            let case = format!("mesh {which}, turn {turn}, share {share}");
            assert!(check::orientations(&result).iter().all(|&o| o == 1), "{case}");
            let expected = if share == 1.0 {
                whole += 1;
                1.0
            } else {
                clamped += 1;
                share
            };
            for (v, (found, wish)) in
                result.points.iter().zip(&moved(mesh, &moves, expected).points).enumerate()
            {
                let near = |x: usize| (found[x] - wish[x]).abs() <= 1e-9 * unit;
                assert!(near(0) && near(1), "{case}: vertex {v} at {found:?}, not {wish:?}");
            }
            // Smaller fractions of the moves invert no triangle.
            for part in 1..8 {
                let there = moved(mesh, &moves, share * f64::from(part) / 8.0);
                assert!(check::orientations(&there).iter().all(|&o| o == 1), "{case}, {part}");
            }
            if share < 1.0 {
                // A slightly larger fraction inverts a triangle. Coarse coordinates need a larger excess.
                let farther = share + [1e-9, 1e-6, 1e-9][which] * (1.0 + share);
                let there = moved(mesh, &moves, farther);
                assert!(!check::is_ccw(&there), "{case}: it could have gone on");
            }
        }
    }
    assert!(clamped > 300 && whole > 100, "{clamped} {whole}");
}

#[test]
fn a_clamped_move_keeps_triangles_as_good_as_asked() {
    let mesh = support::perturb_random(&plate(300), 0.9, 1);
    let topology = Topology::new(&mesh).unwrap();
    let imrs = |mesh: &Mesh| -> Vec<f64> {
        mesh.triangles.iter().map(|&t| check::imr(check::corners(mesh, t))).collect()
    };
    let start = imrs(&mesh);
    assert!(start.iter().any(|&q| q > 3.0));
    let mut rng = SplitMix64::new(5);
    let mut clamped = 0;
    for turn in 0..400 {
        let limit = [1.0, 3.0, 8.0, 100.0][turn % 4];
        let moves = random_moves(&mesh, &mut rng);
        let mut points = mesh.points.clone();
        let share = topology.move_clamped(&mut points, &moves, limit).unwrap();
        let result = imrs(&Mesh { points, ..mesh.clone() });
        for (before, after) in start.iter().zip(&result) {
            assert!(*after <= limit.max(*before) * (1.0 + 1e-8), "{turn}: {after} from {before}");
        }
        if share < 1.0 {
            clamped += 1;
            let there = imrs(&moved(&mesh, &moves, share + 1e-6 * (1.0 + share)));
            let worse = |(b, a): (&f64, &f64)| *a > limit.max(*b) * (1.0 + 1e-9);
            assert!(start.iter().zip(&there).any(worse), "{turn}: it could have gone on");
        }
    }
    assert!(clamped > 100, "{clamped}");
}

#[test]
fn a_move_out_of_an_inverted_triangle_is_not_hindered_by_it() {
    let mut mesh = support::lattice(4, 4);
    let topology = Topology::new(&mesh).unwrap().into_owned();
    let middle = topology.free().iter().position(|&free| free).unwrap();
    let home = mesh.points[middle];
    mesh.points[middle] = [home[0] + 1.4, home[1]];
    assert!(!check::is_ccw(&mesh));
    let moves = [(middle as u32, home)];
    assert_eq!(topology.move_clamped(&mut mesh.points, &moves, f64::INFINITY), Ok(1.0));
    assert!(check::is_ccw(&mesh));
}

#[test]
fn a_move_of_no_vertex_succeeds_and_one_to_nan_is_an_error() {
    let mesh = support::lattice(3, 3);
    let topology = Topology::new(&mesh).unwrap();
    let mut points = mesh.points.clone();
    assert_eq!(topology.move_clamped(&mut points, &[], 8.0), Ok(1.0));
    let moves = [(5, [9.0, 9.0]), (5, mesh.points[5])];
    assert_eq!(topology.move_clamped(&mut points, &moves, 8.0), Ok(1.0));
    for to in [[f64::NAN, 0.0], [0.0, f64::INFINITY]] {
        let error = topology.move_clamped(&mut points, &[(4, [0.0; 2]), (5, to)], 8.0);
        assert_eq!(error, Err(MeshError::NotFinite { vertex: 5 }));
    }
    let vertices = points.len();
    let error = topology.move_clamped(&mut points, &[(16, [0.0; 2])], 8.0);
    assert_eq!(error, Err(MeshError::IndexOutOfRange { element: None, vertex: 16, vertices }));
    let huge = [(5, [f64::MAX, -f64::MAX]), (6, [-f64::MAX, f64::MAX])];
    let share = topology.move_clamped(&mut points.clone(), &huge, 8.0).unwrap();
    assert!((0.0..1e-200).contains(&share), "{share}");
    assert_eq!(points, mesh.points);
    let mut far: Vec<[f64; 2]> = points.iter().map(|point| point.map(|x| 1e300 * x)).collect();
    let error = topology.move_clamped(&mut far, &[(5, [f64::MAX, 0.0])], 8.0);
    assert!(matches!(error, Err(MeshError::OutOfRange { size }) if size >= 1e300), "{error:?}");
    assert!(far.iter().zip(&points).all(|(far, point)| *far == point.map(|x| 1e300 * x)));
    let error = topology.move_clamped(&mut points[..7], &[], 8.0);
    assert_eq!(error, Err(MeshError::PointCount { expected: vertices, given: 7 }));
}
