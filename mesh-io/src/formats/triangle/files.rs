//! The files of a Triangle mesh: a `.node` with the vertices, an `.ele` with the triangles, and perhaps a `.poly` with
//! segments.

use crate::compress::file::{Compression, inner_name};
use crate::disk::source::{Companion, Source, file_name};
use crate::error::{ReadError, WriteError};
use crate::formats::triangle::names::{Names, appended};
use crate::formats::triangle::rows::rows;
use crate::text::token::integer;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Returns whether a path ends in `.node` or `.ele`, before the ending of a compressed file.
fn is_named_as_triangle(path: &Path) -> bool {
    let name = file_name(path).to_ascii_lowercase();
    let name = inner_name(&name);
    name.ends_with(".node") || name.ends_with(".ele")
}

/// Returns the names of all files of the mesh that `source` belongs to. If the file's name ends in neither `.node` nor
/// `.ele`, the second number of the first row decides: 2 dimensions make a `.node`, 3 or 6 corners an `.ele`. `None`
/// for other files, and for a file without counterpart.
pub(crate) fn names(source: &Source) -> Option<Names> {
    let path = &source.path;
    if is_named_as_triangle(path) {
        return Some(Names::of(path));
    }
    let mut cursor = rows(source);
    let second = cursor.next_row().then(|| cursor.token().and_then(|_| cursor.token()));
    match second.flatten().and_then(integer) {
        Some(2) => counterpart(path, ".ele").map(|stem| Names {
            node: path.clone(),
            ele: appended(&stem, ".ele"),
            poly: appended(&stem, ".poly"),
        }),
        Some(3 | 6) => counterpart(path, ".node").map(|stem| Names {
            node: appended(&stem, ".node"),
            ele: path.clone(),
            poly: appended(&stem, ".poly"),
        }),
        _ => None,
    }
}

/// Finds the counterpart of `path`, whose name has `ending` after the name of `path` or in place of its extension.
/// Returns the counterpart's path without `ending`; `None` if no such file exists.
fn counterpart(path: &Path, ending: &str) -> Option<PathBuf> {
    [path.with_extension(""), path.to_owned()]
        .into_iter()
        .find(|stem| appended(stem, ending).is_file())
}

/// Loads the `.node` of a mesh that `path` names without an ending. If `path` is a missing `.node` or `.ele` whose
/// counterpart exists, returns an error that explains the missing file. `None` if `path` exists or names no Triangle
/// mesh.
pub(crate) fn load_by_stem(path: &Path) -> Option<Result<Source, ReadError>> {
    let names = Names::of(path);
    if !names.node.is_file() && !names.ele.is_file() {
        return None;
    }
    match is_named_as_triangle(path) {
        true if path.exists() => None,
        true => Some(Err(missing_file(path, other_file(&names, path)))),
        false if path.is_file() => None,
        false => Some(load(&names.node, &names)),
    }
}

/// Loads the other files of the mesh that `given` belongs to. Returns the `.node`, with the other files as companions.
pub(super) fn load_companions(given: Source) -> Result<Source, ReadError> {
    if Compression::of(&given.path).is_some() && is_named_as_triangle(&given.path) {
        return Err(compressed_file(&given));
    }
    let Some(names) = names(&given) else { return Err(one_of_two(&given)) };
    let (mut node, ele) = match given.path == names.ele {
        true => (load(&names.node, &names)?, given),
        false => (given, load(&names.ele, &names)?),
    };
    let poly = names.poly.exists().then(|| Source::load(&names.poly)).transpose()?;
    let others = [ele].into_iter().chain(poly);
    node.companions.extend(others.map(Companion::by_convention));
    if let Some(packed) = node.files().find(|source| source.compressed.is_some()) {
        return Err(not_read(packed));
    }
    Ok(node)
}

/// Returns the error of a file whose name ends in that of a compressed `.node` or `.ele`, such as `a.node.gz`: the other file
/// exists neither compressed nor decompressed, or files of Triangle are not read compressed.
fn compressed_file(packed: &Source) -> ReadError {
    let inner = packed.path.with_extension("");
    let names = Names::of(&inner);
    let other = other_file(&names, &inner);
    let is_compressed =
        |ending: &OsStr| appended(other, &format!(".{}", ending.display())).exists();
    match other.exists() || packed.path.extension().is_some_and(is_compressed) {
        true => not_read(packed),
        false => missing_file(other, &packed.path),
    }
}

/// Returns the error that a compressed file of Triangle is not read.
fn not_read(packed: &Source) -> ReadError {
    let problem = "files of Triangle are not read compressed, as there are several to a mesh";
    packed.error(problem, "Decompress all of them (gunzip, unzstd)")
}

/// Returns an error: bytes that were not read from a file have no companion files.
pub(super) fn require_single(source: &Source) -> Result<(), ReadError> {
    Err(one_of_two(source))
}

fn one_of_two(source: &Source) -> ReadError {
    let problem = "one of the two files of a Triangle mesh";
    source.error(problem, "Name its .node, so that both are read")
}

/// Returns the file of the mesh beside the `.node` or the `.ele` with the path `own`.
fn other_file<'n>(names: &'n Names, own: &Path) -> &'n Path {
    if own == names.node { &names.ele } else { &names.node }
}

fn load(path: &Path, names: &Names) -> Result<Source, ReadError> {
    match Source::load(path) {
        Err(_) if !path.exists() => Err(missing_file(path, other_file(names, path))),
        loaded => loaded,
    }
}

/// Returns the error that the file `missing` of a mesh does not exist, though the other file `there` does.
fn missing_file(missing: &Path, there: &Path) -> ReadError {
    let remedy = format!(
        "A Triangle mesh is two files: put it beside {} (Triangle writes both)",
        there.display()
    );
    let source = std::io::Error::new(std::io::ErrorKind::NotFound, "not found");
    ReadError::Io { path: missing.to_owned(), source, remedy }
}

/// Returns the files that are written for `path`, in the order of [`Source::files`].
///
/// # Errors
/// If `path` has the ending of a compressed file, or an ending of no format, behind which the files would get another
/// ending. If an existing file `path` would be read in place of the `.node`, or a `.poly` of another mesh along with the
/// new files.
pub(super) fn destinations(node: &Source, path: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let refused = |problem: String, remedy: &str| {
        Err(WriteError::Format { path: path.to_owned(), problem, remedy: remedy.into() })
    };
    if Compression::of(path).is_some() {
        let problem = "a Triangle mesh is of several files, which are not written compressed";
        return refused(problem.into(), "End the name in .node");
    }
    if has_foreign_ending(node, path) {
        let name = path.display();
        let problem = format!(
            "the ending belongs to no format, and a Triangle mesh would be written to {name}.node and {name}.ele"
        );
        return refused(problem, "End the name in .node");
    }
    if path.is_file() && !is_named_as_triangle(path) {
        let name = path.display();
        let problem = format!(
            "a file of this name exists, and readers would take the file for the mesh instead of {name}.node"
        );
        return refused(problem, "End the name in .node, or take another");
    }
    let Names { node: to_node, ele, poly } = Names::of(path);
    if node.companions.len() == 1 && poly.exists() {
        let problem = format!(
            "{} exists, belongs to another mesh, and would be read with the new files",
            poly.display()
        );
        return refused(problem, "Remove it, or take another name");
    }
    Ok([to_node, ele, poly].into_iter().take(1 + node.companions.len()).collect())
}

/// Returns whether `path`, which has no ending of another format, has an ending of no format. An ending without letters,
/// as in `la.1`, and one that the given mesh has before `.node`, as in `la.v2.node`, are parts of names.
fn has_foreign_ending(node: &Source, path: &Path) -> bool {
    let Some(ending) = path.extension() else { return false };
    let is_word = ending.to_string_lossy().contains(char::is_alphabetic);
    let is_given = node.path.with_extension("").extension() == Some(ending);
    is_word && !is_given && !is_named_as_triangle(path)
}
