//! Whether a mesh can be smoothed with its vertices at given points, and which elements are inverted or flat there.

use crate::error::{BadQuadrilateral, BadTriangle, MeshError};
use crate::mesh::Element;
use crate::parallel::pace::now;
use crate::topology::checks::{check_finite, check_size, size};
use crate::topology::connectivity::Topology;
use crate::topology::{predicates, turns};

impl Topology<'_> {
    /// Checks that the mesh can be smoothed: every triangle is counter-clockwise at `points`, every quadrilateral convex and
    /// counter-clockwise, some vertex is free, and the elements around each free vertex wind around it once.
    ///
    /// Other overlaps pass the check, for example two parts of a mesh over one area.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex, [`MeshError::Infeasible`] if a
    /// corner is inverted or flat at `points`, [`MeshError::NothingFree`] if no vertex is free,
    /// [`MeshError::OverlappingStar`] if elements wind more than once around a free vertex.
    pub fn check_smoothable(&self, points: &[[f64; 2]]) -> Result<(), MeshError> {
        self.check_count(points)?;
        let is_feasible = turns::is_feasible(points, self.corner_list(), self.free());
        if is_feasible && self.free().contains(&true) {
            return Ok(());
        }
        if let Some(error) = now(self.infeasible(points)) {
            return Err(error);
        }
        if !self.free().contains(&true) {
            return Err(MeshError::NothingFree { vertices: points.len() });
        }
        match turns::overlapping_star(points, self.corner_list(), self.free()) {
            None => Ok(()),
            Some((vertex, turns)) => Err(MeshError::OverlappingStar { vertex, turns }),
        }
    }

    /// Returns the error that lists the corners that are inverted or flat at `points`, by exact predicates. `None` if there is
    /// no such corner. `points` must have one entry per vertex.
    pub(crate) async fn infeasible(&self, points: &[[f64; 2]]) -> Option<MeshError> {
        let bad = predicates::not_positive(points, self.corners()).await;
        (!bad.is_empty()).then(|| {
            let (triangles, quadrilaterals) = self.described(points, &bad);
            MeshError::Infeasible { triangles, quadrilaterals }
        })
    }

    /// Describes corners that are inverted or flat, given in ascending order.
    pub(crate) fn described(
        &self,
        points: &[[f64; 2]],
        bad: &[u32],
    ) -> (Vec<BadTriangle>, Vec<BadQuadrilateral>) {
        let (mut triangles, mut quadrilaterals) = (Vec::new(), Vec::new());
        for &index in bad {
            let vertices = self.corners()[index as usize];
            let flat = predicates::orientation(points, &vertices) == 0.0;
            match self.corner_list().element(index) {
                Element::Triangle(triangle) => {
                    triangles.push(BadTriangle { triangle, vertices, flat });
                }
                Element::Quadrilateral(quadrilateral) => {
                    let all = self.corner_list().quadrilateral(quadrilateral);
                    let corner = all.iter().position(|&v| v == vertices[0]).unwrap_or(0);
                    quadrilaterals.push(BadQuadrilateral {
                        quadrilateral,
                        vertices: all,
                        corner,
                        flat,
                    });
                }
            }
        }
        (triangles, quadrilaterals)
    }

    /// Returns the triangles that are inverted or flat with the vertices at `points`, by exact predicates, in ascending
    /// order. Triangles with a coordinate that is not finite count as inverted.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn bad_triangles(&self, points: &[[f64; 2]]) -> Result<Vec<BadTriangle>, MeshError> {
        self.check_count(points)?;
        let bad = now(predicates::not_positive(points, self.triangles()));
        Ok(self.described(points, &bad).0)
    }

    /// Returns the corners of quadrilaterals that are not convex with the vertices at `points`, by exact predicates, in
    /// ascending order. Corners with a coordinate that is not finite count as concave.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn bad_quadrilaterals(
        &self,
        points: &[[f64; 2]],
    ) -> Result<Vec<BadQuadrilateral>, MeshError> {
        self.check_count(points)?;
        let first = self.triangles().len() as u32;
        let mut bad = now(predicates::not_positive(points, self.corner_list().of_quadrilaterals()));
        bad.iter_mut().for_each(|corner| *corner += first);
        Ok(self.described(points, &bad).1)
    }

    /// Checks new points of the vertices as [`Self::new`] checks those of a mesh. `used` lists the vertices that some element
    /// uses.
    pub(crate) fn check_points(&self, points: &[[f64; 2]], used: &[u32]) -> Result<(), MeshError> {
        self.check_count(points)?;
        check_finite(points)?;
        check_size(used.len(), |i| size(points[used[i] as usize]))
    }

    /// Fails with [`MeshError::PointCount`] unless `points` has one entry per vertex.
    pub(crate) fn check_count(&self, points: &[[f64; 2]]) -> Result<(), MeshError> {
        let (expected, given) = (self.free().len(), points.len());
        if given == expected { Ok(()) } else { Err(MeshError::PointCount { expected, given }) }
    }

    /// Returns [`MeshError::NotFinite`] for the first vertex of an element with an infinite coordinate or NaN.
    pub(crate) fn check_finite(&self, points: &[[f64; 2]]) -> Result<(), MeshError> {
        let is_finite = |&v: &u32| points[v as usize].iter().all(|x| x.is_finite());
        match self.corners().as_flattened().iter().find(|v| !is_finite(v)) {
            Some(&vertex) => Err(MeshError::NotFinite { vertex }),
            None => Ok(()),
        }
    }
}
