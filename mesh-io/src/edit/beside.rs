//! What the files beside a mesh are called where it is written under another name.

use crate::disk::replace::same_file;
use crate::disk::source::{Source, file_name};
use crate::edit::numbers::Splice;
use quick_xml::escape::escape;
use std::path::{Path, PathBuf};

/// The files that are written: the one that names the others, and these. They keep their names where it does; else what was called as
/// it was, with an ending of its own, is called as it is now, and all others are called after it too.
pub(crate) fn destinations(source: &Source, path: &Path) -> Vec<PathBuf> {
    let mut all = vec![path.to_owned()];
    if same_file(&source.path, path) {
        all.extend(source.beside.iter().map(|beside| beside.source.path.clone()));
        return all;
    }
    let stem = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let (old, new) = (stem(&source.path), stem(path));
    for beside in &source.beside {
        let own = file_name(&beside.source.path);
        let mut name = match own.strip_prefix(&old) {
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

/// What is replaced in the file that names the others where they get other names.
pub(crate) fn renamed(source: &Source, path: &Path) -> Vec<Splice> {
    if same_file(&source.path, path) {
        return Vec::new();
    }
    let new = destinations(source, path);
    let mut splices = Vec::new();
    for (beside, path) in source.beside.iter().zip(&new[1..]) {
        let name = file_name(path);
        for range in &beside.named_at {
            let bytes = escape(name.as_str()).as_bytes().to_vec();
            if source.bytes.get(range.clone()) != Some(&bytes) {
                splices.push(Splice { range: range.clone(), bytes });
            }
        }
    }
    splices
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disk::source::Beside;

    fn source(name: &str, beside: &[&str]) -> Source {
        let mut source = Source::new(Path::new(name), Vec::new()).unwrap();
        source.beside = beside
            .iter()
            .map(|name| {
                let source = Source::new(Path::new(name), Vec::new()).unwrap();
                Beside { names: vec![(*name).to_owned()], named_at: Vec::new(), source }
            })
            .collect();
        source
    }

    #[test]
    fn files_beside_a_mesh_are_named_after_it() {
        for (given, beside, out, expected) in [
            ("a/in.xdmf", &["a/in.h5"][..], "b/out.xdmf", &["b/out.h5"][..]),
            ("in.xdmf", &["in0.bin", "in1.bin"], "out.xmf", &["out0.bin", "out1.bin"]),
            ("in.xdmf", &["mesh.h5", "d/u.h5"], "out.xdmf", &["out_mesh.h5", "out_u.h5"]),
            ("in.xdmf", &["a/mesh.h5", "b/mesh.h5"], "o.xdmf", &["o_mesh.h5", "o_o_mesh.h5"]),
            ("in.xdmf", &["in.h5"], "out", &["out.h5"]),
            ("in.xdmf", &["in"], "out.", &["out"]),
            ("none/in.xdmf", &["none/in.h5"], "none/in.xdmf", &["none/in.h5"]),
        ] {
            let all = destinations(&source(given, beside), Path::new(out));
            assert_eq!(all[0], Path::new(out));
            let expected: Vec<PathBuf> = expected.iter().map(PathBuf::from).collect();
            assert_eq!(all[1..], expected, "{given} to {out}");
        }
    }
}
