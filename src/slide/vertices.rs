//! The vertices that slide.

use crate::error::SmoothError;
use crate::slide::options::Slide;
use crate::slide::sliding::Sliding;
use crate::topology::Topology;

impl Slide {
    /// Returns the vertices that slide in a run on a mesh with its vertices at `points`, in ascending order.
    ///
    /// # Errors
    /// As for [`Smoother::set_slide`](crate::Smoother::set_slide), and [`MeshError::PointCount`](crate::MeshError) if
    /// `points` does not have one entry per vertex.
    pub fn vertices(
        &self,
        topology: &Topology<'_>,
        points: &[[f64; 2]],
    ) -> Result<Vec<u32>, SmoothError> {
        topology.check_count(points)?;
        self.check(points.len())?;
        Ok(Sliding::new(points, topology, self).vertices())
    }
}
