//! Brings free vertices that a damaged file puts far outside of the mesh back to means of their neighbors.
//!
//! In a feasible mesh, every free vertex lies within the bounding box of the fixed vertices. The position of a vertex far
//! outside says nothing about the mesh, but costs digits: conjugate gradients solve for means of neighbors to 1e-8 of
//! the distance at which they begin, and squared lengths of 1e72 hide all others in the energy.

use glam::DVec2;

use crate::mesh::Mesh;
use crate::topology::Topology;

/// Distance outside of the bounding box of the fixed vertices, in units of the larger side of the box, from which a
/// vertex is distant. Means of neighbors are exact to 1e-5 of the box from smaller distances.
const DISTANT: f64 = 1e3;

/// Number of passes that move each distant vertex to the mean of its neighbors.
const PASSES: usize = 20;

/// Lists the free vertices far outside of the bounding box of the fixed vertices, in ascending order.
pub(super) fn distant_vertices(mesh: &Mesh, topology: &Topology<'_>) -> Vec<u32> {
    let free = topology.free();
    let point = |v: u32| DVec2::from(mesh.points[v as usize]);
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for &v in topology.corners().as_flattened().iter().filter(|&&v| !free[v as usize]) {
        (low, high) = (low.min(point(v)), high.max(point(v)));
    }
    if low.x > high.x {
        // Without fixed vertices, no position is far outside.
        return Vec::new();
    }
    let reach = DISTANT * (high - low).max_element();
    let is_distant = |v: &u32| {
        let outside = (low - point(*v)).max(point(*v) - high).max_element();
        free[*v as usize] && outside > reach
    };
    (0..mesh.points.len() as u32).filter(is_distant).collect()
}

/// Returns the mesh with the `distant` vertices at means of their neighbors. The vertices are placed layer by layer, from
/// the neighbors at known positions, and [`PASSES`] passes then bring them nearer to the means of all neighbors.
pub(super) fn brought_back(mesh: &Mesh, topology: &Topology<'_>, distant: &[u32]) -> Mesh {
    let mut mesh = mesh.clone();
    let mut is_known = vec![true; mesh.points.len()];
    distant.iter().for_each(|&v| is_known[v as usize] = false);
    let mean = |points: &[[f64; 2]], v: u32, is_known: &[bool]| {
        let known = topology.ring_of(v).filter(|&k| is_known[k as usize]);
        let (sum, count) = known.fold((DVec2::ZERO, 0.0), |(sum, count), k| {
            (sum + DVec2::from(points[k as usize]), count + 1.0)
        });
        (count > 0.0).then(|| (sum / count).to_array())
    };
    let mut placed: Vec<u32> = Vec::with_capacity(distant.len());
    let mut next = distant.to_vec();
    while !next.is_empty() {
        let found: Vec<(u32, [f64; 2])> =
            next.iter().filter_map(|&v| Some((v, mean(&mesh.points, v, &is_known)?))).collect();
        let first = placed.len();
        for (v, point) in found {
            mesh.points[v as usize] = point;
            is_known[v as usize] = true;
            placed.push(v);
        }
        // Only neighbors of the vertices that were just placed can be placed next.
        let around = placed[first..].iter().flat_map(|&v| topology.ring_of(v));
        next = around.filter(|&k| !is_known[k as usize]).collect();
        next.sort_unstable();
        next.dedup();
    }
    for _ in 0..PASSES {
        for &v in &placed {
            if let Some(point) = mean(&mesh.points, v, &is_known) {
                mesh.points[v as usize] = point;
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a fan of four triangles around the vertex 4.
    fn fan(center: [f64; 2]) -> Mesh {
        Mesh {
            points: vec![[1e6, 0.0], [1e6 + 2.0, 0.0], [1e6 + 2.0, 2.0], [1e6, 2.0], center],
            triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
            ..Mesh::default()
        }
    }

    #[test]
    fn only_free_vertices_a_thousand_boxes_outside_are_distant() {
        for (center, expected) in [
            ([1e6 + 1.0, 1.0], vec![]),
            ([1e6 - 2000.0, 2002.0], vec![]),
            ([1e6 + 2003.0, 0.0], vec![4]),
            ([1e6, -2001.0], vec![4]),
            ([9.97e36, 9.97e36], vec![4]),
        ] {
            let mut mesh = fan(center);
            let topology = Topology::by_area(&mesh).unwrap();
            assert_eq!(distant_vertices(&mesh, &topology), expected, "{center:?}");
            mesh.fixed = vec![4];
            let topology = Topology::by_area(&mesh).unwrap();
            assert!(distant_vertices(&mesh, &topology).is_empty(), "{center:?} fixed");
        }
    }

    #[test]
    fn a_distant_vertex_returns_to_the_mean_of_its_neighbors() {
        let mesh = fan([9.97e36, 0.0]);
        let topology = Topology::by_area(&mesh).unwrap();
        let back = brought_back(&mesh, &topology, &[4]);
        assert_eq!(back, Mesh { points: back.points.clone(), ..mesh.clone() });
        assert_eq!(back.points[4], [1e6 + 1.0, 1.0]);
        assert_eq!(back.points[..4], mesh.points[..4]);
    }
}
