//! Sample meshes in the formats of other programs, each in several legal layouts, with the facts that a reader must
//! report.

mod abaqus;
pub(crate) mod binary;
mod exodus;
mod gmsh;
mod grids;
mod nastran;
pub(crate) mod netcdf;
pub(crate) mod nets;
mod ply;
mod text;
pub(crate) mod ugrid;
mod vtk;
pub(crate) mod vtu;
mod xdmf;

use super::regions::interfaces;
use mesh_io::Format;
use mesh_io::Precision;
use std::ops::Range;
use support::Mesh;
use support::{SplitMix64, lattice};

/// A line inside the mesh, whose ends the file fixes.
pub(crate) const LINE: [u32; 2] = [7, 8];
/// A vertex inside the mesh that the file fixes by an element of its own.
pub(crate) const POINT: u32 = 9;
/// A quadrilateral inside the mesh, whose corners stay fixed. In lists of cells, it comes before triangle 10.
pub(crate) const QUADRILATERAL: [u32; 4] = [15, 16, 22, 21];
/// Indices of the vertex and the triangle whose locations in the file are checked.
pub(crate) const PROBED: (u32, usize) = (14, 17);
/// Index of the first triangle of the second region.
const SECOND_REGION: usize = 30;

/// A sample file, and the content that a reader must find.
pub(crate) struct Made {
    /// Difference from other samples of the format, for messages.
    pub(crate) what: String,
    /// File name with an extension of the format.
    pub(crate) name: &'static str,
    pub(crate) format: Format,
    pub(crate) precision: Precision,
    pub(crate) bytes: Vec<u8>,
    /// The mesh, with all digits of its points, even if the file rounds coordinates. Its fixed vertices are those of
    /// elements in the file, ascending.
    pub(crate) mesh: Mesh,
    pub(crate) regions: Option<Vec<u32>>,
    /// Number of the probed vertex in the file, and the range of bytes that contains its location.
    pub(crate) vertex: (u64, Range<usize>),
    /// Number of the probed triangle in the file, and the range of bytes that contains its location.
    pub(crate) triangle: (u64, Range<usize>),
    /// Byte ranges of lists. A file that is cut off inside a list must be refused.
    pub(crate) lists: Vec<Range<usize>>,
    /// Byte ranges of the numbers that give the lengths of lists.
    pub(crate) counts: Vec<Range<usize>>,
    /// Offsets of x and y of each vertex in a binary file; empty for text.
    pub(crate) coordinates: Vec<[usize; 2]>,
    /// Whether binary numbers are big-endian.
    pub(crate) big: bool,
}

impl Made {
    pub(crate) fn is_text(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// Returns whether the file lists edges, from which readers find the triangles.
    pub(crate) fn lists_edges(&self) -> bool {
        self.what.starts_with("net of edges")
    }

    /// Returns the points as a reader gets them, rounded to the precision of the file.
    pub(crate) fn points(&self) -> Vec<[f64; 2]> {
        self.mesh.points.iter().map(|p| p.map(|x| self.precision.rounded(x))).collect()
    }

    /// Returns the vertices between regions that no element fixes.
    pub(crate) fn interfaces(&self) -> Vec<u32> {
        let regions = self.regions.as_deref().unwrap_or_default();
        let mut between = interfaces(&self.mesh, regions);
        between.retain(|v| !self.mesh.fixed.contains(v));
        between
    }
}

/// Returns a mesh with 12 inner vertices whose coordinates have many digits.
pub(crate) fn base() -> Mesh {
    let mut mesh = lattice(5, 4);
    let on_boundary = support::boundary(&mesh);
    let mut rng = SplitMix64::new(11);
    for (point, _) in mesh.points.iter_mut().zip(on_boundary).filter(|(_, on)| !on) {
        *point = point.map(|x| x + rng.range(-0.2, 0.2));
    }
    mesh
}

/// Returns every variant of every format. `mesh` must have the triangles of [`base`] but any points.
pub(crate) fn all(mesh: &Mesh) -> Vec<Made> {
    let families = [
        text::all,
        grids::all,
        gmsh::all,
        ply::all,
        vtk::all,
        binary::all,
        exodus::all,
        ugrid::all,
        nets::all,
        xdmf::all,
        abaqus::all,
        nastran::all,
    ];
    families.into_iter().flat_map(|all| all(mesh)).collect()
}

/// Returns the mesh with the vertices `fixed` fixed.
fn fixing(mesh: &Mesh, fixed: impl IntoIterator<Item = u32>) -> Mesh {
    let mut fixed: Vec<_> = fixed.into_iter().collect();
    fixed.sort_unstable();
    fixed.dedup();
    Mesh { fixed, ..mesh.clone() }
}

/// Returns the corners of every triangle.
fn triples(mesh: &Mesh) -> Vec<Vec<u32>> {
    mesh.triangles.iter().map(|t| t.to_vec()).collect()
}

/// Returns the corners of every cell: the triangles, with the quadrilateral before triangle 10.
fn cells(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut cells = triples(mesh);
    cells.insert(10, QUADRILATERAL.to_vec());
    cells
}

/// Returns a triangle's region number in the file.
fn region(triangle: usize) -> i32 {
    if triangle < SECOND_REGION { 5 } else { 2 }
}

/// Returns the region of each triangle as a reader numbers regions, from 0.
fn regions(mesh: &Mesh) -> Option<Vec<u32>> {
    Some((0..mesh.triangles.len()).map(|t| u32::from(t >= SECOND_REGION)).collect())
}

/// Returns the third coordinate of a vertex.
fn z(vertex: usize) -> f64 {
    vertex as f64 * -0.75 + 1.5
}

/// Writes a number in one of several styles that programs use.
fn number(style: usize, x: f64) -> String {
    match style % 4 {
        0 => format!("{x}"),
        1 => format!("{x:e}"),
        2 => format!("{x:+.17}"),
        _ => format!("{x:E}"),
    }
}

/// Writes x and y in several styles, with blanks or a tab between.
fn point(vertex: usize, [x, y]: [f64; 2]) -> String {
    let blank = [" ", "\t", "   "][vertex % 3];
    format!("{}{blank}{}", number(vertex, x), number(vertex + 1, y))
}

fn points(mesh: &Mesh) -> impl Iterator<Item = (usize, String)> {
    mesh.points.iter().enumerate().map(|(i, &at)| (i, point(i, at)))
}

/// Returns vertex numbers as text, counted from `first` and separated by blanks.
fn joined(vertices: &[u32], first: u32) -> String {
    let numbers: Vec<_> = vertices.iter().map(|v| (v + first).to_string()).collect();
    numbers.join(" ")
}

/// A text file under construction.
#[derive(Default)]
struct Text {
    text: String,
    lists: Vec<Range<usize>>,
    counts: Vec<Range<usize>>,
}

impl Text {
    fn new(head: &str) -> Text {
        Text { text: head.to_owned(), ..Text::default() }
    }

    fn put(&mut self, text: &str) {
        self.text.push_str(text);
    }

    /// Adds the length of a list, and records the byte range of this number.
    fn count(&mut self, count: usize) {
        let start = self.text.len();
        self.text.push_str(&count.to_string());
        self.counts.push(start..self.text.len());
    }

    /// Adds the rows of a list. Returns the offset of each row.
    fn rows(&mut self, rows: impl IntoIterator<Item = String>) -> Vec<usize> {
        let mut starts = Vec::new();
        for row in rows {
            starts.push(self.text.len());
            self.text.push_str(&row);
            self.text.push('\n');
        }
        self.lists.push(starts[0]..starts[starts.len() - 1]);
        starts
    }

    /// Finishes the file. The last parameter has the numbers and the offsets of the probed vertex and triangle.
    fn made(
        self,
        what: &str,
        name: &'static str,
        format: Format,
        mesh: Mesh,
        [vertex, triangle]: [(u64, usize); 2],
    ) -> Made {
        Made {
            what: format!("{format}, {what}"),
            name,
            format,
            precision: Precision::Double,
            bytes: self.text.into_bytes(),
            mesh,
            regions: None,
            vertex: (vertex.0, vertex.1..vertex.1 + 1),
            triangle: (triangle.0, triangle.1..triangle.1 + 1),
            lists: self.lists,
            counts: self.counts,
            coordinates: Vec::new(),
            big: false,
        }
    }
}
