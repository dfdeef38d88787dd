//! The certificate that no triangle is inverted or flat.

use crate::topology::Topology;
use crate::topology::predicates::{infeasible, orientation};

/// Makes `points` feasible as they stand, in place: each free vertex of an inverted or flat triangle
/// goes back to where it was in `before`, until no such triangle is left. Returns how many
/// vertices went back.
///
/// This is the certificate: afterwards every triangle of `topology` is positive by exact
/// arithmetic on these values, provided `before` was so.
pub fn certify(topology: &Topology<'_>, before: &[[f64; 2]], points: &mut [[f64; 2]]) -> usize {
    let triangles = topology.triangles();
    let mut suspects = infeasible(points, triangles);
    let mut returned = 0;
    // Each round returns at least one vertex of every suspect (an infeasible triangle has a moved
    // vertex, as `before` was feasible), and then looks again at the triangles around it.
    while !suspects.is_empty() {
        let mut touched = Vec::new();
        for &t in &suspects {
            for &v in &triangles[t as usize] {
                let v_index = v as usize;
                if points[v_index] != before[v_index] {
                    points[v_index] = before[v_index];
                    returned += 1;
                    touched.extend_from_slice(topology.star(v));
                }
            }
        }
        touched.sort_unstable();
        touched.dedup();
        touched.retain(|&t| orientation(points, &triangles[t as usize]) <= 0.0);
        suspects = touched;
    }
    returned
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    #[test]
    fn an_inverting_vertex_goes_back_and_others_stay() {
        // A strip of two squares' fans; one center is thrown outside, the other moved properly.
        let mesh = Mesh {
            points: vec![
                [0.0, 0.0],
                [1.0, 0.0],
                [2.0, 0.0],
                [0.0, 1.0],
                [1.0, 1.0],
                [2.0, 1.0],
                [0.5, 0.5],
                [1.5, 0.5],
            ],
            triangles: vec![
                [0, 1, 6],
                [1, 4, 6],
                [4, 3, 6],
                [3, 0, 6],
                [1, 2, 7],
                [2, 5, 7],
                [5, 4, 7],
                [4, 1, 7],
            ],
            fixed: vec![],
        };
        let topology = Topology::new(&mesh).unwrap();
        let mut points = mesh.points.clone();
        points[6] = [0.5, -0.1];
        points[7] = [1.4, 0.4];
        assert_eq!(certify(&topology, &mesh.points, &mut points), 1);
        assert_eq!(points[6], [0.5, 0.5]);
        assert_eq!(points[7], [1.4, 0.4]);
    }
}
