//! A mesh file together with the mesh to smooth.

use crate::error::CliError;
use crate::load::plane::{likewise, of_file, remark};
use gpu_smooth::{
    Mesh, MeshError, Topology, interpolate::Chart, plane::Plane, precision::Precision,
    slide::Periodic,
};
use gpu_smooth_job::{Domain, smoother_precision};
use mesh_io::{MeshFile, PointField, SourceLocation, WriteError};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A mesh file, and the mesh made from its points, triangles and constraints. Constrained vertices and vertices between
/// regions are fixed, and longitudes may be continued across the date line.
pub(crate) struct LoadedMesh {
    /// The file. It never changes.
    pub(crate) source: MeshFile,
    /// The mesh to smooth. Copies of vertices, made by the chart, follow the vertices of the file.
    mesh: Mesh,
    /// The mesh with continued longitudes; `None` if no triangle crosses the date line or touches a pole.
    chart: Option<Chart>,
    /// The plane of the mesh; `None` if all z are equal, or z is data.
    plane: Option<Plane>,
    /// Vertices fixed only because they lie between regions, ascending. They are the last entries of `mesh.fixed`.
    interfaces: Vec<u32>,
    has_free_interfaces: bool,
    /// Vertices that neither move nor slide.
    anchored: Vec<u32>,
}

impl LoadedMesh {
    /// Makes the mesh of a file. Constrained vertices and vertices between regions are fixed.
    pub(crate) fn new(source: MeshFile) -> Self {
        let Domain { mesh, interfaces, anchored, .. } = Domain::of_file(&source);
        Self {
            source,
            mesh,
            chart: None,
            plane: None,
            interfaces,
            has_free_interfaces: false,
            anchored,
        }
    }

    /// Returns the paths of all files that were read.
    pub(crate) fn paths(&self) -> Vec<PathBuf> {
        self.source.paths().map(Path::to_path_buf).collect()
    }

    /// Returns the mesh to smooth.
    pub(crate) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the mesh with continued longitudes; `None` if longitudes are not continued.
    pub(crate) fn chart(&self) -> Option<&Chart> {
        self.chart.as_ref()
    }

    /// Returns the plane of the mesh; `None` if all z are equal, or z is data.
    pub(crate) fn plane(&self) -> Option<&Plane> {
        self.plane.as_ref()
    }

    /// Returns the names of the two coordinates in which the mesh is smoothed: x and y, or those of its plane.
    pub(crate) fn axes(&self) -> [&'static str; 2] {
        self.plane().map_or(["x", "y"], Plane::axes)
    }

    /// Returns the precision with which the file stores the coordinates of the mesh. Coordinates in a tilted plane are
    /// not stored, so that a run does not round them.
    pub(crate) fn precision(&self) -> Precision {
        self.plane()
            .map_or_else(|| smoother_precision(self.source.precision()), Plane::run_precision)
    }

    /// Returns a bound on the rounding errors of coordinates, up to an absolute value, as the file stores them. In a tilted
    /// plane, the errors are those of the coordinates in space.
    pub(crate) fn rounding(&self, size: f64) -> f64 {
        match self.plane().filter(|plane| plane.is_tilted()) {
            Some(plane) => plane.rounding(),
            None => self.precision().error(size),
        }
    }

    /// Returns the vertices of the file by which options select vertices: x and y, or positions in the plane of the
    /// mesh.
    pub(crate) fn positions(&self) -> &[[f64; 2]] {
        self.plane().map_or(self.source.points(), Plane::points)
    }

    /// Lays the mesh out in the plane in which its vertices lie, unless all z are equal. Returns a remark on the plane.
    ///
    /// # Errors
    /// Returns an error if the vertices do not lie in a plane.
    pub(crate) fn lay_out_in_plane(&mut self) -> Result<Vec<String>, CliError> {
        let plane = of_file(&self.source)?;
        let remarks = plane.as_ref().and_then(remark).into_iter().collect();
        self.take_plane(plane);
        Ok(remarks)
    }

    fn take_plane(&mut self, plane: Option<Plane>) {
        if let Some(plane) = &plane {
            self.mesh.points = plane.points().to_vec();
        }
        self.plane = plane;
    }

    /// Sets the vertices of triangles back to `before` that are inverted once the positions in a tilted plane are
    /// rounded to coordinates of the file.
    pub(crate) fn certify_as_stored(
        &self,
        topology: &Topology<'_>,
        before: &[[f64; 2]],
        points: &mut [[f64; 2]],
    ) -> Result<(), MeshError> {
        match self.plane() {
            Some(plane) => plane.certify_as_stored(topology, before, points),
            None => Ok(()),
        }
    }

    /// Interprets coordinates as longitude and latitude in degrees, and continues longitudes across the meridian at
    /// which they wrap.
    ///
    /// # Errors
    /// Returns the errors of [`Chart::new`], and then leaves the mesh unchanged.
    pub(crate) fn lay_out_on_sphere(&mut self) -> Result<(), MeshError> {
        if self.chart.is_none()
            && let Some(chart) = Chart::new(&self.mesh, self.precision())?
        {
            self.take_chart(chart);
        }
        Ok(())
    }

    /// Lays `other`, a moved state of this mesh, out in the plane of this mesh, or continues its longitudes: each
    /// vertex is placed nearest to its position in this mesh. Does nothing if this mesh has no chart and no plane, or if
    /// the numbers of vertices differ.
    ///
    /// # Errors
    /// Returns an error if the third coordinates of `other` cannot be read.
    pub(crate) fn lay_out_likewise(&self, other: &mut LoadedMesh) -> Result<(), CliError> {
        if let Some(plane) = self.plane() {
            other.take_plane(Some(likewise(plane, &other.source)?));
        }
        let Some(chart) = self.chart() else { return Ok(()) };
        if other.chart.is_none() && other.mesh.points.len() == chart.original().points.len() {
            other.take_chart(chart.moved(&other.mesh));
        }
        Ok(())
    }

    fn take_chart(&mut self, chart: Chart) {
        self.anchored.extend_from_slice(chart.held());
        self.mesh.points.clone_from(&chart.mesh().points);
        self.mesh.triangles.clone_from(&chart.mesh().triangles);
        self.chart = Some(chart);
    }

    /// Returns the vertices fixed only because they lie between regions, ascending. After
    /// [`free_interfaces`](Self::free_interfaces), the list is empty.
    pub(crate) fn interface_vertices(&self) -> &[u32] {
        &self.interfaces
    }

    /// Lets vertices between regions move, unless they are fixed for another reason.
    pub(crate) fn free_interfaces(&mut self) {
        self.has_free_interfaces = true;
        let held = std::mem::take(&mut self.interfaces);
        self.mesh.fixed.truncate(self.mesh.fixed.len() - held.len());
    }

    /// Returns whether vertices between regions are fixed because they lie there.
    pub(crate) fn interfaces_are_held(&self) -> bool {
        !self.has_free_interfaces
    }

    /// Returns the vertices between regions that are fixed for a further reason, ascending.
    pub(crate) fn held_interface_vertices(&self) -> Vec<u32> {
        let mut is_held = vec![false; self.mesh.points.len()];
        self.mesh.fixed.iter().for_each(|&v| is_held[v as usize] = true);
        self.interfaces.iter().for_each(|&v| is_held[v as usize] = false);
        let mut between = self.source.interface_vertices();
        between.retain(|&v| is_held[v as usize]);
        between
    }

    /// Returns the edges along which vertices inside the mesh may slide: lines of the file, and edges between regions.
    /// Edges between regions are omitted after [`free_interfaces`](Self::free_interfaces).
    pub(crate) fn lines(&self) -> Vec<[u32; 2]> {
        let mut lines = self.source.constraints().lines.clone();
        if !self.has_free_interfaces {
            lines.extend(self.source.interface_edges());
        }
        lines
    }

    /// Returns the vertices that neither move nor slide.
    pub(crate) fn held_vertices(&self) -> &[u32] {
        &self.anchored
    }

    /// Returns the periodic pairs of the file. Motions of files are motions in x and y, and are left out in other planes.
    pub(crate) fn periodic(&self) -> Vec<Periodic> {
        let pairs = self.source.constraints().periodic.iter();
        let motion = |motion| if self.is_in_xy() { motion } else { None };
        pairs.map(|p| Periodic { pairs: p.pairs.clone(), motion: motion(p.motion) }).collect()
    }

    /// Returns whether the mesh lies in the plane of x and y.
    pub(crate) fn is_in_xy(&self) -> bool {
        self.plane().is_none_or(Plane::is_of_xy)
    }

    /// Fixes `vertices`, so that they neither move nor slide. The list may be unordered and have repeats.
    ///
    /// # Errors
    /// Returns [`MeshError::IndexOutOfRange`] if a vertex does not exist, and then leaves the mesh unchanged.
    pub(crate) fn fix(&mut self, vertices: &[u32]) -> Result<(), MeshError> {
        let held = self.marked(vertices)?;
        self.hold(held);
        Ok(())
    }

    /// Fixes all vertices except `vertices`. A listed vertex stays fixed if it was fixed before.
    ///
    /// # Errors
    /// Returns [`MeshError::IndexOutOfRange`] if a vertex does not exist, and then leaves the mesh unchanged.
    pub(crate) fn fix_all_but(&mut self, vertices: &[u32]) -> Result<(), MeshError> {
        let mut held = self.marked(vertices)?;
        held.iter_mut().for_each(|held| *held = !*held);
        self.hold(held);
        Ok(())
    }

    /// Returns a mask of the mesh's vertices, true for each entry of `vertices`.
    fn marked(&self, vertices: &[u32]) -> Result<Vec<bool>, MeshError> {
        let count = self.mesh.points.len();
        let mut marked = vec![false; count];
        for &vertex in vertices {
            *marked.get_mut(vertex as usize).ok_or(MeshError::IndexOutOfRange {
                triangle: None,
                vertex,
                vertices: count,
            })? = true;
        }
        Ok(marked)
    }

    /// Fixes the vertices of the mask `held` as constrained vertices, also those between regions.
    fn hold(&mut self, mut held: Vec<bool>) {
        let all = (0..).zip(&held).filter(|&(_, &held)| held);
        self.anchored.extend(all.map(|(vertex, _)| vertex));
        let fixed = &mut self.mesh.fixed;
        fixed.truncate(fixed.len() - self.interfaces.len());
        self.interfaces.retain(|&vertex| !held[vertex as usize]);
        // `mesh.fixed` must list each vertex once.
        fixed.iter().for_each(|&vertex| held[vertex as usize] = false);
        fixed.extend((0..).zip(held).filter(|&(_, held)| held).map(|(vertex, _)| vertex));
        fixed.extend_from_slice(&self.interfaces);
    }

    /// Returns the location of a vertex's coordinates in the file. For a copy made by the chart, returns the location
    /// of the original vertex.
    ///
    /// # Panics
    /// Panics if the vertex does not exist.
    pub(crate) fn vertex_place(&self, index: u32) -> SourceLocation {
        self.source.vertex_location(self.owner(index))
    }

    /// Returns the locations of the coordinates of vertices, found in one search of the file. Vertices that do not
    /// exist are omitted.
    pub(crate) fn vertex_places(
        &self,
        indices: impl IntoIterator<Item = u32>,
    ) -> BTreeMap<u32, SourceLocation> {
        let wanted: Vec<u32> = indices.into_iter().collect();
        let found = self.source.vertex_locations(wanted.iter().map(|&v| self.owner(v)));
        let place = |&v: &u32| Some((v, found.get(&self.owner(v))?.clone()));
        wanted.iter().filter_map(place).collect()
    }

    /// Returns the file's vertex for a vertex of the mesh: the original vertex, if the chart made `v` as a copy, else
    /// `v`.
    fn owner(&self, v: u32) -> u32 {
        match self.chart().zip((v as usize).checked_sub(self.source.points().len())) {
            Some((chart, copy)) => chart.owners().get(copy).copied().unwrap_or(v),
            None => v,
        }
    }

    /// Converts points of the mesh to x and y of the file, without copies and with longitudes in the file's range.
    pub(crate) fn given<'p>(&self, points: &'p [[f64; 2]]) -> Cow<'p, [[f64; 2]]> {
        if let Some(plane) = self.plane().filter(|plane| !plane.is_of_xy()) {
            return plane.in_space(points).iter().map(|&[x, y, _]| [x, y]).collect();
        }
        match self.chart() {
            // The writer refuses a list of any other length.
            Some(chart) if points.len() == self.mesh.points.len() => chart.given(points).into(),
            _ => points.into(),
        }
    }

    /// Writes the file with the vertices of the mesh at `points` and the values of `fields`.
    ///
    /// # Errors
    /// Returns the errors of [`MeshFile::write_with_fields`].
    pub(crate) fn write_with(
        &self,
        path: &Path,
        points: &[[f64; 2]],
        fields: &[PointField],
    ) -> Result<(), WriteError> {
        self.source.write_with_fields(path, &self.given(points), fields)
    }

    /// Writes the file to a stream instead of a path, as [`write_with`](Self::write_with) does. `name` identifies the
    /// stream in messages.
    ///
    /// # Errors
    /// Returns the errors of [`MeshFile::write_to_with_fields`].
    pub(crate) fn write_to_with(
        &self,
        name: &Path,
        out: &mut (dyn Write + Send),
        points: &[[f64; 2]],
        fields: &[PointField],
    ) -> Result<(), WriteError> {
        self.source.write_to_with_fields(name, out, &self.given(points), fields)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square with two regions and a vertex in the middle.
    const VTK: &str = "# vtk DataFile Version 3.0\nsquare\nASCII\nDATASET UNSTRUCTURED_GRID\n\
        POINTS 5 double\n0 0 0 1 0 0 1 1 0 0 1 0 .4 .5 0\n\
        CELLS 4 16\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\nCELL_TYPES 4\n5\n5\n5\n5\n\
        CELL_DATA 4\nSCALARS region int 1\nLOOKUP_TABLE default\n1\n1\n2\n2\n";

    fn read() -> LoadedMesh {
        let file = MeshFile::from_bytes(Path::new("in.vtk"), VTK.into());
        LoadedMesh::new(file.unwrap())
    }

    #[test]
    fn vertices_that_are_fixed_by_hand_are_not_between_regions() {
        assert_eq!((&read().mesh().fixed[..], read().interface_vertices()), (&[4][..], &[4][..]));
        for free_first in [false, true] {
            let mut mesh = read();
            if free_first {
                mesh.free_interfaces();
            }
            mesh.fix(&[4, 1, 4]).unwrap();
            assert_eq!(mesh.mesh().fixed, [1, 4]);
            assert!(mesh.interface_vertices().is_empty());
            mesh.free_interfaces();
            assert_eq!(mesh.mesh().fixed, [1, 4]);
        }
        let mut mesh = read();
        mesh.fix(&[1]).unwrap();
        mesh.fix_all_but(&[0, 4]).unwrap();
        assert_eq!(
            (&mesh.mesh().fixed[..], mesh.interface_vertices()),
            (&[1, 2, 3, 4][..], &[4][..])
        );
        mesh.free_interfaces();
        assert_eq!(mesh.mesh().fixed, [1, 2, 3]);
        assert!(mesh.fix(&[0, 5]).is_err() && mesh.fix_all_but(&[5]).is_err());
        assert_eq!(mesh.mesh().fixed, [1, 2, 3]);
    }
}
