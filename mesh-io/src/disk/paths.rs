//! Identity of files: whether two paths lead to the same file.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Returns whether two paths lead to the same file, by another spelling, a symbolic link or a hard link. The file need
/// not exist yet. Hard links are recognized on Unix only.
pub fn same_file(a: &Path, b: &Path) -> bool {
    matches!((identity(a), identity(b)), (Some(a), Some(b)) if a == b)
}

/// Identity of a file: device and inode of an existing file on Unix, else the canonical path.
#[derive(PartialEq)]
enum Identity {
    #[cfg(unix)]
    Inode {
        device: u64,
        number: u64,
    },
    Path(PathBuf),
}

/// Returns the identity of the file at a path. `None` if no file can be written there, for example without a directory.
fn identity(path: &Path) -> Option<Identity> {
    let (target, existing) = resolve(path).ok()?;
    #[cfg(unix)]
    if let Some(existing) = &existing {
        use std::os::unix::fs::MetadataExt;
        return Some(Identity::Inode { device: existing.dev(), number: existing.ino() });
    }
    if existing.is_some() {
        return fs::canonicalize(target).ok().map(Identity::Path);
    }
    let directory = fs::canonicalize(directory_of(&target)).ok()?;
    Some(Identity::Path(directory.join(target.file_name()?)))
}

/// Follows all symbolic links of a path. Returns the final path, and the metadata if something exists there. The last
/// link may lead to a missing file.
pub(super) fn resolve(path: &Path) -> io::Result<(PathBuf, Option<fs::Metadata>)> {
    match fs::metadata(path) {
        // A link in `/proc` may lead to a device or pipe without a path of its own, so the path stays as given.
        Ok(existing) if !existing.is_file() => Ok((path.to_owned(), Some(existing))),
        Ok(existing) => Ok((fs::canonicalize(path)?, Some(existing))),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let mut target = path.to_owned();
            while let Ok(next) = fs::read_link(&target) {
                target = directory_of(&target).join(next);
            }
            Ok((target, None))
        }
        Err(error) => Err(error),
    }
}

/// Returns the directory part of a path; `.` if the path is a bare file name.
pub(crate) fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
        Some(parent) => parent,
        None => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_known_by_any_of_its_names() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        fs::create_dir(at("sub")).unwrap();
        fs::write(at("a"), "").unwrap();
        fs::write(at("b"), "").unwrap();
        let same = |a: &str, b: &str| same_file(&at(a), &at(b));
        for (there, not_yet) in [("a", "new"), ("sub", "sub/new")] {
            for name in [there, not_yet] {
                assert!(same(name, name) && same(name, &format!("sub/../{name}")), "{name}");
                assert!(same(name, &format!("./{name}")), "{name}");
            }
            assert!(!same(there, not_yet) && !same(not_yet, "b"));
        }
        assert!(!same("a", "b") && !same("a", "sub/a") && !same("new", "sub/new"));
        assert!(!same("none/a", "none/a"));
        #[cfg(unix)]
        {
            use std::os::unix::fs::symlink;
            for (target, link) in [("a", "to-a"), ("new", "to-new"), ("sub", "to-sub")] {
                symlink(target, at(link)).unwrap();
                assert!(same(target, link));
            }
            fs::hard_link(at("a"), at("also-a")).unwrap();
            assert!(same("a", "also-a") && same("to-a", "also-a") && !same("b", "also-a"));
            assert!(same("to-sub/new", "sub/new"));
        }
    }
}
