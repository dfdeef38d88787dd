//! A mesh file: read once, written with moved vertices and otherwise as it was.

use crate::error::{Location, ReadError, WriteError};
use crate::file::binary::Order;
use crate::file::detect::{self, Content};
use crate::file::elided_rows::Implied;
use crate::file::gmsh;
use crate::file::replace::{self, Job};
use crate::file::rewrite::Patch;
use crate::file::source::{Parsed, Source};
use crate::file::text;
use crate::file::triangle::{self, Names};
use crate::mesh::Mesh;
use std::fmt;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A file format that is read and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// The `.node` and `.ele` of the mesh generator Triangle, with the segments of a `.poly`
    /// beside them.
    Triangle,
    /// gmsh's `.msh`, versions 2.0 to 2.2, as text.
    Gmsh22,
    /// gmsh's `.msh`, versions 2.0 to 2.2, in binary.
    Gmsh22Binary,
    /// gmsh's `.msh`, version 4.1, as text.
    Gmsh41,
    /// gmsh's `.msh`, version 4.1, in binary.
    Gmsh41Binary,
}

impl Format {
    /// Every format.
    pub const ALL: [Format; 5] = [
        Format::Triangle,
        Format::Gmsh22,
        Format::Gmsh22Binary,
        Format::Gmsh41,
        Format::Gmsh41Binary,
    ];

    /// Endings that promise this format, the usual one first.
    fn endings(self) -> &'static [&'static str] {
        match self {
            Format::Triangle => &[".node", ".ele"],
            _ => &[".msh"],
        }
    }

    /// Which of the sources lists the triangles.
    fn part_with_triangles(self) -> usize {
        match self {
            Format::Triangle => 1,
            _ => 0,
        }
    }

    pub(crate) fn has_ending_of(self, path: &Path) -> bool {
        detect::has_ending(path, self.endings())
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Format::Triangle => "Triangle .node/.ele",
            Format::Gmsh22 => "gmsh 2.2 ASCII",
            Format::Gmsh22Binary => "gmsh 2.2 binary",
            Format::Gmsh41 => "gmsh 4.1 ASCII",
            Format::Gmsh41Binary => "gmsh 4.1 binary",
        })
    }
}

/// Where a vertex or triangle stands in its file. Displayed as `la.1.ele:18`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub path: PathBuf,
    /// Where in it.
    pub location: Location,
    /// The file's own number or tag for it.
    pub label: u64,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.path.display(), self.location)
    }
}

/// A mesh with the file it was read from.
///
/// Its content is kept, so that [`write`](Self::write) replaces the coordinates of moved vertices and
/// nothing else: numbering, comments, attributes, physical groups, third coordinates, node and
/// element data, line ends come back byte for byte.
pub struct MeshFile {
    mesh: Mesh,
    format: Format,
    notes: Vec<String>,
    /// Where the x of each vertex starts in the first of the sources.
    x_at: Vec<usize>,
    /// Of the bytes of its numbers, if they are not text.
    order: Option<Order>,
    /// All files of the mesh, the one with the vertices first: of a Triangle mesh its `.node`,
    /// `.ele` and, if there is one, `.poly`.
    sources: Vec<Source>,
    /// What was left out of the source with the triangles.
    implied: Implied,
}

impl MeshFile {
    /// Reads a mesh, in the format its content shows.
    ///
    /// A Triangle mesh is named by its `.node`, by its `.ele`, or without either ending.
    ///
    /// # Errors
    /// [`ReadError`] if a file is missing or cannot be read, is in none of the formats of
    /// [`Format`], does not hold what its format asks for, or holds other than first-order
    /// elements of the plane, or no triangle.
    pub fn read(path: &Path) -> Result<MeshFile, ReadError> {
        let names = Names::of(path);
        let has_half = names.node.is_file() || names.ele.is_file();
        let has_ending = Format::Triangle.has_ending_of(path);
        if has_half && !has_ending && !path.is_file() {
            return Self::read(&names.node);
        }
        let given = match Source::load(path) {
            Err(_) if has_half && has_ending && !path.exists() => half_missing(path, &names)?,
            given => given?,
        };
        let file = match detect::content(&given)? {
            Content::Gmsh => {
                let (version, parsed) = gmsh::parse(&given)?;
                let format = match (version, parsed.order) {
                    (gmsh::Version::V2, None) => Format::Gmsh22,
                    (gmsh::Version::V2, Some(_)) => Format::Gmsh22Binary,
                    (gmsh::Version::V4, None) => Format::Gmsh41,
                    (gmsh::Version::V4, Some(_)) => Format::Gmsh41Binary,
                };
                Self::new(format, parsed, vec![given])
            }
            Content::Triangle(names) => Self::read_triangle(given, &names)?,
        };
        if file.mesh.triangles.is_empty() {
            let problem = format!("{} vertices, but no triangle", file.mesh.points.len());
            let remedy = "Only triangles are smoothed: mesh the surface with them, and save all its elements";
            return Err(file.sources[0].error(problem, remedy));
        }
        Ok(file)
    }

    fn read_triangle(given: Source, names: &Names) -> Result<MeshFile, ReadError> {
        let load = |path: &Path| match Source::load(path) {
            Err(_) if !path.exists() => half_missing(path, names),
            loaded => loaded,
        };
        let (node, ele) = if given.path == names.ele {
            (load(&names.node)?, given)
        } else {
            (given, load(&names.ele)?)
        };
        let poly = names.poly.exists().then(|| Source::load(&names.poly)).transpose()?;
        let parsed = triangle::parse(&node, &ele, poly.as_ref())?;
        let sources = [node, ele].into_iter().chain(poly).collect();
        Ok(Self::new(Format::Triangle, parsed, sources))
    }

    fn new(format: Format, parsed: Parsed, mut sources: Vec<Source>) -> MeshFile {
        let Parsed { mesh, x_at, order, labels, rows, notes } = parsed;
        let part = format.part_with_triangles();
        let bytes = &mut sources[part].bytes;
        let implied = match (labels, order) {
            (None, _) => Implied::default(),
            (Some(labels), None) => {
                let lists_vertices = x_at.last().filter(|_| part == 0);
                let from = lists_vertices.map_or(0, |&last| text::line_end(bytes, last));
                Implied::take_lines_out(bytes, from, labels, &mesh.triangles)
            }
            (Some(labels), Some(order)) => {
                Implied::take_rows_out(bytes, &rows, order, labels, &mesh.triangles)
            }
        };
        MeshFile { mesh, format, notes, x_at, order, sources, implied }
    }

    /// The file that was read; of a Triangle mesh its `.node`.
    pub fn path(&self) -> &Path {
        &self.sources[0].path
    }

    /// All files that were read: of a Triangle mesh its `.node`, `.ele` and, if there is one, `.poly`.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.sources.iter().map(|source| source.path.as_path())
    }

    /// The mesh, vertices and triangles in the order of the file.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The format it was read in, and will be written in.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Remarks for the user on what the file holds besides triangles, one line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The value that a coordinate will have once written and read back.
    ///
    /// Text keeps all bits of a finite number, as do the binary formats read so far.
    pub fn stored(&self, x: f64) -> f64 {
        x
    }

    /// Where vertex `index` (zero-based, as in [`Mesh::points`]) has its coordinates.
    ///
    /// For messages: it may go through the whole file.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn vertex_place(&self, index: u32) -> Place {
        let x_at = self.x_at[index as usize];
        let source = &self.sources[0];
        let (location, label) = match self.format {
            Format::Triangle => triangle::vertex_place(source, x_at),
            _ => gmsh::vertex_place(source, index as usize),
        };
        Place { path: source.path.clone(), location, label }
    }

    /// Where triangle `index` (zero-based, as in [`Mesh::triangles`]) lists its vertices.
    ///
    /// For messages: it may go through the whole file.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn triangle_place(&self, index: usize) -> Place {
        assert!(index < self.mesh.triangles.len(), "there is no triangle {index}");
        let kept = &self.sources[self.format.part_with_triangles()];
        let path = kept.path.clone();
        let whole = self.implied.whole(&kept.bytes, &self.mesh.triangles);
        let whole = whole.map(|bytes| Source { path: path.clone(), bytes });
        let source = whole.as_ref().unwrap_or(kept);
        let (location, label) = match self.format {
            Format::Triangle => triangle::triangle_place(source, index),
            _ => gmsh::triangle_place(source, index),
        };
        Place { path, location, label }
    }

    /// Writes the file again, vertex `i` moved to `points[i]` (in the units of the file).
    ///
    /// Coordinates that have the bits they were read with keep their text too; others are written
    /// with the fewest digits that read back as the same bits. Of a Triangle mesh, all files are
    /// written under the name that `path` gives with or without ending. `path` may be the file
    /// that was read. It is replaced only once all is written; symbolic links are followed.
    ///
    /// # Errors
    /// [`WriteError`] for the reasons of [`check_destination`](Self::check_destination), if the
    /// points are not finite or not one per vertex, or if the system refuses. What stood at the
    /// destination then still stands there.
    pub fn write(&self, path: &Path, points: &[[f64; 2]]) -> Result<(), WriteError> {
        self.check_points(path, points)?;
        self.check_destination(path)?;
        let jobs: Vec<Job<'_>> = self
            .destinations(path)?
            .into_iter()
            .zip(&self.sources)
            .enumerate()
            .map(|(part, (destination, source))| -> Job<'_> {
                let (bytes, old) = (&source.bytes, &self.mesh.points);
                // Only the first part holds vertices.
                let x_at = if part == 0 { self.x_at.as_slice() } else { &[] };
                let patch = Patch { bytes, x_at, order: self.order, old, new: points };
                let has_triangles = part == self.format.part_with_triangles();
                let content = move |out: &mut (dyn Write + Send)| {
                    let patched = patch.write(out)?;
                    match has_triangles {
                        true => self.implied.write(out, bytes, patched, &self.mesh.triangles),
                        false => out.write_all(&bytes[patched..]),
                    }
                };
                (destination, Box::new(content))
            })
            .collect();
        replace::replace_all(&jobs)
    }

    /// Finds out, as far as can be told without writing, whether [`write`](Self::write) to `path`
    /// can work: that its ending does not promise another format, that the directory is there and
    /// takes new files, and that no directory or read-only file is in the way.
    ///
    /// # Errors
    /// [`WriteError`] that says what is wrong.
    pub fn check_destination(&self, path: &Path) -> Result<(), WriteError> {
        self.destinations(path)?.iter().try_for_each(|destination| replace::check(destination))
    }

    /// The files that [`write`](Self::write) to `path` writes, in the order of [`paths`](Self::paths).
    ///
    /// # Errors
    /// [`WriteError::Format`] if `path` is not the name of a file or promises another format.
    pub fn destinations(&self, path: &Path) -> Result<Vec<PathBuf>, WriteError> {
        let usual = self.format.endings()[0];
        let refused = |problem: String, remedy: String| {
            Err(WriteError::Format { path: path.to_owned(), problem, remedy })
        };
        let ends_in_separator =
            path.to_string_lossy().chars().next_back().is_none_or(std::path::is_separator);
        // A device can take one file, but not the several of a Triangle mesh.
        let is_device = path.exists() && !path.is_file() && self.sources.len() > 1;
        if path.is_dir() || is_device || ends_in_separator || path.file_name().is_none() {
            return refused("not the name of a file".into(), format!("Add a name like out{usual}"));
        }
        if let Some(owner) = detect::owner_of_ending(path)
            && !self.format.has_ending_of(path)
        {
            let problem = format!("its ending is that of {owner}, but the mesh is {}", self.format);
            return refused(problem, format!("Formats are not converted: end the name in {usual}"));
        }
        Ok(match self.format {
            Format::Triangle => {
                let Names { node, ele, poly } = Names::of(path);
                [node, ele, poly].into_iter().take(self.sources.len()).collect()
            }
            _ => vec![path.to_owned()],
        })
    }

    fn check_points(&self, path: &Path, points: &[[f64; 2]]) -> Result<(), WriteError> {
        let refused = |problem| Err(WriteError::Points { path: path.to_owned(), problem });
        let vertices = self.mesh.points.len();
        if points.len() != vertices {
            return refused(format!("{} points given for {vertices} vertices", points.len()));
        }
        match points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
            Some(index) => {
                let [x, y] = points[index];
                refused(format!("the point given for vertex index {index} is ({x}, {y})"))
            }
            None => Ok(()),
        }
    }
}

impl fmt::Debug for MeshFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let paths: Vec<_> = self.sources.iter().map(|source| &source.path).collect();
        f.debug_struct("MeshFile")
            .field("paths", &paths)
            .field("format", &self.format)
            .field("vertices", &self.mesh.points.len())
            .field("triangles", &self.mesh.triangles.len())
            .finish_non_exhaustive()
    }
}

/// The error for a Triangle mesh of which `missing` is not there, though its other file is.
fn half_missing(missing: &Path, names: &Names) -> Result<Source, ReadError> {
    let there = if missing == names.node { &names.ele } else { &names.node };
    let remedy = format!(
        "A Triangle mesh is two files: put it beside {} (Triangle writes both)",
        there.display()
    );
    let source = std::io::Error::new(std::io::ErrorKind::NotFound, "not found");
    Err(ReadError::Io { path: missing.to_owned(), source, remedy })
}
