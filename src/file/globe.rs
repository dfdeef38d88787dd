//! Lays out a mesh in longitude and latitude across the line where longitudes start again.

use crate::chart::Chart;
use crate::error::MeshError;
use crate::file::mesh_file::MeshFile;

impl MeshFile {
    /// Takes the coordinates as longitude and latitude in degrees, and continues longitudes across the line where they
    /// start again. If that changes the mesh, [`mesh`](Self::mesh) is from then on that of the [`Chart`], which
    /// [`chart`](Self::chart) returns. [`write`](Self::write) then takes points of the chart, and writes longitudes in
    /// their original range.
    ///
    /// # Errors
    /// The errors of [`Chart::new`]; then the mesh is unchanged.
    pub fn lay_out_on_sphere(&mut self) -> Result<(), MeshError> {
        if self.chart().is_some() {
            return Ok(());
        }
        if let Some(chart) = Chart::new(self.mesh(), self.precision())? {
            self.take_chart(chart);
        }
        Ok(())
    }

    /// Lays out another file of the same mesh as this one, each vertex nearest to its place here. Does nothing if this
    /// file is not laid out on a sphere, or if the other has another number of vertices.
    pub fn lay_out_likewise(&self, other: &mut MeshFile) {
        let Some(chart) = self.chart() else { return };
        if other.chart().is_none() && other.mesh().points.len() == chart.original().points.len() {
            other.take_chart(chart.moved(other.mesh()));
        }
    }
}
