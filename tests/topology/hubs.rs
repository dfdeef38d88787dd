//! Vertices with very many triangles. No test measures time: work quadratic in the number of triangles would take
//! minutes to hours.

use crate::boundary::assert_loops_are_the_boundary;
use gpu_smooth::{
    Mesh, Topology,
    internal::{Coloring, prepare},
};
use support::trig;

/// Number of triangles around the hub.
const MANY: u32 = 200_000;

/// Makes a fan of triangles around the first vertex, surrounded by a strip of triangles. The hub of an open fan is a
/// boundary vertex.
fn fan(count: u32, is_closed: bool) -> Mesh {
    let mut mesh = Mesh { points: vec![[0.0, 0.0]], ..Mesh::default() };
    let rim = if is_closed { count } else { count + 1 };
    let turns = if is_closed { 1.0 } else { 0.5 };
    for radius in [1.0, 1.5] {
        for i in 0..rim {
            let [cos, sin] = trig::on_circle(turns * f64::from(i) / f64::from(count));
            mesh.points.push([radius * cos, radius * sin]);
        }
    }
    for i in 0..count {
        let next = (i + 1) % rim;
        let [a, b] = [1 + i, 1 + next];
        let [c, d] = [b + rim, a + rim];
        mesh.triangles.extend([[0, a, b], [b, a, d], [b, d, c]]);
    }
    mesh
}

#[test]
fn a_hub_inside_takes_no_more_than_its_triangles_are_worth() {
    let mesh = fan(MANY, true);
    // Once as generated, once with shuffled windings, which must be made consistent from neighbor to neighbor.
    for mesh in [mesh.clone(), support::shuffled_windings(&mesh, 1)] {
        let (topology, problem) = prepare(&mesh).unwrap();
        assert!(topology.free()[..=MANY as usize].iter().all(|&free| free));
        assert_eq!(
            (topology.free_count(), problem.free_count()),
            (MANY as usize + 1, MANY as usize + 1)
        );
        assert_eq!(topology.ring(0), (1..=MANY).collect::<Vec<u32>>());
        assert_eq!(topology.star(0).len(), MANY as usize);
        let coloring = Coloring::new(&topology);
        assert!(coloring.is_proper(&topology) && coloring.count() <= 4);
        let loops = topology.boundary_loops();
        assert!(loops.len() == 1 && loops[0].iter().copied().eq(MANY + 1..=2 * MANY));
    }
}

#[test]
fn a_hub_on_the_boundary_takes_no_more_than_its_triangles_are_worth() {
    let mesh = fan(MANY, false);
    for mesh in [mesh.clone(), support::shuffled_windings(&mesh, 1)] {
        let (topology, problem) = prepare(&mesh).unwrap();
        assert!(!topology.free()[0] && topology.ring(0).is_empty());
        assert_eq!(
            (topology.star(0).len(), problem.free_count()),
            (MANY as usize, MANY as usize - 1)
        );
        assert!(Coloring::new(&topology).is_proper(&topology));
        let loops = topology.boundary_loops();
        let rim = MANY + 1;
        // The loop leads from the hub along one side, around the rim, and back along the other side.
        let outside = [0, 1].into_iter().chain(1 + rim..=2 * rim).chain([rim]);
        assert!(loops.len() == 1 && loops[0].iter().copied().eq(outside));
    }
}

#[test]
fn a_hub_of_fans_that_touch_nowhere_else_takes_no_more_than_its_triangles_are_worth() {
    // Every second triangle of a fan, each a component with a loop of its own.
    let whole = fan(MANY, true);
    let triangles = whole.triangles.iter().step_by(6).copied().collect();
    let mesh = Mesh { triangles, ..whole };
    let topology = Topology::new(&support::shuffled_windings(&mesh, 1)).unwrap().into_owned();
    assert_eq!((topology.free_count(), topology.star(0).len()), (0, MANY as usize / 2));
    let loops = topology.boundary_loops();
    assert_eq!(loops.len(), MANY as usize / 2);
    assert!(loops.iter().zip((1..).step_by(2)).all(|(found, a)| *found == [0, a, a + 1]));
}

#[test]
fn small_hubs_have_the_boundary_that_all_meshes_have() {
    for count in [3, 7, 8, 9, 10, 40] {
        for is_closed in [true, false] {
            let mesh = fan(count, is_closed);
            assert_loops_are_the_boundary(&mesh);
            assert_loops_are_the_boundary(&support::shuffled_windings(&mesh, 1));
            let topology = Topology::new(&mesh).unwrap();
            assert_eq!(topology.free()[0], is_closed);
            assert_eq!(topology.bad_triangles(&mesh.points), Ok(vec![]));
        }
    }
}

#[test]
fn a_strip_turned_once_has_loops_that_end() {
    // A Möbius strip: consistent windings do not exist, and walks around vertices must end.
    let count = 9;
    let points = (0..2 * count).map(|i| [f64::from(i), f64::from(i * i % 7)]).collect();
    let mut triangles = Vec::new();
    for i in 0..count {
        let [a, b] = [2 * i, 2 * i + 1];
        let [c, d] = if i + 1 == count { [1, 0] } else { [2 * i + 2, 2 * i + 3] };
        triangles.extend([[a, c, b], [b, c, d]]);
    }
    let mesh = Mesh { points, triangles, ..Mesh::default() };
    let topology = Topology::new(&mesh).unwrap();
    assert_eq!(topology.boundary_edges().len(), 2 * count as usize);
    let on_loops: usize = topology.boundary_loops().iter().map(Vec::len).sum();
    assert!(on_loops <= 2 * count as usize);
}
