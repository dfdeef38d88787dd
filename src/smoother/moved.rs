//! New points for a prepared mesh, as of an application that moves the boundary.

use std::borrow::Cow;

use web_time::Instant;

use crate::error::MeshError;
use crate::mesh::Mesh;

use super::prepared::Smoother;

impl Smoother<'_> {
    /// Moves the vertices of the prepared mesh to `points`, from which further runs begin, such as after a step of an
    /// application that moves the boundary. Triangles, windings, fixed vertices, [layers](Self::layers), colors and the order
    /// of vertices stay, so that a call takes a fraction of the time of [`Self::new`]. Fixed vertices and boundary vertices may
    /// be anywhere.
    ///
    /// Removes the targets, the sliding vertices and the projection of a sphere, as all belong to the points before: set them
    /// again ([`Self::project_from_sphere`] prepares the mesh anew). Layers are those of the mesh as it was prepared.
    ///
    /// Runs return what runs of a new smoother return, except that a new smoother may visit vertices in another order. The
    /// objectives then agree within the tolerance of the runs, and positions do not agree bit by bit. With the points that
    /// the smoother was prepared at, runs return the bits of before.
    ///
    /// # Errors
    /// [`MeshError::PointCount`], [`MeshError::NotFinite`], [`MeshError::OutOfRange`], [`MeshError::Infeasible`] or
    /// [`MeshError::OverlappingStar`], as for [`Self::new`]; all triangles of a mirrored mesh are inverted. The smoother is
    /// then unchanged. [`Untangle`](crate::Untangle) of [`Self::mesh`] with the new points opens inverted triangles.
    ///
    /// # Examples
    ///
    /// ```
    /// use gpu_smooth::{Mesh, Options, Smoother};
    ///
    /// let mesh = Mesh {
    ///     points: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0]],
    ///     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    ///     fixed: vec![],
    ///     ..Mesh::default()
    /// };
    /// let mut smoother = Smoother::new(&mesh)?;
    /// let mut points = mesh.points.clone();
    /// for step in 1..=10 {
    ///     // The right side moves, and the vertex inside follows.
    ///     points[1][0] = 2.0 + 0.2 * f64::from(step);
    ///     points[2][0] = points[1][0];
    ///     smoother.set_points(points)?;
    ///     points = smoother.run(&Options::default()).block()?.points;
    /// }
    /// assert!((points[4][0] - 2.0).abs() < 1e-3);
    /// # Ok::<(), gpu_smooth::SmoothError>(())
    /// ```
    pub fn set_points(&mut self, points: Vec<[f64; 2]>) -> Result<(), MeshError> {
        let start = Instant::now();
        self.topology.check_points(&points, self.problem.vertices())?;
        match self.topology.check_smoothable(&points) {
            // Boundary vertices may slide.
            Ok(()) | Err(MeshError::NothingFree { .. }) => {}
            Err(error) => return Err(error),
        }
        match &mut self.mesh {
            Cow::Owned(mesh) => mesh.points = points,
            Cow::Borrowed(Mesh { triangles, quadrilaterals, fixed, .. }) => {
                let (triangles, fixed) = (triangles.clone(), fixed.clone());
                let quadrilaterals = quadrilaterals.clone();
                self.mesh = Cow::Owned(Mesh { points, triangles, quadrilaterals, fixed });
            }
        }
        self.problem = self.problem.at_points(&self.mesh, &self.topology);
        self.stop_sliding();
        (self.field, self.opened, self.plane) = (None, None, None);
        self.prepare = start.elapsed();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn quadrilaterals_stay_when_points_move() {
        let points: Vec<[f64; 2]> = (0..9).map(|v| [f64::from(v % 3), f64::from(v / 3)]).collect();
        let cell = |k: u32| {
            let a = k / 2 * 3 + k % 2;
            [a, a + 1, a + 4, a + 3]
        };
        let quadrilaterals = (0..4).map(cell).collect();
        let mesh = Mesh { points, quadrilaterals, ..Mesh::default() };
        let mut smoother = Smoother::new(&mesh).unwrap();
        let mut points = mesh.points.clone();
        points[4] = [1.2, 0.9];
        smoother.set_points(points.clone()).unwrap();
        assert_eq!(*smoother.mesh(), Mesh { points, ..mesh.clone() });
    }

    use crate::layout::{Coloring, Problem, along_curve};
    use crate::slide::Slide;
    use crate::targets::Targets;
    use crate::topology::{BadTriangle, Topology};
    use crate::{Metric, Options, Outcome, Stopping};

    use super::*;

    /// A generator of numbers from -1 to 1.
    fn random(mut state: u64) -> impl FnMut() -> f64 {
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1 << 30) - 1.0
        }
    }

    /// A square lattice of `side` by `side` cells, whose inner vertices are moved by up to `by` of a cell, with a vertex that
    /// no triangle uses.
    fn lattice(side: u32, by: f64, random: &mut impl FnMut() -> f64) -> Mesh {
        let row = side + 1;
        let mut points: Vec<[f64; 2]> = (0..row * row)
            .map(|v| {
                let cell = [v % row, v / row];
                let is_inner = cell.iter().all(|&k| k > 0 && k < side);
                cell.map(|k| f64::from(k) + if is_inner { by * random() } else { 0.0 })
            })
            .collect();
        points.push([1e7, 0.0]);
        let cells = (0..side * side).map(|c| c % side + c / side * row);
        let triangles = cells.flat_map(|a| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]);
        Mesh { points, triangles: triangles.collect(), fixed: vec![3 * row + 4], ..Mesh::default() }
    }

    fn run(smoother: &Smoother<'_>) -> Outcome {
        smoother.run(&Options::default()).block().unwrap()
    }

    #[test]
    fn runs_at_new_points_have_the_bits_of_a_mesh_prepared_there_in_the_same_order() {
        let random = &mut random(1);
        let (mesh, moved) = (lattice(14, 0.3, random), lattice(14, 0.3, random));
        let mut smoother = Smoother::new(&mesh).unwrap();
        let first = run(&smoother);
        // Targets and sliding vertices belong to the points before.
        smoother.set_targets(&Targets::sizes(&vec![1.0; mesh.points.len()]).unwrap()).unwrap();
        smoother.set_slide(Some(&Slide::default())).unwrap();
        smoother.set_points(moved.points.clone()).unwrap();
        assert_eq!(smoother.mesh(), &moved);
        let at_moved = run(&smoother);
        assert!(at_moved.points != first.points);
        let mut anew = Smoother::new(&moved).unwrap();
        let topology = Topology::new(&mesh).unwrap();
        let curve = along_curve(&mesh, &topology);
        let coloring = Coloring::along(&topology, &curve);
        anew.problem = Problem::along(&moved, &topology, &coloring, &curve);
        let expected = run(&anew);
        assert_eq!(at_moved.points, expected.points);
        let history = |outcome: &Outcome| -> Vec<Option<f64>> {
            outcome.history.iter().map(|objectives| objectives.of(Metric::Imr)).collect()
        };
        assert_eq!(history(&at_moved), history(&expected));
        smoother.set_points(mesh.points.clone()).unwrap();
        assert_eq!(run(&smoother).points, first.points);
    }

    #[test]
    fn new_points_are_refused_exactly_if_a_mesh_there_is_refused() {
        let random = &mut random(7);
        let mesh = lattice(9, 0.2, random);
        let mut smoother = Smoother::new(&mesh).unwrap();
        let options = Options::default().stopping(Stopping::Tolerance(1e-9));
        let (mut taken, mut refused) = (0, 0);
        for round in 0..60 {
            let Mesh { mut points, .. } = lattice(9, 0.2 + 0.01 * f64::from(round), random);
            let [shift, scale] = [100.0 * random(), (8.0 * random()).exp2()];
            points.iter_mut().flatten().for_each(|x| *x = (*x + shift) * scale);
            let moved = Mesh { points, ..mesh.clone() };
            match (smoother.set_points(moved.points.clone()), Smoother::new(&moved)) {
                (Ok(()), Ok(anew)) => {
                    let [ours, expected] = [&smoother, &anew].map(|smoother| {
                        let points = smoother.run(&options).block().unwrap().points;
                        assert_eq!(smoother.topology().bad_triangles(&points), Ok(vec![]));
                        let held = mesh.fixed[0] as usize;
                        assert_eq!(points[held], moved.points[held]);
                        anew.f(Metric::Imr, &points).unwrap()
                    });
                    assert!((ours / expected - 1.0).abs() < 1e-6, "{round}: {ours} {expected}");
                    taken += 1;
                }
                (Err(error), Err(expected)) => {
                    assert_eq!(error, expected);
                    refused += 1;
                }
                (ours, anew) => panic!("{round}: {ours:?} {anew:?}"),
            }
        }
        assert!(taken > 20 && refused > 10, "{taken} {refused}");
    }

    #[test]
    fn a_refusal_names_the_place_and_leaves_the_smoother_as_it_was() {
        let mesh = lattice(4, 0.2, &mut random(3));
        let mut smoother = Smoother::from_mesh(mesh.clone()).unwrap();
        let first = run(&smoother).points;
        let mut refusal = |change: &dyn Fn(&mut Vec<[f64; 2]>)| {
            let mut points = mesh.points.clone();
            change(&mut points);
            smoother.set_points(points).unwrap_err()
        };
        let count = MeshError::PointCount { expected: 26, given: 25 };
        assert_eq!(refusal(&|points| points.truncate(25)), count);
        assert_eq!(refusal(&|p| p[7][1] = f64::NAN), MeshError::NotFinite { vertex: 7 });
        assert_eq!(refusal(&|p| p[24][0] = 1e101), MeshError::OutOfRange { size: 1e101 });
        let flat = BadTriangle { triangle: 0, vertices: [0, 1, 6], flat: true };
        let bad = refusal(&|points| points[1] = points[0]);
        assert!(matches!(&bad, MeshError::Infeasible { triangles, .. } if triangles[0] == flat));
        let mirrored = refusal(&|points| points.iter_mut().for_each(|p| p[0] = -p[0]));
        assert!(
            matches!(mirrored, MeshError::Infeasible { triangles, .. } if triangles.len() == 32)
        );
        assert_eq!(run(&smoother).points, first);
        assert_eq!(smoother.mesh(), &mesh);
    }
}
