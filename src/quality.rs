//! Quality statistics of a mesh.

mod tally;

use crate::error::MeshError;
use crate::mesh::Element;
use crate::metric::{Metric, opposite_angles};
use crate::parallel::pace::now;
use crate::parallel::paced;
use crate::patch::FourTriangles;
use crate::patch::instructions::with_instructions;
use crate::patch::lanes::LANES;
use crate::quality::tally::{Shape, Tally, USUAL_AREA, add_in_order};
use crate::targets::Surface;
use crate::topology::Topology;
use crate::topology::predicates;

/// Quality statistics of a mesh, in double precision. Exact predicates decide which elements are inverted or flat.
///
/// A quadrilateral is measured by its four corners. An element with an infinite or NaN coordinate counts as inverted.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    f: [f64; Metric::ALL.len()],
    /// Smallest angle of any element, in degrees. An inverted corner counts as its mirror image.
    pub min_angle: f64,
    /// Largest angle of any element, in degrees. An inverted corner counts as its mirror image.
    pub max_angle: f64,
    /// Largest inverse mean ratio of a triangle or of a corner of a quadrilateral: 1 at best, infinite if an element is inverted
    /// or flat.
    pub worst_imr: f64,
    /// The element with the largest inverse mean ratio.
    pub worst: Element,
    /// Largest inverse mean ratio among the elements with a free vertex, which smoothing can improve; 0 if there is no
    /// free vertex.
    pub worst_movable_imr: f64,
    /// Number of elements that are inverted or flat, or not convex.
    pub inverted: usize,
}

impl Quality {
    /// Measures the elements of `topology` with vertices at `points`, one plane point per vertex of the mesh, in any
    /// unit.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn of(points: &[[f64; 2]], topology: &Topology<'_>) -> Result<Self, MeshError> {
        Self::on(Surface::Plane, points, topology)
    }

    /// Measures the elements of `topology` with vertices at `points`, given as coordinates on `surface`. Lengths and
    /// angles are measured on the surface, by its metric at the center of each corner.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn on(
        surface: Surface,
        points: &[[f64; 2]],
        topology: &Topology<'_>,
    ) -> Result<Self, MeshError> {
        now(Self::with_pauses(surface, points, topology))
    }

    /// Does the work of [`Self::on`], with pauses.
    pub(crate) async fn with_pauses(
        surface: Surface,
        points: &[[f64; 2]],
        topology: &Topology<'_>,
    ) -> Result<Self, MeshError> {
        topology.check_count(points)?;
        let corners = topology.corner_list();
        let (triangles, right) = (corners.triangles(), corners.of_quadrilaterals());
        // Areas are absolute, as signed areas may cancel if large triangles are inverted.
        let area = |t: &[u32; 3]| {
            let [x, y] = surface.lengths_in(points, t);
            0.5 * predicates::orientation(points, t).abs() * x * y
        };
        let areas = |_, chunk: &[[u32; 3]]| chunk.iter().map(area).sum::<f64>();
        let areas_by_four = |_, chunk: &[[u32; 3]]| {
            with_instructions!(simd => {
                let (fours, rest) = chunk.as_chunks();
                let mut sum = 0.0;
                for four in fours {
                    match FourTriangles::of(simd, surface, points, four) {
                        Some(four) => add_in_order(&mut sum, four.doubled_area * 0.5),
                        None => four.iter().for_each(|t| sum += area(t)),
                    }
                }
                rest.iter().for_each(|t| sum += area(t));
                sum
            }, alone => areas(0, chunk))
        };
        let mut total_area =
            paced::map_parts(triangles.chunks(1024), areas_by_four).await.iter().sum::<f64>();
        if !right.is_empty() {
            let areas = paced::map_parts(right.chunks(1024), areas).await;
            total_area += 0.5 * areas.iter().sum::<f64>();
        }
        let mean_area = total_area / corners.equivalent_triangles();

        let shape = |corner: &[u32; 3]| {
            Shape::of(points, corner, surface.lengths_in(points, corner), mean_area)
        };
        let is_usual = USUAL_AREA.contains(&mean_area);
        let movable = |t: &[u32; 3]| t.iter().any(|&v| topology.free()[v as usize]);
        let tallies = paced::map_parts(triangles.chunks(1024), |chunk, part| {
            let mut tally = Tally::EMPTY;
            let first = chunk * 1024;
            let alone = |tally: &mut Tally, triangles: &[[u32; 3]], first: usize| {
                for (index, t) in (first..).zip(triangles) {
                    tally.add_alone(&shape(t), index, movable(t));
                }
            };
            with_instructions!(simd => {
                let (fours, rest) = part.as_chunks();
                for (k, four) in fours.iter().enumerate() {
                    let at = first + LANES * k;
                    let usual = match is_usual {
                        true => FourTriangles::of(simd, surface, points, four),
                        false => None,
                    };
                    match usual {
                        Some(usual) => tally.add_usual(&usual, mean_area, four, at, movable),
                        None => alone(&mut tally, four, at),
                    }
                }
                alone(&mut tally, rest, first + part.len() - rest.len());
            }, alone => alone(&mut tally, part, first));
            tally
        });
        let mut total = tallies.await.iter().fold(Tally::EMPTY, Tally::and);
        let right_corner = |corner: &[u32; 3], index: usize| {
            let movable = topology.can_move(corners.element(index as u32));
            let lengths = surface.lengths_in(points, corner);
            Tally::of_right(&Shape::of(points, corner, lengths, mean_area), index, movable)
        };
        let tallies = paced::map_parts(right.chunks(1024), |chunk, part| {
            let first = triangles.len() + chunk * 1024;
            let element = |(k, four): (usize, &[[u32; 3]])| {
                let at = |c: usize| right_corner(&four[c], first + 4 * k + c);
                let parts = [0, 1, 2, 3].map(at);
                let mut tally = parts.iter().fold(Tally::EMPTY, |a, b| a.and(b));
                tally.sums.iter_mut().for_each(|sum| *sum *= 0.25);
                let joined =
                    opposite_angles::of_cotangents(parts.each_ref().map(|part| part.cotangents[0]));
                for (sum, metric) in tally.sums.iter_mut().zip(Metric::ALL) {
                    if metric.joins_opposite_angles() && sum.is_finite() {
                        *sum = (*sum + joined).min(f64::MAX);
                    }
                }
                tally.inverted = tally.inverted.min(1);
                tally
            };
            let elements = part.chunks(4).enumerate().map(element);
            elements.fold(Tally::EMPTY, |a, b| a.and(&b))
        });
        total = tallies.await.iter().fold(total, Tally::and);

        let count = topology.element_count() as f64;
        let angle = |cotangent: f64| 1f64.atan2(cotangent).to_degrees();
        let mean = |sum: f64| if sum.is_nan() { f64::INFINITY } else { sum / count };
        Ok(Self {
            f: total.sums.map(mean),
            min_angle: angle(total.cotangents[1]),
            max_angle: angle(total.cotangents[0]),
            worst_imr: total.worst.0,
            worst: corners.element(total.worst.1 as u32),
            worst_movable_imr: total.worst_movable,
            inverted: total.inverted,
        })
    }

    /// Returns the objective f = (1/n) Σ q² over all n elements (Park & Shontz, equation 1), with q² of a
    /// quadrilateral the mean over its corners, to which ACUTE and ACUTE-SIZE add the term of opposite angles. Infinite if an
    /// element is inverted or flat and the metric has a barrier.
    pub fn f(&self, metric: Metric) -> f64 {
        self.f[metric as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    fn quality(points: &[[f64; 2]]) -> Quality {
        let mesh = Mesh { points: points.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
        Quality::of(points, &Topology::new(&mesh).unwrap()).unwrap()
    }

    /// Such angles were left out, so the least angle of a mesh without another triangle was 180 degrees.
    #[test]
    fn angles_at_vertices_of_equal_positions_are_of_any_size() {
        for points in [[[1.0, 2.0]; 3], [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]]] {
            let q = quality(&points);
            assert_eq!((q.min_angle, q.max_angle), (0.0, 180.0));
        }
        // AREA has no barrier, so a triangle at one place among others has a finite value.
        let points = [[0.0, 0.0], [3.0, 0.0], [1.5, 3.0], [1.5, 1.0], [1.5, 1.0], [1.5, 1.0]];
        let triangles =
            vec![[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4], [2, 0, 5], [0, 3, 5], [3, 4, 5]];
        let mesh = Mesh { points: points.to_vec(), triangles, ..Mesh::default() };
        let topology = Topology::by_area(&mesh).unwrap();
        assert!(Quality::of(&mesh.points, &topology).unwrap().f(Metric::Area).is_finite());
    }

    #[test]
    fn a_right_triangle_by_hand() {
        // Legs 1 and 1: edge ratio √2, IMR = (1 + 1 + 2) / (4√3 · ½) = 2/√3.
        let q = quality(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        assert!((q.min_angle - 45.0).abs() < 1e-12 && (q.max_angle - 90.0).abs() < 1e-12);
        assert!((q.worst_imr - 2.0 / 3f64.sqrt()).abs() < 1e-15);
        assert!((q.f(Metric::Imr) - 4.0 / 3.0).abs() < 1e-15);
        assert!((q.f(Metric::Edge) - 2.0).abs() < 1e-15);
        assert!((q.f(Metric::Rms) - 2.0 / 3f64.sqrt()).abs() < 1e-15);
        assert_eq!(q.f(Metric::Area), 0.0);
        assert_eq!(q.inverted, 0);
        assert_eq!(q.worst_movable_imr, 0.0);
    }

    /// Triangles are measured four at a time, with the bits that each has alone.
    #[test]
    fn triangles_measured_together_have_the_sums_of_triangles_measured_alone() {
        let mut state = 5_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        for spread in [0, 3, 90] {
            let mut mesh = Mesh::default();
            for k in 0..501 {
                let size = 10f64.powi(if spread == 0 { 0 } else { k % spread - spread / 2 });
                let first = mesh.points.len() as u32;
                mesh.triangles.push([first, first + 1, first + 2]);
                mesh.points.extend([(); 3].map(|()| [size * random(), size * random()]));
            }
            let topology = Topology::new(&mesh).unwrap();
            let mut points = mesh.points.clone();
            let found = Quality::of(&points, &topology).unwrap();
            let area = |t: &[u32; 3]| 0.5 * predicates::orientation(&points, t).abs();
            let mean = topology.triangles().iter().map(area).sum::<f64>() / 501.0;
            for &metric in Metric::ALL.iter() {
                let mut sum = 0.0;
                for corners in topology.triangles() {
                    let shape = Shape::of(&points, corners, [1.0; 2], mean);
                    let excess = Metric::every_excess(&shape.corner)[metric as usize];
                    sum += shape.square(excess, metric);
                }
                assert_eq!(found.f(metric), sum / 501.0, "{metric}, {spread}");
            }
            let mut extremes = Tally::EMPTY;
            for (index, corners) in topology.triangles().iter().enumerate() {
                extremes.add_extremes(&Shape::of(&points, corners, [1.0; 2], mean), index, true);
            }
            let angles = extremes.cotangents.map(|cotangent| 1f64.atan2(cotangent).to_degrees());
            assert_eq!([found.max_angle, found.min_angle], angles, "{spread}");
            assert_eq!(found.worst_imr, extremes.worst.0, "{spread}");
            assert_eq!(found.worst, Element::Triangle(extremes.worst.1), "{spread}");
            assert_eq!(found.inverted, extremes.inverted, "{spread}");
            points[7][0] = f64::INFINITY;
            let broken = Quality::of(&points, &topology).unwrap();
            assert_eq!(
                (broken.f(Metric::Imr), broken.inverted),
                (f64::INFINITY, found.inverted + 1)
            );
        }
    }

    #[test]
    fn a_flat_triangle_counts_as_inverted() {
        let q = quality(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]);
        assert_eq!((q.inverted, q.worst_imr), (1, f64::INFINITY));
        assert_eq!(q.f(Metric::Imr), f64::INFINITY);
        assert!(q.f(Metric::Edge).is_finite());
    }
}
