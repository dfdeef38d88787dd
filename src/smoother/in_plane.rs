//! The plane of space of a prepared mesh. The results of runs are positions that vertices can have with stored coordinates in
//! space.

use crate::error::MeshError;
use crate::plane::Plane;

use super::prepared::Smoother;

impl Smoother<'_> {
    /// Sets the plane of space in which the vertices of the mesh lie. In a tilted plane, further runs return positions that
    /// the vertices can have with coordinates in space of the plane's precision, whatever [`Options::stored`](crate::Options::stored) is, and keep
    /// their bounds there. [`set_points`](Self::set_points) removes the plane.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if the plane has another number of vertices than the mesh.
    pub fn set_plane(&mut self, plane: &Plane) -> Result<(), MeshError> {
        self.topology.check_count(plane.points())?;
        self.plane = Some(plane.clone());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{Change, mean_edges};
    use crate::mesh::Mesh;
    use crate::options::{Options, Precision};
    use crate::outcome::Outcome;
    use crate::plane::Storage;
    use crate::slide::Slide;

    /// Returns a ring of `rows` rows of `sides` quadrilaterals, each cut along one diagonal, in a tilted plane, with vertices moved
    /// by `jitter` edges along the rows.
    fn ring(sides: u32, rows: u32, jitter: f64, stored: Precision) -> (Plane, Mesh) {
        let (u, v) =
            ([0.5f64.sqrt(), 0.0, 0.5f64.sqrt()], [-1.0, 2.0, 1.0].map(|x| x / 6.0f64.sqrt()));
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1u32 << 24)
        };
        let mut space = Vec::new();
        for row in 0..=rows {
            let radius = 1.0 + 0.4 * (1.3f64.powi(row as i32) - 1.0);
            for side in 0..sides {
                let along = f64::from(side) + jitter * (random() - 0.5);
                let (sin, cos) = (along * std::f64::consts::TAU / f64::from(sides)).sin_cos();
                let at = |k: usize| 0.25 * radius * (cos * u[k] + sin * v[k]);
                space.push([0, 1, 2].map(|k| stored.rounded(at(k))));
            }
        }
        let mut triangles = Vec::new();
        for (row, side) in (0..rows).flat_map(|row| (0..sides).map(move |side| (row, side))) {
            let [a, b] = [side, (side + 1) % sides].map(|side| row * sides + side);
            let [c, d] = [b + sides, a + sides];
            match random() < 0.5 {
                true => triangles.extend([[a, d, b], [b, d, c]]),
                false => triangles.extend([[a, d, c], [a, c, b]]),
            }
        }
        let plane = Plane::of(space, stored).unwrap();
        assert!(plane.is_tilted());
        let mesh = Mesh { points: plane.points().to_vec(), triangles, ..Mesh::default() };
        (plane, mesh)
    }

    /// Smooths a mesh in its plane, and checks that rounding of the result in space changes no point.
    fn smoothed(plane: &Plane, mesh: &Mesh, slide: Option<&Slide>, options: &Options) -> Outcome {
        let mut smoother = Smoother::new(mesh).unwrap();
        smoother.set_plane(plane).unwrap();
        smoother.set_slide(slide).unwrap();
        let outcome = smoother.run(options).block().unwrap();
        let mut space = plane.in_space(&outcome.points);
        let stored = Storage::new(plane.run_precision(), Some(plane));
        for (v, &point) in outcome.points.iter().enumerate() {
            assert_eq!(stored.rounded(v, point), point);
        }
        if matches!(options.stored, Precision::Single) {
            space.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
        }
        assert_eq!(plane.likewise(space).points(), outcome.points);
        outcome
    }

    #[test]
    fn vertices_that_slide_in_a_tilted_plane_stay_on_their_curves_as_stored() {
        for sides in 20..30 {
            for stored in [Precision::Single, Precision::Double] {
                let (plane, mesh) = ring(sides, 3, 0.4, stored);
                let slide = Slide::default();
                let options = Options { stored, ..Options::default() };
                let outcome = smoothed(&plane, &mesh, Some(&slide), &options);
                assert!(outcome.slid.is_some_and(|slid| slid.moved > 0));
                let smoother = Smoother::new(&mesh).unwrap();
                // A former defect: points for which no stored position was found stayed.
                let free =
                    smoother.topology().free().iter().zip(mesh.points.iter().zip(&outcome.points));
                let stay = free.filter(|(is_free, (from, to))| **is_free && from == to);
                assert!(
                    stay.count() <= outcome.returned,
                    "{sides} {stored:?} {} {:?}",
                    outcome.returned,
                    outcome.floored
                );
                let found = slide.misplaced_within(
                    smoother.topology(),
                    &mesh.points,
                    &outcome.points,
                    &|_| plane.rounding(),
                );
                assert_eq!(found, [], "{sides} {stored:?}");
            }
        }
    }

    #[test]
    fn bounds_hold_in_a_tilted_plane_as_stored() {
        for (sides, jitter) in [(10, 0.0), (20, 0.5), (31, 0.3)] {
            for stored in [Precision::Single, Precision::Double] {
                let (plane, mesh) = ring(sides, 5, jitter, stored);
                let options = Options {
                    stored,
                    keep_altitude: true,
                    max_move: Some(0.05),
                    ..Options::default()
                };
                let Outcome { points, movable_f: [before, after], .. } =
                    smoothed(&plane, &mesh, None, &options);
                assert!(after < before, "{sides} {stored:?}");
                let smoother = Smoother::new(&mesh).unwrap();
                let topology = smoother.topology();
                let change = Change::between(topology, &mesh.points, &points).unwrap();
                let [least, now] = change.least_altitude;
                assert!(now >= least, "{sides} {stored:?}");
                let edges = mean_edges(topology, &mesh.points);
                for ((from, to), edge) in mesh.points.iter().zip(&points).zip(edges) {
                    let distance = (to[0] - from[0]).hypot(to[1] - from[1]);
                    assert!(distance <= 0.05 * edge, "{sides} {stored:?}: {}", distance / edge);
                }
            }
        }
    }

    #[test]
    fn a_plane_of_other_vertices_is_refused() {
        let (plane, mut mesh) = ring(10, 2, 0.0, Precision::Double);
        mesh.points.push([0.0; 2]);
        let mut smoother = Smoother::new(&mesh).unwrap();
        let refused = smoother.set_plane(&plane);
        assert_eq!(refused, Err(MeshError::PointCount { expected: 31, given: 30 }));
    }
}
