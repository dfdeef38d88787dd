//! Identification of inverted triangles: the minority in each edge-connected part, by exact arithmetic.

use gpu_smooth::{
    Backend, Element, Mesh, MeshError, Metric, Options, Quality, SmoothError, Smoother, Topology,
    smooth, topology::BadTriangle,
};
use support::check;

/// Returns the indices of all bad triangles of a mesh, and the indices of the flat ones.
fn bad(mesh: &Mesh) -> (Vec<usize>, Vec<usize>) {
    let found = Topology::new(mesh).unwrap().bad_triangles(&mesh.points).unwrap();
    let flat = |bad: &&BadTriangle| bad.flat;
    let index = |bad: &BadTriangle| bad.triangle;
    (found.iter().map(index).collect(), found.iter().filter(flat).map(index).collect())
}

/// Checks that exactly the triangles with these vertices are bad, for any numbering and winding of the mesh.
#[track_caller]
fn assert_bad(mesh: &Mesh, wanted: &[[u32; 3]]) {
    let sorted = |mut triangle: [u32; 3]| {
        triangle.sort_unstable();
        triangle
    };
    let clockwise = |t: &[u32; 3]| [t[0], t[2], t[1]];
    let mirrored =
        Mesh { triangles: mesh.triangles.iter().map(clockwise).collect(), ..mesh.clone() };
    let mut meshes = vec![(mesh.clone(), (0..mesh.points.len() as u32).collect::<Vec<u32>>())];
    for seed in 0..4 {
        let (other, new_index) = support::renumbered(&mirrored, seed);
        meshes.push((support::shuffled_windings(&other, seed), new_index));
    }
    for (mesh, new_index) in meshes {
        let mut expected: Vec<_> =
            wanted.iter().map(|t| sorted(t.map(|v| new_index[v as usize]))).collect();
        expected.sort_unstable();
        let mut found: Vec<_> = bad(&mesh).0.iter().map(|&t| sorted(mesh.triangles[t])).collect();
        found.sort_unstable();
        assert_eq!(found, expected);
    }
}

#[test]
fn one_large_mirrored_triangle_does_not_make_all_others_inverted() {
    // Adds a triangle at a boundary edge that overlaps the mesh instead of extending it.
    let mut mesh = support::lattice(10, 8);
    let [a, b] = [0, 1];
    let far = mesh.points.len() as u32;
    mesh.points.push([5.0, 1000.0]);
    mesh.triangles.push([b, a, far]);
    let large = check::orient(check::corners(&mesh, [b, a, far]));
    assert!(large < 0.0 && -large / 2.0 > check::area(&support::lattice(10, 8)));
    assert_bad(&mesh, &[[b, a, far]]);
}

#[test]
fn a_mesh_of_the_globe_has_only_the_triangles_across_the_date_line_inverted() {
    let (columns, rows) = (36, 12);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        let place = |column| [f64::from(column * 10) - 180.0, f64::from(row * 10) - 60.0];
        mesh.points.extend((0..columns).map(place));
    }
    let mut across = Vec::new();
    for row in 0..rows as u32 {
        for column in 0..columns as u32 {
            let next = (column + 1) % columns as u32;
            let at = |row: u32, column: u32| row * columns as u32 + column;
            let [a, b] = [at(row, column), at(row, next)];
            let [c, d] = [at(row + 1, next), at(row + 1, column)];
            // Land has no triangles, so the triangles across the date line have the larger total area.
            if (5..9).contains(&column) && (3..7).contains(&row) {
                continue;
            }
            let both = [[a, b, c], [a, c, d]];
            mesh.triangles.extend(both);
            if next == 0 {
                across.extend(both);
            }
        }
    }
    let signed: f64 = mesh.triangles.iter().map(|&t| check::orient(check::corners(&mesh, t))).sum();
    assert!(signed < 0.0);
    assert_bad(&mesh, &across);
    let quality = Quality::of(&mesh.points, &Topology::new(&mesh).unwrap()).unwrap();
    assert_eq!(quality.inverted, across.len());
    for metric in [Metric::Edge, Metric::Area, Metric::Rms] {
        assert!(quality.f(metric).is_finite(), "{metric}: {}", quality.f(metric));
    }
}

#[test]
fn of_two_triangles_folded_onto_each_other_the_smaller_is_inverted() {
    let mesh = Mesh {
        points: vec![[0.0, 0.0], [1.0, 0.0], [0.5, 3.0], [0.5, 1.0]],
        triangles: vec![[0, 1, 2], [1, 0, 3]],
        ..Mesh::default()
    };
    assert_bad(&mesh, &[[0, 1, 3]]);
}

#[test]
fn each_part_has_its_own_majority() {
    let one = support::lattice(4, 4);
    let mut mesh = one.clone();
    let other = support::transformed(&one, 1.0, [100.0, 0.0]);
    let first = mesh.points.len() as u32;
    mesh.points.extend(other.points);
    mesh.triangles.extend(other.triangles.iter().map(|&[a, b, c]| [a, c, b].map(|v| v + first)));
    assert_bad(&mesh, &[]);
}

/// Makes three triangles around a point, as thin as rounding. Areas computed with rounding have arbitrary signs.
fn thin() -> Mesh {
    Mesh {
        points: vec![
            [0.4, 0.4000000000000001],
            [-0.8, -0.8000000000000002],
            [-1.0, -1.0000000000000002],
            [-0.5, -0.5000000000000001],
        ],
        triangles: vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]],
        ..Mesh::default()
    }
}

/// Returns the sign of a triangle's area in integer arithmetic: all coordinates are multiples of 2^-54.
fn exact_sign(mesh: &Mesh, triangle: [u32; 3]) -> i128 {
    let whole = |x: f64| {
        let scaled = x * 2f64.powi(54);
        assert_eq!(scaled.fract(), 0.0);
        scaled as i128
    };
    let [p, q, r] = check::corners(mesh, triangle).map(|point| point.map(whole));
    ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).signum()
}

#[test]
fn a_valid_mesh_as_thin_as_rounding_is_not_inverted() {
    let mesh = thin();
    let signs: Vec<i128> = mesh.triangles.iter().map(|&t| exact_sign(&mesh, t)).collect();
    assert!(signs.iter().all(|&sign| sign != 0 && sign == signs[0]), "{signs:?}");
    assert_bad(&mesh, &[]);
    let smoother = Smoother::new(&mesh).unwrap();
    let run = |metric: Metric| {
        let options = Options::default().scheme(metric.into()).max_sweeps(5);
        smoother.run(&options).on(&Backend::Cpu).block()
    };
    let outcome = run(Metric::Area).unwrap();
    assert_bad(&Mesh { points: outcome.points, ..mesh.clone() }, &[]);
    // The triangle's rounded area is not positive, so imr cannot judge the triangle. The error names the triangle
    // without calling it inverted.
    let Err(SmoothError::Mesh(MeshError::BeyondPrecision { element, .. })) = run(Metric::Imr)
    else {
        panic!("a mesh without a finite f was smoothed")
    };
    assert!(matches!(element, Element::Triangle(triangle) if triangle < mesh.triangles.len()));
}

#[test]
fn quality_of_a_valid_mesh_as_thin_as_rounding_is_finite() {
    // Next to a large triangle, which alone would determine the orientation if areas were rounded.
    let mut mesh = thin();
    let side = exact_sign(&mesh, mesh.triangles[0]) as f64;
    mesh.points.push([-side, side]);
    mesh.triangles.push([1, 0, 4]);
    assert_bad(&mesh, &[]);
    let quality = Quality::of(&mesh.points, &Topology::new(&mesh).unwrap()).unwrap();
    assert_eq!(quality.inverted, 0);
    assert!(quality.worst_imr > 1e10 && quality.worst_imr.is_finite(), "{quality:?}");
    for &metric in Metric::ALL {
        assert!(quality.f(metric).is_finite() && quality.f(metric) > 0.0, "{metric}: {quality:?}");
    }
    assert!(quality.min_angle >= 0.0 && quality.max_angle <= 180.0, "{quality:?}");
}

#[test]
fn quality_of_the_smallest_and_largest_meshes_is_that_of_any_other() {
    let mesh = support::perturb_random(&support::lattice(6, 6), 0.6, 2);
    let quality = |mesh: &Mesh| Quality::of(&mesh.points, &Topology::new(mesh).unwrap()).unwrap();
    let expected = quality(&mesh);
    for exponent in [-330, -300, -1, 100, 325] {
        let found = quality(&support::transformed(&mesh, 2f64.powi(exponent), [0.0, 0.0]));
        assert_eq!(found, expected, "2^{exponent}");
    }
}

#[test]
fn a_point_that_is_no_number_counts_as_inverted() {
    let mesh = support::lattice(5, 5);
    let topology = Topology::new(&mesh).unwrap();
    let middle = topology.free().iter().position(|&free| free).unwrap();
    for wrong in [f64::NAN, f64::INFINITY] {
        let mut points = mesh.points.clone();
        points[middle][1] = wrong;
        let mut around = topology.star(middle as u32).to_vec();
        around.sort_unstable();
        let quality = Quality::of(&points, &topology).unwrap();
        assert_eq!((quality.inverted, quality.worst_imr), (around.len(), f64::INFINITY));
        assert_eq!(quality.worst, Element::Triangle(around[0] as usize));
        assert!(Metric::ALL.iter().all(|&metric| !quality.f(metric).is_nan()), "{quality:?}");
        let found = topology.bad_triangles(&points).unwrap();
        assert!(found.iter().map(|bad| bad.triangle as u32).eq(around));
        let returned = Smoother::new(&mesh).unwrap().certify(&mut points);
        assert_eq!((returned, points), (Ok(1), mesh.points.clone()));
    }
}

#[test]
fn a_mesh_of_clockwise_triangles_is_smoothed_as_well() {
    // All triangles are clockwise. The result must be as good as that of the counterclockwise mesh.
    let mesh = support::perturb_random(&support::lattice(6, 6), 0.6, 2);
    let clockwise: Vec<_> = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let run = |triangles: &[[u32; 3]]| {
        let points =
            smooth(&mesh.points, triangles, &[], &Options::default(), &Backend::Cpu).unwrap();
        support::f_imr(&Mesh { points, ..mesh.clone() })
    };
    assert!((run(&clockwise) / run(&mesh.triangles) - 1.0).abs() < 1e-5);
}
