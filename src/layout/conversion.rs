//! Conversions between the normalized positions of a problem and the coordinates of its mesh.

use std::borrow::Cow;

use glam::DVec2;

use crate::layout::Problem;
use crate::layout::mercator::{Mercator, MeshCoordinates};
use crate::mesh::Mesh;
use crate::parallel::pace::now;
use crate::parallel::paced;
use crate::targets::{Surface, Targets};

/// Number of vertices that one task converts.
const CHUNK: usize = 1 << 12;

impl Problem {
    /// Returns the center and the scale of the normalization: normalized positions are (x - center) · scale, without
    /// rounding. x are the images of the coordinates of the mesh if vertices move in a projection.
    pub fn normalization(&self) -> (DVec2, f64) {
        (self.placement.center, self.placement.scale)
    }

    /// Returns the conversion between normalized positions and the coordinates of the mesh.
    pub(crate) fn coordinates(&self) -> MeshCoordinates {
        MeshCoordinates::new(self.projection, self.placement.center, self.placement.scale)
    }

    /// Returns whether vertices move in a projection of the coordinates of the mesh.
    pub(crate) fn is_projected(&self) -> bool {
        self.projection.is_some()
    }

    /// Returns the images of points of the mesh in the plane in which vertices move.
    pub(crate) fn images<'p>(&self, points: &'p [[f64; 2]]) -> Cow<'p, [[f64; 2]]> {
        match self.projection {
            None => points.into(),
            Some(projection) => points.iter().map(|&point| projection.image(point)).collect(),
        }
    }

    /// Converts targets in the coordinates of the mesh to the plane in which vertices move, with the vertices at
    /// `points`, in the coordinates of the mesh.
    pub(crate) fn converted<'t>(
        &self,
        targets: &'t Targets,
        points: &[[f64; 2]],
    ) -> Cow<'t, Targets> {
        match self.projection {
            None => Cow::Borrowed(targets),
            Some(_) => Cow::Owned(targets.in_conformal_coordinates(Surface::Sphere, points)),
        }
    }

    /// Returns the point of a normalized position, in the coordinates of the mesh.
    pub(crate) fn point(&self, position: DVec2) -> [f64; 2] {
        let point = (self.placement.center + position / self.placement.scale).to_array();
        self.projection.map_or(point, |_| Mercator::point(point))
    }

    /// Converts the normalized positions of all vertices, fixed ones included, to the unit of the mesh. Returns each
    /// position with the index that its vertex has in the mesh.
    pub fn denormalized(&self, positions: &[DVec2]) -> impl Iterator<Item = (u32, [f64; 2])> {
        let point = |&now: &DVec2| self.point(now);
        self.layout.vertices.iter().copied().zip(positions.iter().map(point))
    }

    /// Returns the normalized positions of points given in the order and unit of the mesh. Reuses the memory of `room`.
    pub(crate) async fn normalized(&self, points: &[[f64; 2]], mut room: Vec<DVec2>) -> Vec<DVec2> {
        room.resize(self.layout.vertices.len(), DVec2::ZERO);
        paced::for_each_chunk(&mut room, CHUNK, |first, positions| {
            for (position, &v) in positions.iter_mut().zip(&self.layout.vertices[first..]) {
                let point = points[v as usize];
                let image = self.projection.map_or(point, |projection| projection.image(point));
                *position = (DVec2::from(image) - self.placement.center) * self.placement.scale;
            }
        })
        .await;
        room
    }

    /// Converts normalized positions to the order and unit of the mesh. Fixed vertices and vertices that have not moved
    /// keep the bits of their positions in the mesh.
    pub fn denormalize(&self, mesh: &Mesh, positions: &[DVec2]) -> Vec<[f64; 2]> {
        now(self.in_unit_of(mesh, positions))
    }

    /// Does the work of [`Self::denormalize`], with pauses.
    pub(crate) async fn in_unit_of(&self, mesh: &Mesh, positions: &[DVec2]) -> Vec<[f64; 2]> {
        let mut points = paced::copied(&mesh.points).await;
        paced::in_order(self.free_count(), CHUNK, |vertices| {
            for i in vertices {
                let (now, was) = (positions[i], self.placement.positions[i]);
                if now != was {
                    points[self.layout.vertices[i] as usize] = self.point(now);
                }
            }
        })
        .await;
        points
    }
}
