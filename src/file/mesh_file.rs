//! A mesh with its file, which is read once and written again with nothing changed but coordinates.

use crate::chart::Chart;
use crate::error::{MeshError, ReadError};
use crate::file::curves::{Curves, between_regions};
use crate::file::format::Format;
use crate::file::numbers::{Encoded, Numbers, Places};
use crate::file::parsed::Parsed;
use crate::file::regions::interface_vertices;
use crate::file::source::Source;
use crate::mesh::{Mesh, Precision};
use crate::periodic::{Motion, Periodic};
use std::fmt;
use std::path::Path;

/// A mesh with the file it was read from.
///
/// Its content is kept, so that [`write`](Self::write) replaces the coordinates of moved vertices and
/// nothing else: numbering, comments, attributes, physical groups, third coordinates, node and
/// element data, line ends come back byte for byte.
///
/// # Regions
/// Triangles are of one region if the file says the same of them:
///
/// | format | a region has the same |
/// |---|---|
/// | Triangle | attributes in the `.ele`, all that its first line announces, compared as numbers |
/// | gmsh 2.2 | first and second tag: physical group and geometrical entity |
/// | gmsh 4.1 | entity of the model, and so the physical groups of that entity |
/// | Medit, FreeFem | reference |
/// | SMS 2dm | material |
/// | OBJ | material, group and object |
/// | SU2 | zone |
/// | VTK, XDMF | cell data of a usual name, such as `gmsh:physical`, `medit:ref`, `MaterialIDs` |
/// | STL | solid |
/// | Exodus II | block |
/// | MED | family |
/// | CGNS | section |
/// | ADCIRC, SCHISM, SELAFIN, OFF | all triangles are of one |
///
/// Vertices between triangles of different regions, [`interface_vertices`](Self::interface_vertices), are listed in
/// [`Mesh::fixed`], so that regions keep their shapes. Two surfaces of a model are two regions even where they belong to
/// one physical group. [`free_interfaces`](Self::free_interfaces) takes these vertices out of the list.
///
/// # What may move
/// What a user names is fixed beside what the file fixes:
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
    /// The bytes at which the x of vertices start in the part that has the coordinates.
    x_at: Places,
    /// The vertex of each of these, if there are several to a vertex.
    owners: Option<Vec<u32>>,
    /// How that part has the coordinates.
    numbers: Numbers,
    /// Which of the parts has the coordinates.
    part: usize,
    /// The points, if that part has them encoded.
    encoded: Option<Box<dyn Encoded>>,
    regions: Option<Vec<u32>>,
    curves: Curves,
    /// Whether vertices between regions were freed.
    has_free_interfaces: bool,
    /// Vertices fixed only for lying between regions. The mesh's list of fixed vertices ends with them.
    interfaces: Vec<u32>,
    /// All files of the mesh, the one with the vertices first: of a Triangle mesh its `.node`,
    /// `.ele` and, if there is one, `.poly`.
    sources: Vec<Source>,
    /// How the mesh was laid out on a sphere, if it had to be.
    chart: Option<Chart>,
}

impl MeshFile {
    /// Makes it of what a reader returned.
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

    /// The file that was read; of a Triangle mesh its `.node`.
    pub fn path(&self) -> &Path {
        &self.sources[0].path
    }

    /// All files that were read: of a Triangle mesh its `.node`, `.ele` and, if there is one, `.poly`; of an XDMF the files beside it
    /// that it has numbers in.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.parts().into_iter().map(|source| source.path.as_path())
    }

    /// All files that were read, in the order of [`paths`](Self::paths), with their bytes as they were read.
    pub fn contents(&self) -> impl Iterator<Item = (&Path, &[u8])> {
        self.parts().into_iter().map(|source| {
            let bytes = source.packed.as_ref().map_or(&source.bytes, |packed| &packed.bytes);
            (source.path.as_path(), &bytes[..])
        })
    }

    /// The mesh, vertices and triangles in the order of the file.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// How the mesh was laid out by [`lay_out_on_sphere`](Self::lay_out_on_sphere), if there was need for it.
    pub fn chart(&self) -> Option<&Chart> {
        self.chart.as_ref()
    }

    /// The mesh as the file has it, be it laid out on a sphere or not.
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

    /// The [region](Self#regions) of each triangle, in the order of [`Mesh::triangles`]. Regions are numbered from 0 in
    /// the order in which the file first names them. `None` if all triangles are of one region.
    pub fn regions(&self) -> Option<&[u32]> {
        self.regions.as_deref()
    }

    /// The vertices that are fixed only because triangles of different [regions](Self#regions) meet there, ascending.
    /// Those on the boundary, on line elements and the like are not among them.
    ///
    /// Empty after [`free_interfaces`](Self::free_interfaces).
    pub fn interface_vertices(&self) -> &[u32] {
        &self.interfaces
    }

    /// Takes the [`interface_vertices`](Self::interface_vertices) out of [`Mesh::fixed`], so that they move like any
    /// other vertex and regions change their shapes. Vertices that the file fixes by other means, such as those on curves
    /// of a gmsh 4.1 model, stay fixed where regions meet too.
    pub fn free_interfaces(&mut self) {
        self.has_free_interfaces = true;
        let held = std::mem::take(&mut self.interfaces);
        let fixed = &mut self.mesh.fixed;
        fixed.truncate(fixed.len() - held.len());
    }

    /// The edges along which vertices inside the mesh may slide: line elements, segments, and the edges between triangles of different
    /// [regions](Self#regions), unless [`free_interfaces`](Self::free_interfaces) was called. For
    /// [`Slide::lines`](crate::Slide::lines).
    pub fn lines(&self) -> Vec<[u32; 2]> {
        let Mesh { points, triangles, .. } = &self.mesh;
        let mut lines = self.curves.lines.clone();
        if let (Some(regions), false) = (&self.regions, self.has_free_interfaces) {
            lines.extend(between_regions(regions, triangles, points.len()));
        }
        lines
    }

    /// The vertices that do not slide: points and corners of the file, vertices of quadrilaterals and polygons, and those of
    /// [`fix`](Self::fix) and [`fix_all_but`](Self::fix_all_but). For [`Slide::held`](crate::Slide::held).
    pub fn held_vertices(&self) -> &[u32] {
        &self.curves.held
    }

    /// The vertices that belong together in pairs, as where a model is periodic: those of gmsh's `$Periodic`. For
    /// [`Slide::periodic`](crate::Slide::periodic).
    pub fn periodic(&self) -> &[Periodic] {
        &self.curves.periodic
    }

    /// The motions of a periodic model that take vertices of the boundary to others, which the file does not list: those of SU2's
    /// `NPERIODIC`. For [`Slide::pair_by`](crate::Slide::pair_by).
    pub fn periodic_motions(&self) -> &[Motion] {
        &self.curves.motions
    }

    /// Whether the file says that its model is periodic, but not in a way that could be read: any vertices of the boundary may belong
    /// together in pairs.
    pub fn has_unknown_pairs(&self) -> bool {
        self.curves.has_unknown_pairs
    }

    /// Adds vertices to [`Mesh::fixed`], so that they stay where they are, like those that the file fixes. In any order,
    /// repeats allowed.
    ///
    /// They are no [`interface_vertices`](Self::interface_vertices) from then on, so that
    /// [`free_interfaces`](Self::free_interfaces) leaves them fixed, be it called before or after.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if there is no such vertex; then none is added.
    pub fn fix(&mut self, vertices: &[u32]) -> Result<(), MeshError> {
        let held = self.marked(vertices)?;
        self.hold(held);
        Ok(())
    }

    /// Adds all vertices but these to [`Mesh::fixed`], as [`fix`](Self::fix) does. These are not freed where they are fixed
    /// already.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if there is no such vertex; then none is added.
    pub fn fix_all_but(&mut self, vertices: &[u32]) -> Result<(), MeshError> {
        let mut held = self.marked(vertices)?;
        held.iter_mut().for_each(|held| *held = !*held);
        self.hold(held);
        Ok(())
    }

    /// For each vertex of the mesh, whether it is among these.
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

    /// Adds the vertices for which this holds to those fixed for other reasons than lying between regions.
    fn hold(&mut self, mut held: Vec<bool>) {
        let all = (0..).zip(&held).filter(|&(_, &held)| held);
        self.curves.held.extend(all.map(|(vertex, _)| vertex));
        let Mesh { fixed, .. } = &mut self.mesh;
        fixed.truncate(fixed.len() - self.interfaces.len());
        self.interfaces.retain(|&vertex| !held[vertex as usize]);
        // Those that are fixed already are not listed again.
        fixed.iter().for_each(|&vertex| held[vertex as usize] = false);
        fixed.extend((0..).zip(held).filter(|&(_, held)| held).map(|(vertex, _)| vertex));
        fixed.extend_from_slice(&self.interfaces);
    }

    /// The format it was read in, and will be written in.
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

    /// The points, if the file has them encoded.
    pub(crate) fn encoded(&self) -> Option<&dyn Encoded> {
        self.encoded.as_deref()
    }

    /// How many digits of coordinates the file holds. [`write`](Self::write) rounds to them; for
    /// [`Options::stored`](crate::Options::stored), so that a run judges the values as they will be written.
    pub fn precision(&self) -> Precision {
        self.numbers.precision()
    }

    /// Remarks for the user on what the file holds besides triangles, one line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The names of the real numbers that the file gives vertices besides x and y: depths, third coordinates that are not
    /// all the same, point data. [`write`](Self::write) keeps them as they are, so that they no longer fit where vertices
    /// move; see [`point_fields`](Self::point_fields).
    pub fn data_names(&self) -> &[String] {
        &self.data
    }

    /// Whether the file gives vertices parameters on surfaces of a model, as gmsh 4.1 may. [`write`](Self::write) keeps them;
    /// see [`plane_parameters`](Self::plane_parameters).
    pub fn has_parameters(&self) -> bool {
        self.has_parameters
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
