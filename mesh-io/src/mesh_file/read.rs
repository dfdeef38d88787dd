//! Reads a mesh from its file, or from memory.

use crate::detect::{self, Content};
use crate::disk::replace::same_file;
use crate::disk::source::{Beside, Named, Source};
use crate::error::{Location, ReadError};
use crate::families::TRIANGLE;
use crate::formats::triangle;
use crate::formats::triangle::names::Names;
use crate::mesh_file::mesh::MeshFile;
use crate::text::cursor::CORRECT;
use crate::text::token::quoted;
use crate::visit::assemble;
use crate::visit::sink::Reader;
use std::path::Path;

impl MeshFile {
    /// Reads a mesh. The content of the file tells the format.
    ///
    /// A Triangle mesh is named by its `.node`, by its `.ele`, or without either ending. Files of all other formats may be
    /// compressed by gzip or zstd. Of an XDMF that has numbers in other files, these are read too.
    ///
    /// # Errors
    /// [`ReadError`] if a file is missing or cannot be read, is in none of the formats of [`Format`](crate::Format),
    /// does not follow its format, has elements other than first-order elements of the plane, or has no triangle. An
    /// STL is refused, too: see [`read_welded`](Self::read_welded).
    pub fn read(path: &Path) -> Result<MeshFile, ReadError> {
        Self::read_as(path, false)
    }

    /// Reads a mesh as [`read`](Self::read) does, and an STL by joining corners of triangles at the same place to one
    /// vertex. Vertices are numbered in the order in which the file first has them. Each is written wherever the file
    /// has it.
    ///
    /// # Errors
    /// [`ReadError`] for the reasons of [`read`](Self::read), and if the corners of an STL have different third
    /// coordinates.
    pub fn read_welded(path: &Path) -> Result<MeshFile, ReadError> {
        Self::read_as(path, true)
    }

    fn read_as(path: &Path, welds: bool) -> Result<MeshFile, ReadError> {
        let names = Names::of(path);
        let has_half = names.node.is_file() || names.ele.is_file();
        let has_ending = TRIANGLE.has_ending_of(path);
        if has_half && !has_ending && !path.is_file() {
            return Self::read_as(&names.node, welds);
        }
        let mut given = match Source::load(path) {
            Err(_) if has_half && has_ending && !path.exists() => half_missing(path, &names)?,
            given => given?,
        };
        given.welds = welds;
        match content(&given)? {
            Content::Of(reader) => {
                load_beside(reader, &mut given)?;
                of_one_file(reader, given)
            }
            Content::Triangle(names) => Self::read_triangle(given, &names),
        }
    }

    /// Reads a mesh from memory, such as what a program got by its standard input. `name` stands for it in messages.
    /// Its ending helps to tell the format if the content is not enough.
    ///
    /// # Errors
    /// [`ReadError`] for the reasons of [`read`](Self::read), and for a Triangle mesh, which has two files.
    pub fn from_bytes(name: &Path, bytes: Vec<u8>) -> Result<MeshFile, ReadError> {
        Self::of_source(Source::new(name, bytes)?)
    }

    /// Reads a mesh from memory as [`from_bytes`](Self::from_bytes) does, and an STL as
    /// [`read_welded`](Self::read_welded) does.
    ///
    /// # Errors
    /// [`ReadError`] for the reasons of [`read_welded`](Self::read_welded), and for a Triangle mesh, which has two
    /// files.
    pub fn from_bytes_welded(name: &Path, bytes: Vec<u8>) -> Result<MeshFile, ReadError> {
        Self::of_source(Source { welds: true, ..Source::new(name, bytes)? })
    }

    fn of_source(given: Source) -> Result<MeshFile, ReadError> {
        match content(&given)? {
            Content::Of(reader) => {
                if let Some(named) = (reader.beside)(&given)?.first() {
                    let name = quoted(named.name.as_bytes());
                    let problem = format!("its numbers are in {name}, a file beside it");
                    return Err(given.error(problem, "Name the file, so that both are read"));
                }
                of_one_file(reader, given)
            }
            Content::Triangle(_) => {
                let problem = "one of the two files of a Triangle mesh";
                Err(given.error(problem, "Name its .node, so that both are read"))
            }
        }
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
        if let Some(packed) = [&node, &ele].into_iter().chain(&poly).find(|s| s.packed.is_some()) {
            let problem =
                "files of Triangle are not read compressed, as there are several to a mesh";
            return Err(packed.error(problem, "Decompress all of them (gunzip, unzstd)"));
        }
        if let Some(error) = [&node, &ele].into_iter().chain(&poly).find_map(ends_by_returns) {
            return Err(error);
        }
        let parsed = triangle::parse(&node, &ele, poly.as_ref())?;
        let sources = [node, ele].into_iter().chain(poly).collect();
        MeshFile::new(parsed, sources)
    }
}

/// Finds the format of a file, or explains why it has none that is read.
fn content(given: &Source) -> Result<Content, ReadError> {
    detect::content(given).map_err(|error| ends_by_returns(given).unwrap_or(error))
}

/// Reads the files that a file names, each once.
fn load_beside(reader: &Reader, given: &mut Source) -> Result<(), ReadError> {
    let named = (reader.beside)(given)?;
    if !named.is_empty() && given.packed.is_some() {
        let problem = "it is compressed, but a mesh of several files";
        return Err(given.error(problem, "Decompress it first (gunzip, unzstd)"));
    }
    for Named { name, at } in named {
        if let Some(known) = given.beside.iter_mut().find(|own| own.names.contains(&name)) {
            known.named_at.push(at);
            continue;
        }
        let path = given.path.parent().unwrap_or(Path::new("")).join(&name);
        if same_file(&path, &given.path) {
            let place = Location::Line(given.line_of(at.start));
            let problem = "it names itself as a file of numbers";
            return Err(given.error_at(place, problem, CORRECT));
        }
        // By another name.
        if let Some(known) = given.beside.iter_mut().find(|own| same_file(&own.source.path, &path))
        {
            known.names.push(name);
            known.named_at.push(at);
            continue;
        }
        let source = match Source::load(&path) {
            Err(_) if !path.exists() => {
                let place = Location::Line(given.line_of(at.start));
                let shown = quoted(name.as_bytes());
                let problem = format!("its numbers are in {shown}, which is not there");
                return Err(given.error_at(place, problem, "Put the file beside it"));
            }
            loaded => loaded?,
        };
        if source.packed.is_some() {
            let problem = "it is compressed, but one of the files of a mesh";
            return Err(source.error(problem, "Decompress it first (gunzip, unzstd)"));
        }
        given.beside.push(Beside { names: vec![name], named_at: vec![at], source });
    }
    Ok(())
}

fn of_one_file(reader: &Reader, given: Source) -> Result<MeshFile, ReadError> {
    // Formats that are read by words may have any line ends.
    let ends = ends_by_returns(&given);
    let read = assemble::parse(reader, &given);
    let made = read.and_then(|parsed| MeshFile::new(parsed, vec![given]));
    made.map_err(|error| ends.unwrap_or(error))
}

/// Returns the error for a text whose lines end in carriage returns alone, as on old Macintosh systems.
fn ends_by_returns(source: &Source) -> Option<ReadError> {
    let is_control = |byte: &u8| *byte < b' ' && !matches!(byte, b'\t' | b'\r' | b'\x0C');
    let is_text = memchr::memchr2(b'\n', 0, &source.bytes).is_none()
        && !source.bytes[..source.bytes.len().min(512)].iter().any(is_control);
    (is_text && memchr::memchr(b'\r', &source.bytes).is_some()).then(|| {
        let problem = "its lines end in carriage returns alone, as on old Macintosh systems";
        source.error(problem, "Make them line feeds first: tr '\\r' '\\n' < IN > OUT")
    })
}

/// Returns the error for a Triangle mesh whose file `missing` does not exist, though the other one does.
fn half_missing(missing: &Path, names: &Names) -> Result<Source, ReadError> {
    let there = if missing == names.node { &names.ele } else { &names.node };
    let remedy = format!(
        "A Triangle mesh is two files: put it beside {} (Triangle writes both)",
        there.display()
    );
    let source = std::io::Error::new(std::io::ErrorKind::NotFound, "not found");
    Err(ReadError::Io { path: missing.to_owned(), source, remedy })
}
