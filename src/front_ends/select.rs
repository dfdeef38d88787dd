//! Selection of vertices and triangles by position and quality, to choose which vertices move or are held.
//!
//! ```
//! use gpu_smooth::{Mesh, Topology, front_ends::select};
//!
//! let mesh = Mesh {
//!     points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.9, 0.5]],
//!     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
//!     fixed: vec![],
//!     ..Mesh::default()
//! };
//! let topology = Topology::new(&mesh)?;
//! let bad = select::corners_above(&mesh.points, &topology, 3.0);
//! assert_eq!(bad, [1]);
//! assert_eq!(select::vertices_near(&topology, &bad, 0), [1, 2, 4]);
//! assert_eq!(select::vertices_near(&topology, &bad, 1), [0, 1, 2, 3, 4]);
//! # Ok::<(), gpu_smooth::MeshError>(())
//! ```

use crate::mesh::Element;
use crate::metric::{Corner, Ideal};
use crate::topology::Topology;

/// Returns the [corners](Topology::corners) with an inverse mean ratio above `limit`, ascending: triangles, and corners of
/// quadrilaterals. The inverse mean ratio is 1 for an equilateral triangle and for a corner of a square, and infinite for a
/// corner that is flat or inverted or has a coordinate that is not finite.
///
/// The ratio is also infinite if `points` lacks a vertex of the corner.
pub fn corners_above(points: &[[f64; 2]], topology: &Topology<'_>, limit: f64) -> Vec<u32> {
    let corners = 0..topology.corners().len() as u32;
    corners.filter(|&corner| inverse_mean_ratio(points, topology, corner) > limit).collect()
}

/// Returns the largest inverse mean ratio of a triangle or of a corner of a quadrilateral, 1 at best.
pub fn worst(points: &[[f64; 2]], topology: &Topology<'_>) -> f64 {
    let corners = 0..topology.corners().len() as u32;
    corners.map(|corner| inverse_mean_ratio(points, topology, corner)).fold(1.0, f64::max)
}

fn inverse_mean_ratio(points: &[[f64; 2]], topology: &Topology<'_>, corner: u32) -> f64 {
    let corners = topology.corners()[corner as usize];
    let [Some(p), Some(q), Some(r)] = corners.map(|vertex| points.get(vertex as usize)) else {
        return f64::INFINITY;
    };
    let to = |end: &[f64; 2]| [end[0] - p[0], end[1] - p[1]];
    let corner_of_triangle = Corner { a: to(q), b: to(r), ideal: Ideal::of_area(1.0) };
    let ratio = match topology.element(corner) {
        Element::Triangle(_) => corner_of_triangle.inverse_mean_ratio(),
        Element::Quadrilateral(_) => corner_of_triangle.of_right_angle().inverse_mean_ratio(),
    };
    if ratio.is_nan() { f64::INFINITY } else { ratio }
}

/// Returns the vertices of the given [corners](Topology::corners) and of `rings` rings of elements around them, ascending.
/// Indices of nonexistent corners are ignored.
pub fn vertices_near(topology: &Topology<'_>, triangles: &[u32], rings: u32) -> Vec<u32> {
    let all = topology.corners();
    let mut found = vec![false; topology.free().len()];
    let mut ring = Vec::new();
    let mut add = |corners: &[u32; 3], ring: &mut Vec<u32>| {
        for &vertex in corners {
            if !std::mem::replace(&mut found[vertex as usize], true) {
                ring.push(vertex);
            }
        }
    };
    for corners in triangles.iter().filter_map(|&triangle| all.get(triangle as usize)) {
        add(corners, &mut ring);
    }
    for _ in 0..rings {
        let mut next = Vec::new();
        for &vertex in &ring {
            for corner in topology.corners_with(vertex) {
                add(&all[corner as usize], &mut next);
            }
        }
        if next.is_empty() {
            break;
        }
        ring = next;
    }
    indices(&found)
}

/// Returns the vertices whose elements are all in `elements`, ascending. Vertices that no element uses are not included.
/// Elements that the mesh lacks are ignored.
pub fn vertices_inside(topology: &Topology<'_>, elements: &[Element]) -> Vec<u32> {
    let triangles = topology.triangles().len();
    let corners: Vec<[u32; 4]> = topology.quadrilaterals().collect();
    let mut chosen = vec![false; triangles + corners.len()];
    let is_listed = |element: &Element| match *element {
        Element::Triangle(index) => index < triangles,
        Element::Quadrilateral(index) => index < corners.len(),
    };
    for &element in elements.iter().filter(|&element| is_listed(element)) {
        chosen[topology.place(element)] = true;
    }
    let of_triangles = topology.triangles().iter().map(|t| &t[..]);
    let all = || of_triangles.clone().chain(corners.iter().map(|q| &q[..])).zip(&chosen);
    let mut inside = vec![false; topology.free().len()];
    for (vertices, _) in all().filter(|(_, chosen)| **chosen) {
        vertices.iter().for_each(|&vertex| inside[vertex as usize] = true);
    }
    for (vertices, _) in all().filter(|(_, chosen)| !**chosen) {
        vertices.iter().for_each(|&vertex| inside[vertex as usize] = false);
    }
    indices(&inside)
}

/// Returns the vertices inside or on the sides of the axis-parallel box spanned by two opposite corners, ascending.
pub fn vertices_in_box(points: &[[f64; 2]], corners: [[f64; 2]; 2]) -> Vec<u32> {
    let [a, b] = corners;
    let is_within = |axis: usize, x: f64| {
        let (a, b) = (a[axis], b[axis]);
        (a <= x && x <= b) || (b <= x && x <= a)
    };
    let is_inside = |&[x, y]: &[f64; 2]| is_within(0, x) && is_within(1, y);
    let points = (0..).zip(points);
    points.filter(|(_, point)| is_inside(point)).map(|(vertex, _)| vertex).collect()
}

/// Returns the indices of the flags that are set, ascending.
fn indices(flags: &[bool]) -> Vec<u32> {
    (0..).zip(flags).filter(|(_, flag)| **flag).map(|(index, _)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    /// Returns a strip of squares, each cut in two: vertices 0 to 5 are below, 6 to 11 above, and no triangle uses the
    /// last vertex.
    fn strip() -> Mesh {
        let point = |i: u32| [f64::from(i % 6), f64::from(i / 6)];
        let square = |i: u32| [[i, i + 1, i + 7], [i, i + 7, i + 6]];
        Mesh {
            points: (0..13).map(point).collect(),
            triangles: (0..5).flat_map(square).collect(),
            ..Mesh::default()
        }
    }

    #[test]
    fn rings_grow_by_neighbors() {
        let mesh = strip();
        let topology = Topology::new(&mesh).unwrap();
        assert_eq!(vertices_near(&topology, &[0, 99], 0), [0, 1, 7]);
        assert_eq!(vertices_near(&topology, &[0, 0], 1), [0, 1, 2, 6, 7, 8]);
        assert_eq!(vertices_near(&topology, &[0], 2), [0, 1, 2, 3, 6, 7, 8, 9]);
        assert_eq!(vertices_near(&topology, &[0], u32::MAX).len(), 12);
        assert_eq!(vertices_near(&topology, &[], 3), []);
    }

    #[test]
    fn vertices_inside_a_region_belong_to_no_triangle_outside() {
        let mesh = strip();
        let topology = Topology::new(&mesh).unwrap();
        let inside = |triangles: &[usize]| {
            let elements: Vec<Element> = triangles.iter().map(|&t| Element::Triangle(t)).collect();
            vertices_inside(&topology, &elements)
        };
        assert_eq!(inside(&[0, 1]), [0, 6]);
        assert_eq!(inside(&[2, 3, 0, 1, 1, 77]), [0, 1, 6, 7]);
        let all: Vec<usize> = (0..10).collect();
        assert_eq!(inside(&all).len(), 12);
        assert_eq!(inside(&[]), []);
        assert_eq!(vertices_inside(&topology, &[Element::Quadrilateral(0)]), []);
    }

    #[test]
    fn boxes_have_their_sides_whatever_corners_are_given() {
        let points = strip().points;
        for corners in
            [[[1.0, 0.0], [3.0, 0.5]], [[3.0, 0.5], [1.0, 0.0]], [[1.0, 0.5], [3.0, 0.0]]]
        {
            assert_eq!(vertices_in_box(&points, corners), [1, 2, 3]);
        }
        assert_eq!(vertices_in_box(&points, [[f64::NAN, 0.0], [3.0, 0.5]]), []);
    }

    #[test]
    fn bad_triangles_are_found_whatever_their_winding() {
        let mut mesh = strip();
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        // Right isosceles triangles have 2/√3 = 1.1547; one vertex is moved far along the strip.
        mesh.points[2][0] = 2.9;
        let topology = Topology::new(&mesh).unwrap();
        // The move makes two triangles of this vertex nearly equilateral.
        assert_eq!(corners_above(&mesh.points, &topology, 1.15), [0, 1, 3, 4, 6, 7, 8, 9]);
        assert_eq!(corners_above(&mesh.points, &topology, 1.2), [4]);
        assert_eq!(corners_above(&mesh.points, &topology, 6.0), []);
        let worst = worst(&mesh.points, &topology);
        // Edges (0.1, 0), (0.1, 1) and (0, 1): (0.01 + 1.01 + 1) / (4 √3 · 0.05).
        assert!((worst - 2.02 / (4.0 * 3f64.sqrt() * 0.05)).abs() < 1e-12, "{worst}");
        assert_eq!(corners_above(&[], &topology, 1e300).len(), 10);
    }
}
