use super::*;

/// A square with two regions and a vertex in the middle.
fn square() -> Domain {
    let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.4, 0.5]];
    let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    Domain::of_mesh(mesh, vec![[1, 2]], &[1, 1, 2, 2])
}

#[test]
fn vertices_that_are_fixed_by_hand_are_not_between_regions() {
    assert_eq!(
        (&square().mesh().fixed[..], square().interface_vertices()),
        (&[1, 2, 4][..], &[4][..])
    );
    for free_first in [false, true] {
        let mut domain = square();
        if free_first {
            domain.free_interfaces();
        }
        domain.fix(&[4, 0, 4]).unwrap();
        assert_eq!(domain.mesh().fixed, [1, 2, 0, 4]);
        assert!(domain.interface_vertices().is_empty());
        domain.free_interfaces();
        assert_eq!(domain.mesh().fixed, [1, 2, 0, 4]);
    }
    let mut domain = square();
    domain.fix(&[1]).unwrap();
    domain.fix_all_but(&[0, 4]).unwrap();
    assert_eq!(
        (&domain.mesh().fixed[..], domain.interface_vertices()),
        (&[1, 2, 3, 4][..], &[4][..])
    );
    domain.free_interfaces();
    assert_eq!(domain.mesh().fixed, [1, 2, 3]);
    assert!(domain.fix(&[0, 5]).is_err() && domain.fix_all_but(&[5]).is_err());
    assert_eq!(domain.mesh().fixed, [1, 2, 3]);
}

#[test]
fn freed_lines_leave_vertices_fixed_that_are_fixed_for_another_reason() {
    // The line from 1 to 2 is on the boundary, that from 4 to 2 also between the regions.
    let mesh = Mesh { fixed: Vec::new(), ..square().mesh().clone() };
    let domain = Domain::of_mesh(mesh, vec![[1, 2], [4, 2]], &[1, 1, 2, 2]);
    assert!(domain.interface_vertices().is_empty() && domain.holds_lines());
    for interfaces_first in [false, true] {
        let mut domain = domain.clone();
        domain.fix(&[2]).unwrap();
        if interfaces_first {
            domain.free_interfaces();
        }
        domain.free_lines();
        let between: &[u32] = if interfaces_first { &[] } else { &[4] };
        assert_eq!(domain.interface_vertices(), between);
        assert_eq!(domain.mesh().fixed, [&[2], between].concat());
        domain.free_interfaces();
        assert_eq!(domain.mesh().fixed, [2]);
        assert!(domain.lines().is_empty() && !domain.holds_lines());
    }
}

#[test]
fn vertices_between_regions_of_quadrilaterals_and_triangles_are_fixed() {
    // Three quadrilaterals and two triangles around vertex 4, in rows of three vertices.
    let points = (0..9).map(|v| [f64::from(v % 3), f64::from(v / 3)]).collect();
    let quadrilaterals = vec![[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6]];
    let mesh =
        Mesh { points, triangles: vec![[4, 5, 8], [4, 8, 7]], quadrilaterals, fixed: vec![0] };
    let domain = |regions: &[i64]| Domain::of_mesh(mesh.clone(), Vec::new(), regions);
    assert_eq!(domain(&[]).mesh().fixed, [0]);
    assert_eq!(domain(&[]).anchored(), [0]);
    let upper = domain(&[2, 2, 1, 1, 2]);
    assert_eq!((upper.interface_vertices(), &upper.mesh().fixed[..]), (&[4][..], &[0, 4][..]));
    assert_eq!(upper.lines(), [[3, 4], [4, 5]]);
    assert_eq!(upper.mesh().quadrilaterals, mesh.quadrilaterals);
}

/// Quadrilaterals at the cut kept the vertices on its other side, and were found concave.
#[test]
fn quadrilaterals_that_close_around_the_globe_are_cut() {
    let (across, up) = (36_u32, 4);
    let point = |v| [10.0 * f64::from(v % across) - 180.0, 10.0 * f64::from(v / across)];
    let cell = |k| {
        let (row, column) = (k / across * across, k % across);
        let next = (column + 1) % across;
        [row + column, row + next, row + across + next, row + across + column]
    };
    let mesh = Mesh {
        points: (0..across * (up + 1)).map(point).collect(),
        quadrilaterals: (0..across * up).map(cell).collect(),
        ..Mesh::default()
    };
    let mut domain = Domain::of_mesh(mesh, Vec::new(), &[]);
    domain.lay_out_on_sphere(Precision::Double).unwrap();
    let mesh = domain.mesh();
    assert_eq!(mesh.points.len() as u32, (across + 1) * (up + 1));
    let topology = Topology::new(mesh).unwrap();
    assert_eq!(topology.bad_quadrilaterals(&mesh.points).unwrap(), []);
    assert_eq!(topology.free_count() as u32, (across - 1) * (up - 1));
}

#[test]
fn the_boundary_of_a_periodic_model_without_pairs_stays() {
    let mut domain = square();
    domain.has_unread_pairs = true;
    let mesh = domain.mesh().clone();
    let topology = Topology::new(&mesh).unwrap();
    let curves = domain.curves(&mesh.points, &topology, &SlideBy::default());
    assert!(curves.has_lost_pairs && curves.slide.held.len() == 8);
    domain.pair(vec![[0, 1], [3, 2]]);
    let by = SlideBy { ends: vec![3], ..SlideBy::default() };
    let curves = domain.curves(&mesh.points, &topology, &by);
    assert!(!curves.has_lost_pairs && curves.slide.held == [3]);
    let by = SlideBy { sides: vec![[vec![0, 3], vec![1, 2]], [vec![0, 3], vec![4]]], ..by };
    assert_eq!(domain.curves(&mesh.points, &topology, &by).unlike_sides, Some(1));
}
