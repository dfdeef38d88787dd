//! Makes a mesh feasible by exact predicates, after its vertices have been moved and rounded.

use crate::error::MeshError;
use crate::parallel::pace::now;
use crate::topology::Topology;
use crate::topology::predicates::{is_positive, not_positive};

/// Makes `points` feasible, in place: sets each vertex of an inverted or flat corner back to its position in
/// `before`, until no such corner is left. Returns the number of vertices set back.
///
/// Afterwards every triangle of `topology` is counter-clockwise, and every quadrilateral convex and counter-clockwise, by
/// exact arithmetic on the values in `points`. A corner with a coordinate that is not finite counts as inverted.
///
/// # Errors
/// [`MeshError::PointCount`] if `before` or `points` does not have one entry per vertex; no vertex is then moved.
/// [`MeshError::Infeasible`] if some corner is inverted or flat in `before`, and remains inverted or flat when its
/// vertices are set back.
pub fn certify(
    topology: &Topology<'_>,
    before: &[[f64; 2]],
    points: &mut [[f64; 2]],
) -> Result<usize, MeshError> {
    now(certified(topology, before, points))
}

/// Does the work of [`certify`], with pauses.
pub(crate) async fn certified(
    topology: &Topology<'_>,
    before: &[[f64; 2]],
    points: &mut [[f64; 2]],
) -> Result<usize, MeshError> {
    topology.check_count(before)?;
    topology.check_count(points)?;
    let corners = topology.corners();
    let mut suspects = not_positive(points, corners).await;
    let is_certified = suspects.is_empty();
    let mut returned = 0;
    // Each round sets back the moved vertices of every suspect, and then tests the corners with these vertices.
    while !suspects.is_empty() {
        let mut touched = Vec::new();
        for &t in &suspects {
            for &v in &corners[t as usize] {
                let v_index = v as usize;
                // Coordinates are compared by bits: NaN differs from NaN by value, and the vertex would be set back
                // forever.
                if points[v_index].map(f64::to_bits) != before[v_index].map(f64::to_bits) {
                    points[v_index] = before[v_index];
                    returned += 1;
                    touched.extend(topology.corners_with(v));
                }
            }
        }
        touched.sort_unstable();
        touched.dedup();
        touched.retain(|&t| !is_positive(points, &corners[t as usize]));
        suspects = touched;
    }
    if is_certified {
        return Ok(0);
    }
    match topology.infeasible(points).await {
        None => Ok(returned),
        Some(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    #[test]
    fn an_inverting_vertex_goes_back_and_others_stay() {
        // Two squares with their centers. The first center is moved out of its square, the second stays inside.
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
            ..Mesh::default()
        };
        let topology = Topology::new(&mesh).unwrap();
        let mut points = mesh.points.clone();
        points[6] = [0.5, -0.1];
        points[7] = [1.4, 0.4];
        assert_eq!(certify(&topology, &mesh.points, &mut points), Ok(1));
        assert_eq!(points[6], [0.5, 0.5]);
        assert_eq!(points[7], [1.4, 0.4]);

        for bad in [f64::NAN, f64::INFINITY] {
            points[7] = [1.4, bad];
            assert_eq!(certify(&topology, &mesh.points, &mut points), Ok(1));
            assert_eq!(points, mesh.points);
        }
    }

    #[test]
    fn a_mesh_that_was_infeasible_before_is_not_certified() {
        let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = Mesh { points, triangles, ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        for (bad, count) in [([1.5, 0.5], 1), ([f64::NAN, 0.5], 4)] {
            let mut before = mesh.points.clone();
            before[4] = bad;
            let mut points = before.clone();
            points[4] = [2.5, 0.5];
            let error = certify(&topology, &before, &mut points).unwrap_err();
            let MeshError::Infeasible { triangles, .. } = error else { panic!("{error}") };
            assert_eq!(triangles.len(), count);
        }
    }

    #[test]
    fn lists_of_points_of_another_length_are_errors() {
        let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let mesh = Mesh { points, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let topology = Topology::new(&mesh).unwrap();
        let mut points = mesh.points.clone();
        for given in [0, 2] {
            let expected = Err(MeshError::PointCount { expected: 3, given });
            assert_eq!(certify(&topology, &mesh.points[..given], &mut points), expected);
            assert_eq!(certify(&topology, &mesh.points, &mut points[..given]), expected);
        }
    }
}
