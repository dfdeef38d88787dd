//! Mesh with the bytes of its file, which is read once and rewritten with new coordinates alone.

use crate::content::constraints::{Constraints, edges_between_regions};
use crate::content::faces::Faces;
use crate::content::regions::{interface_vertices, interfaces};
use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::edit::numbers::{CoordinateEncoding, EncodedArrays, Offsets};
use crate::error::ReadError;
use crate::format::Format;
use crate::precision::Precision;
use crate::visit::parsed_mesh::ParsedMesh;
use crate::visit::reader::ReaderFunctions;
use std::fmt;
use std::path::Path;

/// Mesh with the bytes of its file.
///
/// The file's content stays in memory. [`write`](Self::write) replaces the coordinates of moved vertices and nothing
/// else. Numbering, comments, attributes, physical groups, third coordinates, node and element data, and line ends come
/// back byte for byte.
///
/// # Regions
/// Elements with equal entries in the file form a region. Entries are the material of an SMS 2dm, the reference of
/// Medit, the physical group and the entity of gmsh 2.2, and others. Attributes in the `.ele` of Triangle are compared
/// as numbers. Entries that differ for nearly every element count elements, and are left out. In formats without
/// entries, all elements form one region. The table of formats in `docs/formats.md` of
/// the repository lists the entries of each format.
///
/// [`interface_vertices`](Self::interface_vertices) returns the vertices between triangles of different regions. Two
/// surfaces of a model are two regions even within a common physical group.
///
/// # Facts, not decisions
/// A mesh file never changes after reading, and does not decide which vertices may move. A program decides by the facts
/// in [`constraints`](Self::constraints) and [`regions`](Self::regions).
pub struct MeshFile {
    parsed: ParsedMesh,
    reader: &'static ReaderFunctions,
    /// The main file, with its companions. The main file of a Triangle mesh is the `.node`.
    source: Source,
}

impl MeshFile {
    /// Makes a mesh file from a parsed mesh and its source.
    ///
    /// # Errors
    /// [`ReadError::Format`] if the mesh has no triangle, and no quadrilaterals that the options take.
    pub(crate) fn new(
        parsed: ParsedMesh,
        reader: &'static ReaderFunctions,
        source: Source,
    ) -> Result<MeshFile, ReadError> {
        let has_quadrilaterals = !parsed.quadrilaterals.is_empty();
        let is_taken = has_quadrilaterals && source.options.allows_quadrilaterals_alone;
        if parsed.triangles.is_empty() && !is_taken {
            if parsed.points.is_empty() {
                let remedy = "Check that the file is a mesh in the format that its ending names";
                return Err(source.error("neither vertices nor triangles were found", remedy));
            }
            let others: String = parsed
                .remarks
                .iter()
                .filter(|remark| matches!(remark, Remark::OtherElements { .. }))
                .map(|remark| format!(" and {remark}"))
                .collect();
            let problem = format!("{} vertices{others}, but no triangle", parsed.points.len());
            let remedy = "Meshes are read by their triangles: mesh the surface with triangles, and save all its elements";
            return Err(source.error(problem, remedy));
        }
        Ok(MeshFile { parsed, reader, source })
    }

    /// Returns the path of the main file; for a Triangle mesh, the path of the `.node`.
    pub fn path(&self) -> &Path {
        &self.source.path
    }

    /// Lists the paths of all files of the mesh, the main file first. A Triangle mesh has a `.node`, an `.ele` and
    /// optionally a `.poly`; an XDMF may be followed by files with its numbers.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.files().into_iter().map(|source| source.path.as_path())
    }

    /// Lists all files of the mesh in the order of [`paths`](Self::paths), with their bytes on the disk, compressed or
    /// not.
    pub fn contents(&self) -> impl Iterator<Item = (&Path, &[u8])> {
        self.files().into_iter().map(|source| (source.path.as_path(), source.stored()))
    }

    /// Returns x and y of each vertex, in the order and the unit of the file.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.parsed.points
    }

    /// Returns the vertex indices of each triangle, zero-based, in the order and the winding of the file.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.parsed.triangles
    }

    /// Returns the vertex indices of each quadrilateral, zero-based, in the order of the file, around it in either direction.
    /// A vertex may be listed twice.
    pub fn quadrilaterals(&self) -> &[[u32; 4]] {
        &self.parsed.quadrilaterals
    }

    /// Returns the quadrilaterals of four different vertices, each with its index in [`quadrilaterals`](Self::quadrilaterals).
    pub fn proper_quadrilaterals(&self) -> impl Iterator<Item = (usize, &[u32; 4])> + Clone {
        let is_proper =
            |(_, corners): &(usize, &[u32; 4])| (1..4).all(|k| !corners[..k].contains(&corners[k]));
        self.quadrilaterals().iter().enumerate().filter(is_proper)
    }

    /// Returns the lines, points, other elements and periodic pairs of the file.
    pub fn constraints(&self) -> &Constraints {
        &self.parsed.constraints
    }

    /// Returns the constraints of a program that moves the vertices of quadrilaterals: those of [`constraints`](Self::constraints)
    /// without the vertices of quadrilaterals, but with the vertices of quadrilaterals that list a vertex twice, or that belong to
    /// another piece of a partitioned mesh.
    pub fn constraints_beside_quadrilaterals(&self) -> Constraints {
        let ParsedMesh { quadrilaterals, constraints, beside_quadrilaterals, .. } = &self.parsed;
        let is_repeated = |corners: &&[u32; 4]| (1..4).any(|k| corners[..k].contains(&corners[k]));
        let repeated = quadrilaterals.iter().filter(is_repeated).flatten();
        let more: Vec<u32> = repeated.copied().collect();
        let without = |list: &[u32], before: usize| {
            let after = &list[before + 4 * quadrilaterals.len()..];
            [&list[..before], after, &more].concat()
        };
        Constraints {
            vertices: without(&constraints.vertices, beside_quadrilaterals[0]),
            anchored: without(&constraints.anchored, beside_quadrilaterals[1]),
            ..constraints.clone()
        }
    }

    /// Returns the region of each [quadrilateral](Self::quadrilaterals), by the numbers of [`regions`](Self::regions). Triangles
    /// have region 0 if `regions` is `None`.
    pub fn quadrilateral_regions(&self) -> &[u32] {
        &self.parsed.quadrilateral_regions
    }

    /// Returns the vertices inside the mesh at which elements of different [regions](Self#regions) meet, and the edges between
    /// such elements, both ascending. Triangles and quadrilaterals are elements; [`interface_vertices`](Self::interface_vertices)
    /// and [`interface_edges`](Self::interface_edges) know triangles alone.
    pub fn interfaces_of_elements(&self) -> (Vec<u32>, Vec<[u32; 2]>) {
        let parsed = &self.parsed;
        if parsed.regions.is_none() && parsed.quadrilaterals.is_empty() {
            return (Vec::new(), Vec::new());
        }
        interfaces(parsed.elements().zip(parsed.element_regions()), parsed.points.len())
    }

    /// Lists the corners of each quadrilateral and of each polygon of five or more corners, as vertex indices in the order
    /// of the file. [`write`](Self::write) moves no vertex by itself; programs keep the corners fixed, as
    /// [`constraints`](Self::constraints) contain them.
    pub fn other_faces(&self) -> impl Iterator<Item = &[u32]> {
        self.parsed.other_faces.iter()
    }

    /// Returns the quadrilaterals and polygons.
    pub(crate) fn faces(&self) -> &Faces {
        &self.parsed.other_faces
    }

    /// Returns the [region](Self#regions) of each triangle, in the order of [`triangles`](Self::triangles). Regions are
    /// numbered from 0 in the order of first occurrence. `None` if all triangles have equal regions.
    pub fn regions(&self) -> Option<&[u32]> {
        self.parsed.regions.as_deref()
    }

    /// Returns the name of the cell data that number the regions; `None` if the regions are entries of the format.
    pub(crate) fn region_array(&self) -> Option<&str> {
        self.parsed.region_array.as_deref()
    }

    /// Returns the vertices inside the mesh at which triangles of different [regions](Self#regions) meet, ascending.
    /// Vertices on the boundary are left out.
    pub fn interface_vertices(&self) -> Vec<u32> {
        let regions = self.parsed.regions.as_deref();
        regions.map_or_else(Vec::new, |regions| {
            interface_vertices(regions, &self.parsed.triangles, self.parsed.points.len())
        })
    }

    /// Returns the edges between triangles of different [regions](Self#regions), ascending.
    pub fn interface_edges(&self) -> Vec<[u32; 2]> {
        let regions = self.parsed.regions.as_deref();
        regions.map_or_else(Vec::new, |regions| {
            edges_between_regions(regions, &self.parsed.triangles, self.parsed.points.len())
        })
    }

    /// Returns the format of the file, which [`write`](Self::write) keeps.
    pub fn format(&self) -> Format {
        self.parsed.format
    }

    /// Returns the functions of the reader that has read the file.
    pub(crate) fn reader(&self) -> &'static ReaderFunctions {
        self.reader
    }

    /// Returns the main file, with its companions.
    pub(crate) fn source(&self) -> &Source {
        &self.source
    }

    /// Returns the files of the mesh, the main file first.
    pub(crate) fn files(&self) -> Vec<&Source> {
        self.source.files().collect()
    }

    /// Returns the index of the file with the coordinates, in the order of [`files`](Self::files).
    pub(crate) fn file_index(&self) -> usize {
        self.parsed.file_index
    }

    pub(crate) fn x_offsets(&self) -> &Offsets {
        &self.parsed.x_offsets
    }

    pub(crate) fn offset_vertices(&self) -> Option<&[u32]> {
        self.parsed.owners.as_deref()
    }

    pub(crate) fn encoding(&self) -> CoordinateEncoding {
        self.parsed.encoding
    }

    /// Returns another array with bytes of the points, for messages; `None` if the points have bytes of their own.
    pub(crate) fn shared_with(&self) -> Option<&str> {
        self.parsed.shared_with.as_deref()
    }

    /// Returns the encoded array of the points; `None` if the file stores points unencoded.
    pub(crate) fn encoded_points(&self) -> Option<&dyn EncodedArrays> {
        self.parsed.encoded.as_deref()
    }

    /// Returns the precision of coordinates in the file, to which [`write`](Self::write) rounds.
    pub fn precision(&self) -> Precision {
        self.parsed.encoding.precision()
    }

    /// Returns remarks for the user, such as on elements other than triangles.
    pub fn remarks(&self) -> &[Remark] {
        &self.parsed.remarks
    }

    /// Returns the names of arrays of real numbers on vertices besides x and y: depths, third coordinates that differ,
    /// point data. [`write`](Self::write) keeps the numbers, which then no longer fit moved vertices.
    /// [`point_fields`](Self::point_fields) reads the arrays.
    pub fn data_names(&self) -> &[String] {
        &self.parsed.data
    }

    /// Returns whether the third coordinates of vertices differ. [`point_fields`](Self::point_fields) then returns them
    /// as the field for which [`PointField::is_third_of_points`](crate::PointField::is_third_of_points) is true. In formats whose third number is a height or a depth by definition (SMS
    /// 2dm, MIKE), and in formats whose heights are arrays of data (ADCIRC, FVCOM, SELAFIN, UGRID), vertices have no third
    /// coordinate.
    pub fn has_third_coordinates(&self) -> bool {
        self.parsed.has_z && !matches!(self.format(), Format::Sms2dm | Format::Mike)
    }

    /// Returns whether an array of data on vertices has the name, apart from third coordinates.
    pub fn has_data(&self, name: &str) -> bool {
        let is_coordinate = name == "z" && self.has_third_coordinates();
        match is_coordinate {
            true => self.parsed.has_data_named_z,
            false => self.data_names().iter().any(|data| data == name),
        }
    }

    /// Returns whether the file says that x is longitude and y latitude in degrees (UGRID). `Some(false)` if it gives
    /// another unit, such as meters; `None` if it gives no unit.
    pub fn says_degrees(&self) -> Option<bool> {
        self.parsed.says_degrees
    }

    /// Returns whether vertices have parameters on surfaces of a model, as in gmsh 4.1. [`write`](Self::write) keeps
    /// the parameters; [`plane_parameters`](Self::plane_parameters) updates them.
    pub fn has_parameters(&self) -> bool {
        self.parsed.has_parameters
    }

    /// Returns whether the file stores centers of faces or edges, as in UGRID. [`write`](Self::write) keeps the
    /// centers; [`centers`](Self::centers) updates them.
    pub fn has_centers(&self) -> bool {
        self.parsed.has_centers
    }
}

impl fmt::Debug for MeshFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let paths: Vec<_> = self.paths().collect();
        f.debug_struct("MeshFile")
            .field("paths", &paths)
            .field("format", &self.parsed.format)
            .field("vertices", &self.parsed.points.len())
            .field("triangles", &self.parsed.triangles.len())
            .finish_non_exhaustive()
    }
}
