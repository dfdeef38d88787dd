//! A mesh file in longitude and latitude, laid out across the line where longitudes start again.

use crate::chart::Chart;
use crate::error::MeshError;
use crate::file::mesh_file::MeshFile;

impl MeshFile {
    /// Takes the coordinates for longitude and latitude in degrees, and continues longitudes across the line where they start again:
    /// [`mesh`](Self::mesh) is that of the [`Chart`] from then on, if there is need for one, which [`chart`](Self::chart) tells.
    /// [`write`](Self::write) takes points of the chart, and writes longitudes in the range they had.
    ///
    /// # Errors
    /// Those of [`Chart::new`]. The mesh is as it was then.
    pub fn lay_out_on_sphere(&mut self) -> Result<(), MeshError> {
        if self.chart().is_some() {
            return Ok(());
        }
        if let Some(chart) = Chart::new(self.mesh(), self.precision())? {
            self.take_chart(chart);
        }
        Ok(())
    }

    /// Lays out another file of the same mesh as this one is, each vertex nearest to its place here. Nothing happens if this one is not
    /// laid out on a sphere, or if the other one has not as many vertices.
    pub fn lay_out_likewise(&self, other: &mut MeshFile) {
        let Some(chart) = self.chart() else { return };
        if other.chart().is_none() && other.mesh().points.len() == chart.original().points.len() {
            other.take_chart(chart.moved(other.mesh()));
        }
    }
}
