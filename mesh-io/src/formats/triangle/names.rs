//! The names of the files of a Triangle mesh.

use std::path::{Path, PathBuf};

/// The paths of a Triangle mesh's files, whether or not the files exist.
pub(crate) struct Names {
    pub(crate) node: PathBuf,
    pub(crate) ele: PathBuf,
    pub(crate) poly: PathBuf,
}

impl Names {
    /// Returns the files of the mesh that `path` names by its `.node`, by its `.ele`, or without an ending.
    pub(crate) fn of(path: &Path) -> Names {
        Self::by_ending(path, &["node", "ele"])
            .unwrap_or_else(|| Names::with(|name| appended(path, &format!(".{name}"))))
    }

    /// Returns the files of the mesh that contains the file `path`. `None` if `path` has none of Triangle's three
    /// endings.
    pub(crate) fn of_file(path: &Path) -> Option<Names> {
        Self::by_ending(path, &["node", "ele", "poly"])
    }

    fn by_ending(path: &Path, endings: &[&str]) -> Option<Names> {
        let own = path.extension()?.to_string_lossy();
        if !endings.iter().any(|ending| own.eq_ignore_ascii_case(ending)) {
            return None;
        }
        let stem = path.with_extension("");
        Some(Names::with(|name| match own.eq_ignore_ascii_case(name) {
            // The given path keeps its spelling.
            true => path.to_owned(),
            false => appended(&stem, &format!(".{}", like(&own, name))),
        }))
    }

    fn with(path_of: impl Fn(&str) -> PathBuf) -> Names {
        Names { node: path_of("node"), ele: path_of("ele"), poly: path_of("poly") }
    }
}

/// Returns the ending `name` with the capitalization of the ending `other`: capitals, a capital first, or small
/// letters.
fn like(other: &str, name: &str) -> String {
    let (first, rest) = name.split_at(1);
    match other.as_bytes() {
        b"NODE" | b"ELE" | b"POLY" => name.to_uppercase(),
        b"Node" | b"Ele" | b"Poly" => first.to_uppercase() + rest,
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

    #[test]
    fn each_file_of_a_mesh_names_all_files() {
        for (given, node, poly) in
            [("d/A.POLY", "d/A.NODE", "d/A.POLY"), ("la.1.Ele", "la.1.Node", "la.1.Poly")]
        {
            let names = Names::of_file(Path::new(given)).unwrap();
            assert_eq!([names.node, names.poly], [node, poly].map(PathBuf::from));
        }
        assert!(Names::of_file(Path::new("la.1")).is_none());
    }
}
