//! A mesh file together with the mesh to smooth.

use crate::error::CliError;
use crate::load::plane::{likewise, of_file, remark};
use gpu_smooth::{
    Element, Mesh,
    front_ends::{Chart, Plane},
    options::Precision,
};
use gpu_smooth_job::{Domain, smoother_precision};
use mesh_io::{
    Constraints, Group, Groups, MeshFile, PointField, SourceLocation, WriteError, interfaces,
};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A mesh file, and the mesh made from its points, triangles and constraints. Constrained vertices and vertices between
/// regions are fixed, and longitudes may be continued across the date line.
pub(crate) struct LoadedMesh {
    /// The file. It never changes.
    pub(crate) source: MeshFile,
    /// The mesh to smooth. Copies of vertices, made by the chart, follow the vertices of the file.
    pub(crate) domain: Domain,
    /// The groups of the file, once an option or a note has asked for the groups.
    groups: OnceLock<Groups>,
}

impl LoadedMesh {
    /// Makes the mesh of a file. Constrained vertices and vertices between regions are fixed.
    pub(crate) fn new(source: MeshFile) -> Self {
        Self { domain: Domain::of_file(&source), source, groups: OnceLock::new() }
    }

    /// Makes the mesh of a file as [`new`](Self::new) does, but with its quadrilaterals, whose vertices may move.
    pub(crate) fn of_elements(source: MeshFile) -> Self {
        Self { domain: Domain::of_elements(&source), source, groups: OnceLock::new() }
    }

    /// Returns the groups of the file. The first call parses the whole file for them.
    pub(crate) fn groups(&self) -> Result<&Groups, CliError> {
        if let Some(groups) = self.groups.get() {
            return Ok(groups);
        }
        let groups = self.source.groups()?;
        Ok(self.groups.get_or_init(|| groups))
    }

    /// Returns the groups of lines of the file. If the file cannot name lines, no bytes are parsed.
    pub(crate) fn groups_of_lines(&self) -> Result<Vec<&Group>, CliError> {
        if !self.source.may_name_lines() {
            return Ok(Vec::new());
        }
        let is_of_lines = |group: &&Group| group.dimension == 1 && !group.vertices().is_empty();
        Ok(self.groups()?.iter().filter(is_of_lines).collect())
    }

    /// Returns the constraints of the file, without those on vertices of quadrilaterals that may move.
    pub(crate) fn constraints(&self) -> Cow<'_, Constraints> {
        match self.domain.moves_quadrilaterals() {
            true => Cow::Owned(self.source.constraints_beside_quadrilaterals()),
            false => Cow::Borrowed(self.source.constraints()),
        }
    }

    /// Returns the vertices inside the mesh at which elements of different regions meet, ascending.
    pub(crate) fn interface_vertices(&self) -> Vec<u32> {
        match self.domain.moves_quadrilaterals() {
            true => self.source.interfaces_of_elements().0,
            false => self.source.interface_vertices(),
        }
    }

    /// Returns the edges between elements of different regions. Vertices are those of the mesh, in which the chart may have copied
    /// vertices of the file.
    pub(crate) fn interface_edges(&self) -> Vec<[u32; 2]> {
        let of_triangles = self.source.regions();
        let of_quadrilaterals = self.source.quadrilateral_regions();
        let Mesh { points, triangles, quadrilaterals, .. } = self.mesh();
        if of_triangles.is_none() && quadrilaterals.is_empty() {
            return Vec::new();
        }
        let triangles = triangles.iter().enumerate();
        let triangles =
            triangles.map(|(t, corners)| (&corners[..], of_triangles.map_or(0, |of| of[t])));
        let in_file =
            self.source.proper_quadrilaterals().map(|(index, _)| of_quadrilaterals[index]);
        let quadrilaterals = quadrilaterals.iter().zip(in_file);
        let quadrilaterals = quadrilaterals.map(|(corners, region)| (&corners[..], region));
        interfaces(triangles.chain(quadrilaterals), points.len()).1
    }

    /// Returns the paths of all files that were read.
    pub(crate) fn paths(&self) -> Vec<PathBuf> {
        self.source.paths().map(Path::to_path_buf).collect()
    }

    /// Returns the vertices of an element of the mesh.
    ///
    /// # Panics
    /// Panics if the mesh has no such element.
    pub(crate) fn corners(&self, element: Element) -> &[u32] {
        match element {
            Element::Triangle(index) => &self.mesh().triangles[index],
            Element::Quadrilateral(index) => &self.mesh().quadrilaterals[index],
        }
    }

    /// Returns the mesh to smooth.
    pub(crate) fn mesh(&self) -> &Mesh {
        self.domain.mesh()
    }

    /// Returns the mesh with continued longitudes; `None` if longitudes are not continued.
    pub(crate) fn chart(&self) -> Option<&Chart> {
        self.domain.chart()
    }

    /// Returns the plane of the mesh; `None` if all z are equal, or z is data.
    pub(crate) fn plane(&self) -> Option<&Plane> {
        self.domain.plane()
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
    /// plane, the errors are those of the coordinates in space. Where longitudes are continued, the file stores them in a range
    /// of its own: 359.5 for -0.5, with larger errors.
    pub(crate) fn rounding(&self, size: f64) -> f64 {
        if let Some(plane) = self.plane().filter(|plane| plane.is_tilted()) {
            return plane.rounding();
        }
        let stored = match self.chart() {
            Some(_) => self.source.points().iter().fold(size, |size, [x, _]| size.max(x.abs())),
            None => size,
        };
        self.precision().error(stored)
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
        self.domain.set_plane(plane);
        Ok(remarks)
    }

    /// Lays `other`, a moved state of this mesh, out in the plane of this mesh, or continues its longitudes: each
    /// vertex is placed nearest to its position in this mesh. Does nothing if this mesh has no chart and no plane, or if
    /// the numbers of vertices differ.
    ///
    /// # Errors
    /// Returns an error if the third coordinates of `other` cannot be read.
    pub(crate) fn lay_out_likewise(&self, other: &mut LoadedMesh) -> Result<(), CliError> {
        if let Some(plane) = self.plane() {
            other.domain.set_plane(Some(likewise(plane, &other.source)?));
        }
        let Some(chart) = self.chart() else { return Ok(()) };
        let count = chart.original().points.len();
        if other.chart().is_none() && other.mesh().points.len() == count {
            let moved = chart.moved(other.mesh());
            other.domain.set_chart(moved);
        }
        Ok(())
    }

    /// Returns the vertices between regions that are fixed for a further reason, ascending.
    pub(crate) fn held_interface_vertices(&self) -> Vec<u32> {
        let mut is_held = vec![false; self.mesh().points.len()];
        self.mesh().fixed.iter().for_each(|&v| is_held[v as usize] = true);
        self.domain.interface_vertices().iter().for_each(|&v| is_held[v as usize] = false);
        let mut between = self.interface_vertices();
        between.retain(|&v| is_held[v as usize]);
        between
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
        self.source.write_with_fields(path, &self.domain.given(points), fields)
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
        self.source.write_to_with_fields(name, out, &self.domain.given(points), fields)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A former defect: the proof of a run with sliding expected smaller errors than the file stores across the date line.
    #[test]
    fn longitudes_round_as_the_file_stores_them() {
        let text = "OFF\n4 2 0\n359.5 0 0\n0.5 0 0\n0.5 1 0\n359.5 1 0\n3 0 1 2\n3 0 2 3\n";
        let file = MeshFile::from_bytes(Path::new("a.off"), text.into()).unwrap();
        let mut file = LoadedMesh::of_elements(file);
        assert_eq!(file.rounding(0.5), Precision::Double.error(0.5));
        file.domain.lay_out_on_sphere(Precision::Double).unwrap();
        assert!(file.chart().is_some());
        assert_eq!(file.rounding(0.5), Precision::Double.error(359.5));
    }
}
