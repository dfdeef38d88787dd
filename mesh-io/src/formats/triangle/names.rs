//! The names of the files of a Triangle mesh.

use std::path::{Path, PathBuf};

/// The names of a Triangle mesh's files.
pub(crate) struct Names {
    pub(crate) node: PathBuf,
    pub(crate) ele: PathBuf,
    pub(crate) poly: PathBuf,
}

impl Names {
    /// Returns the files of the mesh that `path` names by its `.node`, by its `.ele`, or without an ending.
    pub(crate) fn of(path: &Path) -> Names {
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        let is = |name: &str| ending.eq_ignore_ascii_case(name);
        let stem = if is("node") || is("ele") { path.with_extension("") } else { path.to_owned() };
        let with = |name: &str| match is(name) {
            // The given path keeps its spelling.
            true => path.to_owned(),
            false => appended(&stem, &format!(".{}", like(&ending, name))),
        };
        Names { node: with("node"), ele: with("ele"), poly: with("poly") }
    }
}

/// Spells an ending as another one is spelled: in capitals, with a capital first, or in small letters.
fn like(other: &str, name: &str) -> String {
    let (first, rest) = name.split_at(1);
    match other.as_bytes() {
        b"NODE" | b"ELE" => name.to_uppercase(),
        b"Node" | b"Ele" => first.to_uppercase() + rest,
        _ => name.to_owned(),
    }
}

/// Appends `ending` to a path. Unlike `with_extension`, this keeps the 1 of `la.1`.
pub(crate) fn appended(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_the_iteration_number_and_the_case() {
        for given in ["d/la.1", "d/la.1.node", "d/la.1.ele"] {
            let names = Names::of(Path::new(given));
            assert_eq!(names.node, Path::new("d/la.1.node"), "{given}");
            assert_eq!(names.ele, Path::new("d/la.1.ele"), "{given}");
            assert_eq!(names.poly, Path::new("d/la.1.poly"), "{given}");
        }
        for (given, node, ele, poly) in [
            ("A.NODE", "A.NODE", "A.ELE", "A.POLY"),
            ("A.Ele", "A.Node", "A.Ele", "A.Poly"),
            ("A.nodE", "A.nodE", "A.ele", "A.poly"),
        ] {
            let names = Names::of(Path::new(given));
            let expected = [node, ele, poly].map(Path::new);
            assert_eq!([names.node, names.ele, names.poly], expected.map(Path::to_path_buf));
        }
    }
}
