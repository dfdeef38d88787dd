//! The companion files with the numbers of an XDMF file: loading, and file names in a rewrite.

use crate::compress::file::Compression;
use crate::disk::paths::same_file;
use crate::disk::source::{Companion, Source, file_name};
use crate::edit::numbers::ByteEdit;
use crate::error::{Location, ReadError, WriteError};
use crate::text::cursor::CORRECT;
use crate::text::token::quoted;
use quick_xml::escape::escape;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Name of a companion file in the main file of a mesh.
pub(super) struct Reference {
    pub(super) name: String,
    /// Range of the main file with the name.
    pub(super) at: Range<usize>,
}

/// Loads the files that `main` refers to, each once, and adds them to the companions of `main`.
///
/// # Errors
/// If a file is missing, unreadable, compressed or `main` itself, or outside of the directory of `main` although the
/// options forbid other directories. Also if `main` is compressed but refers to other files.
pub(super) fn load(main: &mut Source, references: Vec<Reference>) -> Result<(), ReadError> {
    if !references.is_empty() && main.compressed.is_some() {
        let problem = "it is compressed, but a mesh of several files";
        return Err(main.error(problem, "Decompress it first (gunzip, unzstd)"));
    }
    for Reference { name, at } in references {
        if let Some(known) = main.companions.iter_mut().find(|own| own.names.contains(&name)) {
            known.named_at.push(at);
            continue;
        }
        let path = main.path.parent().unwrap_or(Path::new("")).join(&name);
        if same_file(&path, &main.path) {
            let place = Location::Line(main.line_of(at.start));
            let problem = "it names itself as a file of numbers";
            return Err(main.error_at(place, problem, CORRECT));
        }
        main.check_inside(main, &path, &quoted(name.as_bytes()), at.start)?;
        // Different names, such as `a.h5` and `./a.h5`, may denote the same file.
        if let Some(known) =
            main.companions.iter_mut().find(|own| same_file(&own.source.path, &path))
        {
            known.names.push(name);
            known.named_at.push(at);
            continue;
        }
        let source = match Source::load(&path) {
            Err(_) if !path.exists() => {
                let place = Location::Line(main.line_of(at.start));
                let shown = quoted(name.as_bytes());
                let problem = format!("its numbers are in {shown}, which does not exist");
                return Err(main.error_at(
                    place,
                    problem,
                    format!("Put {shown} beside the mesh file"),
                ));
            }
            loaded => loaded?,
        };
        if source.compressed.is_some() {
            let problem = "the file is compressed, which only meshes in a single file may be";
            return Err(source.error(problem, "Decompress it first (gunzip, unzstd)"));
        }
        main.companions.push(Companion { names: vec![name], named_at: vec![at], source });
    }
    Ok(())
}

/// Returns the files of a rewrite to `path`: `path` itself, then one file per companion.
///
/// Companions keep their paths if `path` is the file that was read. Otherwise `in.h5` beside `in.xdmf` becomes
/// `out.h5`, and the name of any other companion is prefixed: `mesh.h5` becomes `out_mesh.h5`.
///
/// # Errors
/// If the mesh has companions and `path` names a compressed file, or if a file would replace another file of the mesh
/// that was read.
pub(super) fn destinations(source: &Source, path: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let refused = |problem: String, remedy: &str| {
        Err(WriteError::Format { path: path.to_owned(), problem, remedy: remedy.into() })
    };
    if source.companions.is_empty() {
        return Ok(vec![path.to_owned()]);
    }
    if Compression::of(path).is_some() {
        let problem = "the mesh is of several files, which are not written compressed";
        return refused(problem.into(), "End the name in .xdmf");
    }
    let all = paths(source, path);
    for (part, own) in all.iter().enumerate() {
        let mut others = source.files().enumerate().filter(|(other, _)| *other != part);
        if others.any(|(_, other)| same_file(own, &other.path)) {
            let name = own.display();
            let problem = format!("{name}, from which the mesh was read, would be overwritten");
            return refused(problem, "Take another name");
        }
    }
    Ok(all)
}

fn paths(source: &Source, path: &Path) -> Vec<PathBuf> {
    let mut all = vec![path.to_owned()];
    if same_file(&source.path, path) {
        all.extend(source.companions.iter().map(|companion| companion.source.path.clone()));
        return all;
    }
    let stem = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let (old, new) = (stem(&source.path), stem(path));
    for companion in &source.companions {
        let own = file_name(&companion.source.path);
        // `zone.h5` is not named after `z.xdmf`.
        let rest = own.strip_prefix(&old).filter(|rest| !rest.starts_with(char::is_alphabetic));
        let mut name = match rest {
            Some(rest) => format!("{new}{rest}"),
            None => format!("{new}_{own}"),
        };
        while all.iter().any(|path| file_name(path) == name) {
            name = format!("{new}_{name}");
        }
        all.push(path.with_file_name(name));
    }
    all
}

/// Returns the edits of the main file that replace the names of companions by their names in a rewrite to `path`.
pub(super) fn renames(source: &Source, path: &Path) -> Vec<ByteEdit> {
    if same_file(&source.path, path) {
        return Vec::new();
    }
    let new = paths(source, path);
    let mut edits = Vec::new();
    for (companion, path) in source.companions.iter().zip(&new[1..]) {
        let name = file_name(path);
        for range in &companion.named_at {
            let bytes = escape(name.as_str()).as_bytes().to_vec();
            if source.bytes.get(range.clone()) != Some(&bytes) {
                edits.push(ByteEdit { range: range.clone(), bytes });
            }
        }
    }
    edits
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(name: &str, companions: &[&str]) -> Source {
        let mut source = Source::new(Path::new(name), Vec::new()).unwrap();
        source.companions = companions
            .iter()
            .map(|name| {
                let source = Source::new(Path::new(name), Vec::new()).unwrap();
                Companion { names: vec![(*name).to_owned()], named_at: Vec::new(), source }
            })
            .collect();
        source
    }

    #[test]
    fn companions_are_named_after_the_mesh() {
        for (given, companions, out, expected) in [
            ("a/in.xdmf", &["a/in.h5"][..], "b/out.xdmf", &["b/out.h5"][..]),
            ("in.xdmf", &["in0.bin", "in1.bin"], "out.xmf", &["out0.bin", "out1.bin"]),
            ("in.xdmf", &["mesh.h5", "d/u.h5"], "out.xdmf", &["out_mesh.h5", "out_u.h5"]),
            ("in.xdmf", &["a/mesh.h5", "b/mesh.h5"], "o.xdmf", &["o_mesh.h5", "o_o_mesh.h5"]),
            ("in.xdmf", &["in.h5"], "out", &["out.h5"]),
            ("z.xdmf", &["zone.h5"], "out.xdmf", &["out_zone.h5"]),
            ("in.xdmf", &["in"], "out.", &["out"]),
            ("none/in.xdmf", &["none/in.h5"], "none/in.xdmf", &["none/in.h5"]),
        ] {
            let all = paths(&source(given, companions), Path::new(out));
            assert_eq!(all[0], Path::new(out));
            let expected: Vec<PathBuf> = expected.iter().map(PathBuf::from).collect();
            assert_eq!(all[1..], expected, "{given} to {out}");
        }
    }
}
