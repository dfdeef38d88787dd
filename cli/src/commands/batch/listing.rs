//! The list of meshes in a batch, with the input and output files of each mesh.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use mesh_io::{Conversion, Format, atomic};

use crate::error::CliError;
use crate::load::streams::is_standard;

/// A mesh to smooth.
pub(crate) struct BatchItem {
    /// Path of the mesh as first given on the command line.
    pub(crate) input: PathBuf,
    pub(crate) out: PathBuf,
    /// The existing files of the mesh.
    pub(crate) inputs: Vec<PathBuf>,
    /// The files to which the smoothed mesh is written.
    pub(crate) outputs: Vec<PathBuf>,
}

impl BatchItem {
    /// Lists the files of the mesh at `input`. `to` is the format to which the mesh is converted; `None` if the mesh keeps its
    /// format and its name.
    fn new(input: &Path, directory: &Path, to: Option<Format>) -> Result<Self, CliError> {
        let name = input.file_name().filter(|_| !is_standard(input) && !input.is_dir());
        let name = name.ok_or_else(|| {
            CliError::usage(format!("{}: not a file", input.display()))
                .with_remedy("--out-dir takes meshes in files, and names each result as its mesh")
        })?;
        let inputs = parts(input);
        if let Some(to) = to {
            let out = directory.join(converted_name(name, to));
            let mut outputs = Conversion::destinations_in(to, &out);
            // A Triangle mesh without lines has no outline.
            outputs.truncate(2);
            return Ok(Self { inputs, outputs, input: input.into(), out });
        }
        let out = directory.join(name);
        let outputs = match stem(input) {
            Some(_) => inputs.iter().filter_map(|part| Some(directory.join(part.file_name()?))),
            None => {
                return Ok(Self { inputs, outputs: vec![out.clone()], input: input.into(), out });
            }
        };
        let outputs = outputs.collect();
        Ok(Self { input: input.to_owned(), out, inputs, outputs })
    }

    /// Returns the total size of the mesh's files in bytes.
    pub(crate) fn bytes(&self) -> u64 {
        let sizes = self.inputs.iter().filter_map(|part| Some(fs::metadata(part).ok()?.len()));
        sizes.sum()
    }

    /// Returns whether all output files exist and are newer than all input files. Existing output files are complete,
    /// because files are replaced as a whole.
    pub(crate) fn is_done(&self) -> bool {
        let time = |path: &PathBuf| fs::metadata(path).and_then(|found| found.modified()).ok();
        let times = |paths: &[PathBuf]| paths.iter().map(time).collect::<Option<Vec<SystemTime>>>();
        match (times(&self.inputs), times(&self.outputs)) {
            (Some(read), Some(written)) => match (read.iter().max(), written.iter().min()) {
                (Some(newest), Some(oldest)) => newest < oldest,
                _ => false,
            },
            _ => false,
        }
    }
}

/// Returns the name of a file in the format `to` for a mesh whose file is called `name`.
fn converted_name(name: &OsStr, to: Format) -> PathBuf {
    let path = Path::new(name);
    let is_packed = path
        .extension()
        .is_some_and(|ending| ["gz", "zst"].iter().any(|own| ending.eq_ignore_ascii_case(own)));
    let path = if is_packed { Path::new(path.file_stem().unwrap_or(name)) } else { path };
    let ending = to.extensions().iter().find_map(|ending| ending.strip_prefix('.'));
    let is_mesh = Format::name_of_extension(path).is_some();
    match ending {
        Some(ending) if is_mesh => path.with_extension(ending),
        Some(ending) => appended(path, &format!(".{ending}")),
        None => path.to_owned(),
    }
}

/// Returns the path without its extension if the path names a file of a Triangle mesh; `None` otherwise.
fn stem(path: &Path) -> Option<PathBuf> {
    let ending = path.extension()?.to_str()?.to_lowercase();
    matches!(&*ending, "node" | "ele" | "poly").then(|| path.with_extension(""))
}

/// Returns whether a path is an XDMF file. Numbers of XDMF meshes may be in companion files, which are named after the
/// XDMF file.
fn is_xdmf(path: &Path) -> bool {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    matches!(&*ending, "xdmf" | "xmf" | "xdmf3")
}

/// Key for collisions: two meshes with equal keys would write a file at the same path.
fn key_of(out: &Path) -> PathBuf {
    match stem(out) {
        Some(stem) => stem,
        None if is_xdmf(out) => out.with_extension("xdmf"),
        None => out.to_owned(),
    }
}

/// Returns the existing files of the mesh at `path`, as far as file names determine them.
fn parts(path: &Path) -> Vec<PathBuf> {
    let mut parts = Format::files_of(path);
    parts.retain(|part| part.is_file());
    parts
}

/// Lists the meshes at `paths`, each mesh once, with the output files in `directory`. `to` is the format to which meshes are
/// converted; `None` if they keep their format and their names.
///
/// Returns an error if two meshes would write the same file.
pub(crate) fn list<'p>(
    paths: impl Iterator<Item = &'p PathBuf>,
    directory: &Path,
    to: Option<Format>,
) -> Result<Vec<BatchItem>, CliError> {
    let mut listed: Vec<BatchItem> = Vec::new();
    let mut by_out: HashMap<PathBuf, usize> = HashMap::new();
    for path in paths {
        // A Triangle mesh may be given without an extension.
        let mesh = match is_stem(path) {
            true => BatchItem::new(&appended(path, ".node"), directory, to)?,
            false => BatchItem::new(path, directory, to)?,
        };
        let key = key_of(&mesh.out);
        match by_out.get(&key).map(|&i| &mut listed[i]) {
            Some(known) if is_same(known, &mesh) => {
                // A Triangle mesh is listed by its `.node` or `.ele` if given, not by its `.poly`.
                if known.input.extension().is_some_and(|e| e.eq_ignore_ascii_case("poly")) {
                    *known = mesh;
                }
            }
            Some(known) => {
                return Err(CliError::usage(format!(
                    "{} and {} would both be written to {}",
                    known.input.display(),
                    mesh.input.display(),
                    mesh.out.display()
                ))
                .with_remedy("Rename one, or smooth them into different directories"));
            }
            None => {
                by_out.insert(key, listed.len());
                listed.push(mesh);
            }
        }
    }
    Ok(listed)
}

/// Returns whether a path is that of a Triangle mesh without its extension.
fn is_stem(path: &Path) -> bool {
    !path.exists() && appended(path, ".node").is_file()
}

fn appended(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

fn is_any(path: &Path, others: &[PathBuf]) -> bool {
    others.iter().any(|other| atomic::same_file(other, path))
}

/// Returns whether two meshes share a file.
fn is_same(a: &BatchItem, b: &BatchItem) -> bool {
    let (mine, theirs) = match is_xdmf(&a.input) {
        // XDMF files may share an HDF5 file, so only the main files are compared.
        true => (&a.inputs[..1], &b.inputs[..1]),
        false => (&a.inputs[..], &b.inputs[..]),
    };
    a.input == b.input || mine.iter().any(|part| is_any(part, theirs))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "x").unwrap();
        }
        folder
    }

    fn of(folder: &tempfile::TempDir, names: &[&str]) -> Result<Vec<BatchItem>, CliError> {
        let paths: Vec<PathBuf> = names.iter().map(|name| folder.path().join(name)).collect();
        list(paths.iter(), &folder.path().join("out"), None)
    }

    #[test]
    fn a_mesh_of_several_files_is_listed_once() {
        let names = ["a.1.ele", "a.1.node", "a.1.poly", "b.msh", "c.node", "c.ele"];
        let folder = folder(&names);
        let listed = of(&folder, &names).unwrap();
        let inputs: Vec<_> =
            listed.iter().map(|mesh| mesh.input.file_name().unwrap().to_owned()).collect();
        assert_eq!(inputs, ["a.1.ele", "b.msh", "c.node"]);
        let outputs = listed.iter().map(|mesh| mesh.outputs.len()).collect::<Vec<_>>();
        assert_eq!(outputs, [3, 1, 2]);
        assert_eq!(
            of(&folder, &["a.1.poly", "a.1.ele"]).unwrap()[0].input.extension().unwrap(),
            "ele"
        );
        // Two meshes, each listed twice: one of the paths lacks its extension.
        assert_eq!(of(&folder, &["a.1", "a.1.node", "b.msh", "b.msh"]).unwrap().len(), 2);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn endings_of_triangle_meshes_are_spelled_like_the_one_given() {
        let folder = folder(&["a.Node", "a.Ele", "b.NODE", "b.ELE", "b.POLY", "c.nodE", "c.ele"]);
        for (name, inputs) in [
            ("a.Node", &["a.Node", "a.Ele"][..]),
            ("a.Ele", &["a.Node", "a.Ele"]),
            ("b.ELE", &["b.NODE", "b.ELE", "b.POLY"]),
            ("c.nodE", &["c.nodE", "c.ele"]),
        ] {
            let listed = of(&folder, &[name]).unwrap();
            let expected: Vec<PathBuf> =
                inputs.iter().map(|part| folder.path().join(part)).collect();
            assert_eq!(listed[0].inputs, expected, "{name}");
        }
    }

    /// Companion files of both would get equal names.
    #[test]
    fn files_beside_an_xdmf_are_its_own() {
        let folder = folder(&["a.xdmf", "a.xmf", "a.h5", "b.xdmf"]);
        let listed = of(&folder, &["a.xdmf", "a.xdmf", "b.xdmf"]).unwrap();
        assert_eq!(listed.iter().map(|mesh| mesh.inputs.len()).collect::<Vec<_>>(), [2, 1]);
        assert_eq!(listed[0].bytes(), 2);
        let error = of(&folder, &["a.xdmf", "a.xmf"]).err().unwrap().to_string();
        assert!(error.contains("would both be written to"), "{error}");
    }

    #[test]
    fn two_meshes_of_one_name_are_refused() {
        let folder = folder(&["a/m.msh", "b/m.msh", "a/t.node", "a/t.ele", "b/t.ele", "b/t.node"]);
        for names in [["a/m.msh", "b/m.msh"], ["a/t.node", "b/t.ele"]] {
            let error = of(&folder, &names).err().unwrap().to_string();
            assert!(error.contains("would both be written to"), "{error}");
        }
    }

    #[test]
    fn a_mesh_is_done_if_all_its_files_are_newer() {
        let folder = folder(&["t.node", "t.ele", "out/t.ele"]);
        let at = |name: &str, seconds| {
            let file = fs::File::options().append(true).open(folder.path().join(name)).unwrap();
            let time = SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(seconds);
            file.set_modified(time).unwrap();
        };
        let is_done = || of(&folder, &["t.node"]).unwrap()[0].is_done();
        at("t.node", 100);
        at("t.ele", 200);
        at("out/t.ele", 300);
        assert!(!is_done(), "a part is missing");
        fs::write(folder.path().join("out/t.node"), "x").unwrap();
        assert!(is_done());
        at("out/t.node", 200);
        assert!(!is_done(), "as old as the mesh");
        at("out/t.node", 201);
        assert!(is_done());
    }
}
