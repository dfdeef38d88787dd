//! A mesh with its file, which is read once and written with nothing changed but coordinates.

use crate::chart::Chart;
use crate::error::{MeshError, ReadError};
use crate::file::curves::{Curves, between_regions};
use crate::file::format::Format;
use crate::file::numbers::{Encoded, Numbers, Places};
use crate::file::parsed::Parsed;
use crate::file::regions::interface_vertices;
use crate::file::source::Source;
use crate::mesh::Mesh;
use crate::periodic::{Motion, Periodic};
use crate::precision::Precision;
use std::fmt;
use std::path::Path;

/// A mesh with the file it was read from.
///
/// The file's content is kept. [`write`](Self::write) replaces the coordinates of moved vertices and nothing else.
/// Numbering, comments, attributes, physical groups, third coordinates, node and element data, and line ends come back
/// byte for byte.
///
/// # Regions
/// Triangles are of one region if the file has the same entries for them:
///
/// | format | a region has the same |
/// |---|---|
/// | Triangle | attributes in the `.ele`, all that its first line announces, compared as numbers |
/// | gmsh 2.2 | first and second tag: physical group and geometrical entity |
/// | gmsh 4.0, 4.1 | entity of the model, and so the physical groups of that entity |
/// | Medit, FreeFem | reference |
/// | SMS 2dm | material |
/// | OBJ | material, group and object |
/// | SU2 | zone |
/// | VTK, XDMF | cell data of a usual name, such as `gmsh:physical`, `medit:ref`, `MaterialIDs` |
/// | STL | solid |
/// | Exodus II | block |
/// | MED | family |
/// | CGNS | section |
/// | Abaqus | set that a list of elements names, and section |
/// | Nastran | property |
/// | ADCIRC, SCHISM, SELAFIN, OFF | all triangles are of one |
///
/// Vertices between triangles of different regions, [`interface_vertices`](Self::interface_vertices), are listed in
/// [`Mesh::fixed`], so that regions keep their shapes. Two surfaces of a model are two regions even where they belong to
/// one physical group. [`free_interfaces`](Self::free_interfaces) takes these vertices out of the list.
///
/// # What may move
/// What a user names is fixed in addition to what the file fixes:
///
/// ```no_run
/// # use gpu_smooth::{MeshFile, Topology, select};
/// # use std::path::Path;
/// # fn f() -> Result<(), Box<dyn std::error::Error>> {
/// let mut file = MeshFile::read(Path::new("part.msh"))?;
/// let groups = file.groups()?;
/// // The vertices of a group stay where they are,
/// file.fix(groups.find("inlet")?.vertices())?;
/// // and of all others only those inside of a region may move.
/// let steel = groups.find("physical:surface:2")?;
/// let inside = select::vertices_inside(&Topology::new(file.mesh())?, steel.triangles());
/// file.fix_all_but(&inside)?;
/// # Ok(())
/// # }
/// ```
pub struct MeshFile {
    mesh: Mesh,
    format: Format,
    notes: Vec<String>,
    data: Vec<String>,
    has_parameters: bool,
    has_centers: bool,
    /// The bytes at which the x of vertices start in the part that has the coordinates.
    x_at: Places,
    /// The vertex of each offset in `x_at`, if a vertex may have several.
    owners: Option<Vec<u32>>,
    /// How that part has the coordinates.
    numbers: Numbers,
    /// Which of the parts has the coordinates.
    part: usize,
    /// The points, if that part has them encoded.
    encoded: Option<Box<dyn Encoded>>,
    regions: Option<Vec<u32>>,
    curves: Curves,
    /// Whether [`free_interfaces`](Self::free_interfaces) was called.
    has_free_interfaces: bool,
    /// Vertices that are fixed only because they lie between regions. They are the last ones of the mesh's fixed
    /// vertices.
    interfaces: Vec<u32>,
    /// All files of the mesh, the one with the vertices first. For a Triangle mesh, these are the `.node`, the `.ele`
    /// and, if there is one, the `.poly`.
    sources: Vec<Source>,
    /// How the mesh was laid out on a sphere, if that was needed.
    chart: Option<Chart>,
}

impl MeshFile {
    /// Makes a mesh file of what a reader returned.
    ///
    /// # Errors
    /// [`ReadError::Format`] if there is no triangle.
    pub(crate) fn new(parsed: Parsed, sources: Vec<Source>) -> Result<MeshFile, ReadError> {
        let Parsed {
            format,
            mut mesh,
            x_at,
            owners,
            numbers,
            part,
            encoded,
            regions,
            curves,
            notes,
            data,
            has_parameters,
            has_centers,
        } = parsed;
        let Mesh { points, triangles, fixed } = &mut mesh;
        let interfaces = regions
            .as_ref()
            .map(|regions| interface_vertices(regions, triangles, points.len(), fixed))
            .unwrap_or_default();
        if triangles.is_empty() {
            let problem = format!("{} vertices, but no triangle", points.len());
            let remedy = "Only triangles are smoothed: mesh the surface with them, and save all its elements";
            return Err(sources[0].error(problem, remedy));
        }
        fixed.extend_from_slice(&interfaces);
        Ok(MeshFile {
            mesh,
            format,
            notes,
            data,
            has_parameters,
            has_centers,
            x_at,
            owners,
            numbers,
            part,
            encoded,
            regions,
            curves,
            has_free_interfaces: false,
            interfaces,
            sources,
            chart: None,
        })
    }

    /// Returns the path of the file that was read; for a Triangle mesh, that of its `.node`.
    pub fn path(&self) -> &Path {
        &self.sources[0].path
    }

    /// All files that were read: of a Triangle mesh its `.node`, `.ele` and, if there is one, `.poly`; of an XDMF the files beside it
    /// that it has numbers in.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.parts().into_iter().map(|source| source.path.as_path())
    }

    /// Lists all files that were read, in the order of [`paths`](Self::paths), with their bytes.
    pub fn contents(&self) -> impl Iterator<Item = (&Path, &[u8])> {
        self.parts().into_iter().map(|source| {
            let bytes = source.packed.as_ref().map_or(&source.bytes, |packed| &packed.bytes);
            (source.path.as_path(), &bytes[..])
        })
    }

    /// Returns the mesh. Vertices and triangles are in the order of the file.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns how [`lay_out_on_sphere`](Self::lay_out_on_sphere) laid the mesh out; `None` if that was not needed.
    pub fn chart(&self) -> Option<&Chart> {
        self.chart.as_ref()
    }

    /// Returns the mesh as the file has it, even if [`mesh`](Self::mesh) is laid out on a sphere.
    pub fn original(&self) -> &Mesh {
        self.chart.as_ref().map_or(&self.mesh, Chart::original)
    }

    pub(crate) fn take_chart(&mut self, chart: Chart) {
        self.curves.held.extend_from_slice(chart.held());
        let Mesh { points, triangles, .. } = chart.mesh();
        self.mesh.points.clone_from(points);
        self.mesh.triangles.clone_from(triangles);
        self.chart = Some(chart);
    }

    /// Returns the [region](Self#regions) of each triangle, in the order of [`Mesh::triangles`]. Regions are numbered
    /// from 0 in the order in which the file first names them. `None` if all triangles are of one region.
    pub fn regions(&self) -> Option<&[u32]> {
        self.regions.as_deref()
    }

    /// Returns the vertices that are fixed only because triangles of different [regions](Self#regions) meet there,
    /// ascending. Vertices that are fixed for another reason too, such as being on the boundary or on line elements,
    /// are left out.
    ///
    /// The list is empty after [`free_interfaces`](Self::free_interfaces).
    pub fn interface_vertices(&self) -> &[u32] {
        &self.interfaces
    }

    /// Takes the [`interface_vertices`](Self::interface_vertices) out of [`Mesh::fixed`], so that they move like any
    /// other vertex and regions change their shapes. Vertices that are fixed for another reason, such as those on
    /// curves of a gmsh 4.1 model, stay fixed.
    pub fn free_interfaces(&mut self) {
        self.has_free_interfaces = true;
        let held = std::mem::take(&mut self.interfaces);
        let fixed = &mut self.mesh.fixed;
        fixed.truncate(fixed.len() - held.len());
    }

    /// Returns the vertices between [regions](Self#regions), and not on the boundary, that are fixed for another reason
    /// too, ascending: line elements, points or quadrilaterals of the file are there, or [`fix`](Self::fix) was called.
    /// [`free_interfaces`](Self::free_interfaces) leaves them fixed.
    pub fn held_interface_vertices(&self) -> Vec<u32> {
        let Mesh { points, triangles, fixed } = &self.mesh;
        let Some(regions) = &self.regions else { return Vec::new() };
        let mut is_held = vec![false; points.len()];
        fixed.iter().for_each(|&v| is_held[v as usize] = true);
        self.interfaces.iter().for_each(|&v| is_held[v as usize] = false);
        let mut between = interface_vertices(regions, triangles, points.len(), &[]);
        between.retain(|&v| is_held[v as usize]);
        between
    }

    /// Returns the edges along which vertices inside the mesh may slide, for [`Slide::lines`](crate::Slide::lines).
    /// These are line elements, segments, and the edges between triangles of different [regions](Self#regions), unless
    /// [`free_interfaces`](Self::free_interfaces) was called.
    pub fn lines(&self) -> Vec<[u32; 2]> {
        let Mesh { points, triangles, .. } = &self.mesh;
        let mut lines = self.curves.lines.clone();
        if let (Some(regions), false) = (&self.regions, self.has_free_interfaces) {
            lines.extend(between_regions(regions, triangles, points.len()));
        }
        lines
    }

    /// Returns the vertices that do not slide, for [`Slide::held`](crate::Slide::held). These are points and corners of
    /// the file, vertices of quadrilaterals and polygons, and those of [`fix`](Self::fix) and
    /// [`fix_all_but`](Self::fix_all_but).
    pub fn held_vertices(&self) -> &[u32] {
        &self.curves.held
    }

    /// Returns the pairs of vertices that belong together in a periodic model, from gmsh's `$Periodic`. For
    /// [`Slide::periodic`](crate::Slide::periodic).
    pub fn periodic(&self) -> &[Periodic] {
        &self.curves.periodic
    }

    /// Returns the motions of a periodic model that take vertices of the boundary to others, if the file does not list
    /// the pairs, from SU2's `NPERIODIC`. For [`Slide::pair_by`](crate::Slide::pair_by).
    pub fn periodic_motions(&self) -> &[Motion] {
        &self.curves.motions
    }

    /// Whether the file says that its model is periodic, but the pairs could not be read. Any vertices of the boundary
    /// may then be pairs.
    pub fn has_unknown_pairs(&self) -> bool {
        self.curves.has_unknown_pairs
    }

    /// Adds vertices to [`Mesh::fixed`], so that they stay where they are, like those that the file fixes. `vertices`
    /// may be in any order, with repeats.
    ///
    /// They are no longer [`interface_vertices`](Self::interface_vertices): [`free_interfaces`](Self::free_interfaces)
    /// leaves them fixed, whether it is called before or after.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if a vertex does not exist; then none is added.
    pub fn fix(&mut self, vertices: &[u32]) -> Result<(), MeshError> {
        let held = self.marked(vertices)?;
        self.hold(held);
        Ok(())
    }

    /// Adds all vertices except these to [`Mesh::fixed`], as [`fix`](Self::fix) does. Of these vertices, those that are
    /// fixed already stay so.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if a vertex does not exist; then none is added.
    pub fn fix_all_but(&mut self, vertices: &[u32]) -> Result<(), MeshError> {
        let mut held = self.marked(vertices)?;
        held.iter_mut().for_each(|held| *held = !*held);
        self.hold(held);
        Ok(())
    }

    /// Returns for each vertex of the mesh whether it is in the list.
    fn marked(&self, vertices: &[u32]) -> Result<Vec<bool>, MeshError> {
        let mut marked = vec![false; self.mesh.points.len()];
        for &vertex in vertices {
            let count = marked.len();
            *marked.get_mut(vertex as usize).ok_or(MeshError::IndexOutOfRange {
                triangle: None,
                vertex,
                vertices: count,
            })? = true;
        }
        Ok(marked)
    }

    /// Fixes the vertices that are marked in `held`, for another reason than lying between regions.
    fn hold(&mut self, mut held: Vec<bool>) {
        let all = (0..).zip(&held).filter(|&(_, &held)| held);
        self.curves.held.extend(all.map(|(vertex, _)| vertex));
        let Mesh { fixed, .. } = &mut self.mesh;
        fixed.truncate(fixed.len() - self.interfaces.len());
        self.interfaces.retain(|&vertex| !held[vertex as usize]);
        // Vertices that are fixed already must not be listed again.
        fixed.iter().for_each(|&vertex| held[vertex as usize] = false);
        fixed.extend((0..).zip(held).filter(|&(_, held)| held).map(|(vertex, _)| vertex));
        fixed.extend_from_slice(&self.interfaces);
    }

    /// Returns the format that the file was read in, which is also written.
    pub fn format(&self) -> Format {
        self.format
    }

    pub(crate) fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// All files of the mesh, each of the sources with those beside it.
    pub(crate) fn parts(&self) -> Vec<&Source> {
        self.sources.iter().flat_map(Source::parts).collect()
    }

    /// Which of the parts has the coordinates.
    pub(crate) fn part(&self) -> usize {
        self.part
    }

    pub(crate) fn x_at(&self) -> &Places {
        &self.x_at
    }

    pub(crate) fn owners(&self) -> Option<&[u32]> {
        self.owners.as_deref()
    }

    pub(crate) fn numbers(&self) -> Numbers {
        self.numbers
    }

    /// Returns the encoded points, if the file has them encoded.
    pub(crate) fn encoded(&self) -> Option<&dyn Encoded> {
        self.encoded.as_deref()
    }

    /// Returns the precision of coordinates in the file, to which [`write`](Self::write) rounds. As
    /// [`Options::stored`](crate::Options::stored), it makes a run judge the values that will be written.
    pub fn precision(&self) -> Precision {
        self.numbers.precision()
    }

    /// Returns remarks for the user on what the file holds besides triangles, one line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the names of the real numbers that the file gives vertices besides x and y: depths, third coordinates
    /// that differ, point data. [`write`](Self::write) keeps these numbers, so they no longer fit where vertices move.
    /// [`point_fields`](Self::point_fields) reads them.
    pub fn data_names(&self) -> &[String] {
        &self.data
    }

    /// Whether the file gives vertices parameters on surfaces of a model, as gmsh 4.1 may. [`write`](Self::write) keeps
    /// these parameters; [`plane_parameters`](Self::plane_parameters) updates them.
    pub fn has_parameters(&self) -> bool {
        self.has_parameters
    }

    /// Whether the file has the centers of faces or edges, as UGRID may. [`write`](Self::write) keeps them;
    /// [`centers`](Self::centers) updates them.
    pub fn has_centers(&self) -> bool {
        self.has_centers
    }
}

impl fmt::Debug for MeshFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let paths: Vec<_> = self.paths().collect();
        f.debug_struct("MeshFile")
            .field("paths", &paths)
            .field("format", &self.format)
            .field("vertices", &self.mesh.points.len())
            .field("triangles", &self.mesh.triangles.len())
            .finish_non_exhaustive()
    }
}
