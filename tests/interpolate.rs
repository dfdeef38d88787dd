//! Interpolated vertex data, compared with a search through all triangles and with linear functions.

use gpu_smooth::{Mesh, MeshError, Topology, interpolate::Interpolation};
use support::{SplitMix64, lattice, quadrilaterals};

fn twice_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Returns the linear interpolation in the first triangle that contains `place` up to rounding; `None` outside of
/// the mesh.
fn by_search(mesh: &Mesh, values: &[f64], place: [f64; 2]) -> Option<f64> {
    mesh.triangles.iter().find_map(|corners| {
        let [a, b, c] = corners.map(|v| mesh.points[v as usize]);
        let all = twice_area([a, b, c]);
        let parts = [[place, b, c], [a, place, c], [a, b, place]].map(|t| twice_area(t) / all);
        let value = || parts.iter().zip(corners).map(|(part, &v)| part * values[v as usize]).sum();
        parts.iter().all(|&part| part > -1e-12).then(value)
    })
}

/// Makes a lattice with a slot, so that a straight line between two inner points may leave the mesh.
fn slotted(nx: usize, ny: usize) -> Mesh {
    let mut mesh = lattice(nx, ny);
    let points = &mesh.points;
    let in_slot = |t: &[u32; 3]| {
        let x = t.iter().map(|&v| points[v as usize][0]).sum::<f64>() / 3.0;
        let y = t.iter().map(|&v| points[v as usize][1]).sum::<f64>() / 3.0;
        (x - nx as f64 / 2.0).abs() < 1.0 && y < ny as f64 - 2.0
    };
    mesh.triangles.retain(|t| !in_slot(t));
    mesh
}

#[test]
fn interpolated_values_are_linear_in_the_triangle_around_the_point() {
    let mut rng = SplitMix64::new(3);
    for (mesh, reach) in [(lattice(12, 9), 0.8), (lattice(12, 9), 20.0), (slotted(14, 8), 9.0)] {
        let topology = Topology::new(&mesh).unwrap();
        let values: Vec<f64> = mesh.points.iter().map(|_| rng.range(-5.0, 5.0)).collect();
        let linear: Vec<f64> = mesh.points.iter().map(|[x, y]| 2.0 * x - 3.0 * y + 0.5).collect();
        let pairs: Vec<f64> = values.iter().zip(&linear).flat_map(|(&a, &b)| [a, b]).collect();
        let (mut inside, mut outside) = (0, 0);
        for _ in 0..10 {
            let new: Vec<[f64; 2]> = mesh
                .points
                .iter()
                .zip(topology.free())
                .map(|(point, free)| match free {
                    true => point.map(|x| x + rng.range(-reach, reach)),
                    false => *point,
                })
                .collect();
            let interpolation = Interpolation::new(&topology, &mesh.points, &new).unwrap();
            assert_eq!(interpolation.moved(), topology.free_count());
            let found = interpolation.apply(&values, 1).unwrap();
            let both = interpolation.apply(&pairs, 2).unwrap();
            for (v, &place) in new.iter().enumerate() {
                assert_eq!(both[2 * v].to_bits(), found[v].to_bits());
                if place == mesh.points[v] {
                    assert_eq!(found[v].to_bits(), values[v].to_bits());
                    continue;
                }
                match by_search(&mesh, &values, place) {
                    Some(value) => {
                        assert!((found[v] - value).abs() < 1e-10, "{} is not {value}", found[v]);
                        let exact = 2.0 * place[0] - 3.0 * place[1] + 0.5;
                        assert!((both[2 * v + 1] - exact).abs() < 1e-12 * 50.0);
                        inside += 1;
                    }
                    None => {
                        assert!((-5.0..=5.0).contains(&found[v]));
                        outside += 1;
                    }
                }
            }
        }
        assert!(inside > 40 && (reach < 1.0 || outside > 50), "{inside} and {outside}");
    }
}

/// Returns the boundary point nearest to `place`.
fn nearest(mesh: &Mesh, topology: &Topology<'_>, place: [f64; 2]) -> [f64; 2] {
    let on_edge = |edge: &[u32; 2]| {
        let [a, b] = edge.map(|vertex| mesh.points[vertex as usize]);
        let d = [b[0] - a[0], b[1] - a[1]];
        let along = (place[0] - a[0]) * d[0] + (place[1] - a[1]) * d[1];
        let along = (along / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        [a[0] + along * d[0], a[1] + along * d[1]]
    };
    let distance = |point: &[f64; 2]| (point[0] - place[0]).hypot(point[1] - place[1]);
    let edges = topology.boundary_edges();
    edges.iter().map(on_edge).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
}

/// Positions outside of the mesh receive the value of the mesh's nearest point.
#[test]
fn a_point_outside_the_mesh_takes_the_value_of_the_nearest_point() {
    let mesh = lattice(8, 8);
    let topology = Topology::new(&mesh).unwrap();
    let value = |[x, y]: [f64; 2]| x + 100.0 * y;
    let values: Vec<f64> = mesh.points.iter().map(|&point| value(point)).collect();
    let vertex = topology.free().iter().position(|&free| free).unwrap();
    for place in [[3.25, -2.0], [-4.0, -1.0], [10.0, 12.0], [9.75, 2.5], [2.125, 9.0]] {
        let mut new = mesh.points.clone();
        new[vertex] = place;
        let interpolation = Interpolation::new(&topology, &mesh.points, &new).unwrap();
        let found = interpolation.apply(&values, 1).unwrap()[vertex];
        let expected = value(nearest(&mesh, &topology, place));
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected} at {place:?}");
    }
}

#[test]
fn equal_values_stay_equal_and_none_leaves_the_old_range() {
    let mut rng = SplitMix64::new(5);
    let mesh = lattice(10, 10);
    let topology = Topology::new(&mesh).unwrap();
    let new: Vec<[f64; 2]> =
        mesh.points.iter().map(|p| p.map(|x| x + rng.range(-0.5, 0.5))).collect();
    let interpolation = Interpolation::new(&topology, &mesh.points, &new).unwrap();
    let count = mesh.points.len();
    for value in [0.1, -1e308, f64::MIN_POSITIVE] {
        assert_eq!(interpolation.apply(&vec![value; count], 1).unwrap(), vec![value; count]);
    }
    let steep: Vec<f64> =
        (0..count).map(|i| if i % 2 == 0 { f64::MAX } else { -f64::MAX }).collect();
    assert!(interpolation.apply(&steep, 1).unwrap().iter().all(|value| value.is_finite()));
    let mut unknown = vec![1.0; count];
    unknown[60] = f64::NAN;
    let found = interpolation.apply(&unknown, 1).unwrap();
    assert!(found.iter().all(|x| x.is_nan() || *x == 1.0) && found.iter().any(|x| x.is_nan()));
}

#[test]
fn points_that_are_missing_or_not_finite_are_refused() {
    let mesh = lattice(3, 3);
    let topology = Topology::new(&mesh).unwrap();
    let (old, mut new) = (&mesh.points, mesh.points.clone());
    assert!(matches!(
        Interpolation::new(&topology, old, &new[1..]),
        Err(MeshError::PointCount { .. })
    ));
    new[5] = [f64::NAN, 0.0];
    assert_eq!(
        Interpolation::new(&topology, old, &new).unwrap_err(),
        MeshError::NotFinite { vertex: 5 }
    );
    let mut folded = old.clone();
    folded[5] = [30.0, 30.0];
    assert!(matches!(
        Interpolation::new(&topology, &folded, old),
        Err(MeshError::Infeasible { .. })
    ));
    let none = Interpolation::new(&topology, old, old).unwrap();
    assert_eq!(none.moved(), 0);
    let error = none.apply(&[0.0; 7], 2).unwrap_err();
    assert_eq!(error, MeshError::ValueCount { expected: 32, given: 7 });
    assert_eq!(error.to_string(), "7 numbers are given where the vertices of the mesh need 32");
}

#[test]
fn values_in_quadrilaterals_are_bilinear() {
    let mut rng = SplitMix64::new(9);
    let meshes = [quadrilaterals::squares(9), quadrilaterals::mixed(9)];
    for (mesh, is_product) in meshes.into_iter().zip([true, false]) {
        for disturbed in [false, true] {
            let mesh =
                if disturbed { quadrilaterals::perturbed(&mesh, 0.25) } else { mesh.clone() };
            let topology = Topology::new(&mesh).unwrap();
            let free = topology.free();
            let moved = |(point, free): (&[f64; 2], &bool)| match free {
                true => point.map(|x| x + rng.range(-0.7, 0.7)),
                false => *point,
            };
            let new: Vec<[f64; 2]> = mesh.points.iter().zip(free).map(moved).collect();
            let interpolation = Interpolation::new(&topology, &mesh.points, &new).unwrap();
            assert_eq!(interpolation.moved(), topology.free_count());
            let linear = |[x, y]: [f64; 2]| 2.0 * x - 3.0 * y + 0.5;
            let product = |[x, y]: [f64; 2]| x * y + x;
            let of = |function: &dyn Fn([f64; 2]) -> f64| {
                let values: Vec<f64> = mesh.points.iter().map(|&point| function(point)).collect();
                let found = interpolation.apply(&values, 1).unwrap();
                let off = found.iter().zip(&new).map(|(found, &place)| found - function(place));
                off.map(f64::abs).fold(0.0, f64::max)
            };
            assert!(of(&linear) < 1e-12, "{}", of(&linear));
            // A product of coordinates is bilinear in cells parallel to the axes.
            assert_eq!(of(&product) < 1e-12, is_product && !disturbed, "{}", of(&product));
        }
    }
}

#[test]
fn a_concave_quadrilateral_has_no_interpolation() {
    let mesh = quadrilaterals::squares(3);
    let mut old = mesh.points.clone();
    old[5] = [1.7, 1.6];
    let topology = Topology::new(&mesh).unwrap();
    let refused = Interpolation::new(&topology, &old, &mesh.points).unwrap_err();
    assert!(
        matches!(refused, MeshError::Infeasible { quadrilaterals, .. } if quadrilaterals.len() == 1)
    );
}
