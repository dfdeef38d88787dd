//! Boundary layers that are found and stay.

mod bodies;
mod families;
mod grown;
mod shapes;

use std::borrow::Cow;

use crate::{backends, run};
use gpu_smooth::layers::{Elements, KeepLayers, Layers};
use gpu_smooth::{Mesh, Options, Slide, Smoother, Targets, Topology};

use bodies::{body, mean_edge, naca, plate, sheet};
use grown::{Cut, Grown};
use shapes::{Rows, flat};

/// Finds the layers of a mesh without inverted triangles.
fn layers_of(grown: &Grown) -> Layers {
    let Grown { mesh, faces, lines, .. } = grown;
    assert!(support::is_ccw(mesh));
    let topology = Topology::new(mesh).unwrap();
    let elements = Elements { topology: &topology, points: &mesh.points, faces, lines };
    KeepLayers::Auto.find(&elements, None).unwrap()
}

fn layers(mesh: &Mesh, keep: KeepLayers) -> Layers {
    let topology = Topology::new(mesh).unwrap();
    let elements = Elements { topology: &topology, points: &mesh.points, faces: &[], lines: &[] };
    keep.find(&elements, None).unwrap()
}

/// A flat wall with a layer of 14 rows.
fn on_flat_wall(cut: Cut) -> Grown {
    flat(1.0, Rows::of_aspect(1.0 / 30.0, 42.0, 1.25, 14), cut)
}

/// An airfoil with a layer of 15 rows.
fn around_airfoil() -> Grown {
    let wall = naca(0.12, 40, false);
    body(&wall, Rows::of_aspect(mean_edge(&wall), 40.0, 1.25, 14), 6, Cut::Random)
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
        assert_eq!(layers(&mesh, KeepLayers::Auto).vertices, []);
    }
    // An inner wall that no line names is no wall.
    let rows = Rows::of_aspect(mean_edge(&plate(40)), 40.0, 1.25, 14);
    let unnamed = sheet(false, rows, Cut::Aligned);
    assert_eq!(layers(&unnamed.mesh, KeepLayers::Auto).vertices, []);
}

#[test]
fn rows_and_distances_are_kept_whatever_the_heights() {
    let grown = on_flat_wall(Cut::Alternating);
    let columns = &grown.columns[1..30];
    let sides = [0, 30].map(|c| &grown.columns[c]);
    for count in [1, 3] {
        let found = layers(&grown.mesh, KeepLayers::Rows(count));
        let of_column = |column: &Vec<u32>| column[..=count as usize].to_vec();
        let mut expected: Vec<u32> = columns.iter().flat_map(of_column).collect();
        let of_side = |column: &&Vec<u32>| column[1..=count as usize].to_vec();
        expected.extend(sides.iter().flat_map(of_side));
        expected.sort_unstable();
        // Columns next to the sides end, and rings of neighbors continue the columns.
        assert!(expected.iter().all(|v| found.vertices.binary_search(v).is_ok()));
        let others = found.vertices.iter().filter(|v| expected.binary_search(v).is_err());
        assert!(others.count() <= 4, "{count}");
        assert_eq!(found.rows, count as usize);
    }
    let found = layers(&grown.mesh, KeepLayers::Within(0.02));
    let is_near = |v: &u32| grown.mesh.points[*v as usize][1] <= 0.02;
    let near: Vec<u32> = columns.iter().flatten().copied().filter(is_near).collect();
    assert!(near.len() > 200 && near.iter().all(|v| found.vertices.contains(v)));
    assert!(found.vertices.iter().all(is_near));
    assert_eq!(KeepLayers::None.to_owned(), "none".parse().unwrap());
    for bad in ["", "rows", "rows=0", "rows=1001", "within=0", "within=nan", "within=", "all"] {
        assert!(bad.parse::<KeepLayers>().is_err(), "{bad}");
    }
}

/// A former defect: a single flat triangle kept the whole wall, which was the whole boundary of a round mesh.
#[test]
fn rows_are_of_whole_walls_only_if_a_quarter_of_a_wall_has_flat_triangles() {
    let below = |flat: std::ops::Range<usize>| -> Vec<u32> {
        let mut mesh = support::quadrilaterals::with_cells(20, |_, _| true);
        flat.for_each(|column| mesh.points[21 + column][1] = 0.2);
        let kept = layers(&mesh, KeepLayers::Rows(1)).vertices;
        kept.into_iter().filter(|v| (1..20).contains(v)).collect()
    };
    assert_eq!(below(9..11), [9, 10]);
    assert_eq!(below(3..8), (1..20).collect::<Vec<_>>());
}

#[test]
fn vertices_of_inverted_triangles_are_not_kept() {
    let Grown { mut mesh, columns, .. } = on_flat_wall(Cut::Aligned);
    mesh.points[columns[15][5] as usize][1] += 0.02;
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
fn runs_of_the_library_keep_layers_by_default_like_fixed_vertices() {
    let Grown { mesh, .. } = around_airfoil();
    let found = layers(&mesh, KeepLayers::Auto);
    assert!(found.vertices.len() > 1000);
    let fixed = Mesh { fixed: found.vertices.clone(), ..mesh.clone() };
    let listed = Smoother::keeping(Cow::Borrowed(&fixed), Layers::default()).unwrap();
    let kept = Smoother::new(&mesh).unwrap();
    assert_eq!(kept.layers(), &found);
    let free = Smoother::keeping(Cow::Borrowed(&mesh), Layers::default()).unwrap();
    for backend in backends() {
        let options = Options::default();
        let [kept, listed, free] =
            [&kept, &listed, &free].map(|smoother| run(smoother, &options, backend).points);
        assert_eq!(kept, listed);
        let stays = |points: &[[f64; 2]]| {
            let equal = |v: &u32| points[*v as usize] == mesh.points[*v as usize];
            found.vertices.iter().all(equal)
        };
        assert!(stays(&kept) && !stays(&free));
        let after = Mesh { points: kept, ..mesh.clone() };
        assert!(support::f_imr(&after) < support::f_imr(&mesh));
    }
}

#[test]
fn walls_below_layers_and_the_ends_of_rows_on_other_walls_do_not_slide() {
    let Grown { mesh, columns, .. } = on_flat_wall(Cut::Shortest);
    let mut smoother = Smoother::new(&mesh).unwrap();
    let sides: Vec<u32> = [0, 30].iter().flat_map(|&c: &usize| columns[c][1..].to_vec()).collect();
    let mut expected = sides.clone();
    expected.sort_unstable();
    assert_eq!(smoother.layers().sides, expected);
    let lines = smoother.topology().boundary_edges();
    let sliding = smoother.set_slide(Some(&Slide { lines, ..Slide::default() })).unwrap();
    assert!(sliding > 20);
    let outcome = smoother.run(&Options::default()).block().unwrap();
    let stays = |v: u32| outcome.points[v as usize] == mesh.points[v as usize];
    assert!(columns.iter().flatten().all(|&v| stays(v)));
    assert!(outcome.slid.unwrap().moved > 10);
}

#[test]
fn a_mesh_whose_free_vertices_are_all_in_layers_stays_as_it_is() {
    let rows = Rows::of_aspect(1.0 / 30.0, 42.0, 1.25, 14).heights();
    let column = |c: usize| rows.iter().map(|&y| [c as f64 / 30.0, y]).collect();
    let columns: Vec<_> = (0..=30).map(column).collect();
    let Grown { mesh, .. } = Grown::woven(&columns, false, 14, Cut::Alternating);
    let mut smoother = Smoother::new(&mesh).unwrap();
    assert!(smoother.layers().have_all_free(smoother.topology()));
    let slide = Slide { lines: smoother.topology().boundary_edges(), ..Slide::default() };
    assert_eq!(smoother.set_slide(Some(&slide)).unwrap(), 0);
    for backend in backends() {
        let outcome = run(&smoother, &Options::default(), backend);
        assert_eq!((outcome.points, outcome.sweeps), (mesh.points.clone(), 0));
    }
}

#[test]
fn the_spacing_at_walls_is_the_distance_of_the_vertices_next_to_them() {
    let of = |grown: &Grown, wall: Vec<[u32; 2]>, after: &[[f64; 2]]| {
        let Grown { mesh, faces, lines, .. } = grown;
        let topology = Topology::new(mesh).unwrap();
        let elements = Elements { topology: &topology, points: &mesh.points, faces, lines };
        elements.spacing(&[wall, Vec::new()], after).unwrap()
    };
    let chain = |columns: &[Vec<u32>]| -> Vec<[u32; 2]> {
        let ends = columns.windows(2).map(|w| [w[0][0], w[1][0]]);
        ends.filter(|[a, b]| a != b).collect()
    };
    for cut in [Cut::Alternating, Cut::Whole] {
        let grown = on_flat_wall(cut);
        let first = 1.0 / 30.0 / 42.0;
        let mut after: Vec<_> = grown.mesh.points.iter().map(|&[x, y]| [x, 1.5 * y]).collect();
        after[grown.columns[7][1] as usize][1] = 3.0 * first;
        after[grown.columns[8][1] as usize][1] = first;
        let found = of(&grown, chain(&grown.columns), &after);
        let wall = found[0].unwrap();
        assert!(found[1].is_none() && wall.is_flat());
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        assert_eq!((wall.count, wall.flat), (29, 29));
        assert!(near(wall.medians[0], first) && near(wall.medians[1], 1.5 * first));
        assert!(wall.ratios.into_iter().zip([1.0, 1.5, 3.0]).all(|(a, b)| near(a, b)));
        assert!(near(wall.changed, 28.0 / 29.0) && near(wall.largest_change(), 3.0));
    }
    // Both sides of a wall inside the mesh count; its ends do not.
    let rows = Rows::of_aspect(mean_edge(&plate(40)), 40.0, 1.25, 14);
    let inner = sheet(false, rows, Cut::Shortest);
    let wall = of(&inner, inner.lines.clone(), &inner.mesh.points)[0].unwrap();
    assert_eq!((wall.count, wall.ratios), (2 * 39, [1.0; 3]));
    // Around the sharp edge of an airfoil, the vertex next to the wall is behind the edge.
    let airfoil = around_airfoil();
    let mut around = chain(&airfoil.columns);
    around.push([airfoil.columns[airfoil.columns.len() - 1][0], airfoil.columns[0][0]]);
    let wall = of(&airfoil, around, &airfoil.mesh.points)[0].unwrap();
    let edge = mean_edge(&naca(0.12, 40, false)) / 40.0;
    assert!(wall.count == 80 && (wall.medians[0] / edge - 1.0).abs() < 0.05, "{wall:?}");
}

/// Returns the largest inverse mean ratio of triangles with a vertex that moves and a vertex that stays.
fn worst_at_rim(mesh: &Mesh, is_free: &[bool], points: &[[f64; 2]]) -> f64 {
    let is_at_rim = |t: &&[u32; 3]| {
        let free = t.iter().filter(|v| is_free[**v as usize]).count();
        0 < free && free < 3
    };
    let triangles = mesh.triangles.iter().filter(is_at_rim).copied().collect();
    support::worst_imr(&Mesh { points: points.to_vec(), triangles, ..Mesh::default() })
}

#[test]
fn keep_shape_does_not_stretch_the_triangles_beyond_a_kept_layer() {
    let wall = naca(0.12, 60, false);
    // The last row is ten times as long as high.
    let grown = body(&wall, Rows::of_aspect(mean_edge(&wall), 100.0, 1.25, 10), 6, Cut::Shortest);
    let mesh = &grown.mesh;
    let mut smoother = Smoother::new(mesh).unwrap();
    let is_free = smoother.topology().free().to_vec();
    let before = worst_at_rim(mesh, &is_free, &mesh.points);
    let targets = Targets::keep_shape(smoother.topology(), &mesh.points, 1).unwrap();
    smoother.set_targets(&targets).unwrap();
    let outcome = smoother.run(&Options::default()).block().unwrap();
    let after = worst_at_rim(mesh, &is_free, &outcome.points);
    assert!(after < before, "{before} {after}");
}
