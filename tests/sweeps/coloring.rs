//! Colors: vertices of equal color can move at the same time.

use crate::{distorted, perturbed};
use gpu_smooth::{
    Mesh, Topology,
    internal::{Coloring, Problem, UNCOLORED},
};

fn meshes() -> Vec<Mesh> {
    let plain = [
        perturbed().clone(),
        distorted().clone(),
        support::lattice(20, 13),
        support::graded(16, 1e-3),
    ];
    let renumbered = plain.iter().zip(1..).map(|(mesh, seed)| support::renumbered(mesh, seed).0);
    let mut meshes: Vec<Mesh> = renumbered.collect();
    meshes.extend(plain.iter().zip(1..).map(|(m, seed)| support::shuffled_windings(m, seed)));
    meshes.extend(plain);
    meshes
}

#[test]
fn neighbors_never_share_a_color_and_six_colors_do() {
    for (i, mesh) in meshes().iter().enumerate() {
        let topology = Topology::new(mesh).unwrap();
        let coloring = Coloring::new(&topology);
        let held = support::check::held(mesh);
        for (v, (&color, held)) in coloring.colors().iter().zip(held).enumerate() {
            assert_eq!(color == UNCOLORED, held, "mesh {i}, vertex {v}");
        }
        for edge in support::edge_uses(mesh).keys() {
            let [a, b] = edge.map(|v| coloring.colors()[v as usize]);
            assert!(a != b || a == UNCOLORED, "mesh {i}: {edge:?} both have color {a}");
        }
        // A planar graph always has a vertex with at most five remaining neighbors, so six colors
        // suffice.
        assert!(coloring.count() <= 6, "mesh {i}: {} colors", coloring.count());
        assert!(coloring.is_proper(&topology));
    }
}

#[test]
fn every_free_vertex_is_swept_once_and_reads_its_whole_ring() {
    for (i, mesh) in meshes().iter().enumerate() {
        let topology = Topology::new(mesh).unwrap();
        let coloring = Coloring::new(&topology);
        let problem = Problem::new(mesh, &topology, &coloring);
        let mut next = 0;
        for range in problem.colors() {
            assert!(range.start == next && range.end > next, "mesh {i}: {:?}", problem.colors());
            next = range.end;
        }
        assert_eq!(next as usize, problem.free_count());
        assert_eq!(problem.free_count(), support::mover_count(mesh));

        // Counts the triangles at free vertices, both from the one-rings and from the list of
        // triangles.
        let mut from_rings = Vec::new();
        for (v, bounds) in problem.ring_start().windows(2).enumerate() {
            let ring = &problem.ring()[bounds[0] as usize..bounds[1] as usize];
            let next = ring.iter().skip(1).chain(ring.first());
            from_rings.extend(ring.iter().zip(next).map(|(&a, &b)| [v as u32, a, b]));
        }
        let free = problem.free_count() as u32;
        let mut from_list: Vec<[u32; 3]> = problem
            .triangles()
            .iter()
            .flat_map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]])
            .filter(|t| t[0] < free)
            .collect();
        from_rings.sort_unstable();
        from_list.sort_unstable();
        assert_eq!(from_rings, from_list, "mesh {i}");
    }
}
