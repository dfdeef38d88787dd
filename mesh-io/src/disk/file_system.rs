//! Operations of the file system that writes need, as a trait, so that tests can make each operation fail.

use std::fs::{self, File, Metadata, OpenOptions, Permissions};
use std::io::{self, Write};
use std::path::Path;

/// Operations of the file system that writes need. Tests implement the trait to make operations fail.
pub(crate) trait FileSystem {
    /// Creates a file for writing. An existing file is an error.
    fn create_new(&self, path: &Path) -> io::Result<Box<dyn NewFile>>;
    /// Gives a file a second name, by a hard link.
    fn hard_link(&self, path: &Path, second: &Path) -> io::Result<()>;
    /// Copies the content of a file, and forces the copy to the disk.
    fn copy(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Renames a file, and replaces any file that has the new name.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    fn remove(&self, path: &Path) -> io::Result<()>;
    /// Forces the entries of a directory to the disk.
    fn sync_directory(&self, path: &Path) -> io::Result<()>;
}

/// A new file that is open for writing.
pub(crate) trait NewFile: Write + Send {
    /// Gives the file the owner and the group of an existing file, each if the system allows it.
    fn set_owner(&self, existing: &Metadata);
    fn set_permissions(&self, permissions: Permissions) -> io::Result<()>;
    /// Forces the content to the disk.
    fn sync(&self) -> io::Result<()>;
}

/// The file system of the operating system.
pub(crate) struct OsFileSystem;

impl FileSystem for OsFileSystem {
    fn create_new(&self, path: &Path) -> io::Result<Box<dyn NewFile>> {
        Ok(Box::new(OpenOptions::new().write(true).create_new(true).open(path)?))
    }

    fn hard_link(&self, path: &Path, second: &Path) -> io::Result<()> {
        fs::hard_link(path, second)
    }

    fn copy(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::copy(from, to)?;
        OpenOptions::new().write(true).open(to)?.sync_all()
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }

    fn sync_directory(&self, path: &Path) -> io::Result<()> {
        File::open(path)?.sync_all()
    }
}

impl NewFile for File {
    #[cfg(unix)]
    fn set_owner(&self, existing: &Metadata) {
        use std::os::unix::fs::{MetadataExt, fchown};
        let Ok(own) = self.metadata() else { return };
        let (user, group) = (existing.uid(), existing.gid());
        // Most systems let only root give files away, and other users choose among their own groups.
        if own.gid() != group {
            let _ = fchown(self, None, Some(group));
        }
        if own.uid() != user {
            let _ = fchown(self, Some(user), None);
        }
    }

    #[cfg(not(unix))]
    fn set_owner(&self, _: &Metadata) {}

    fn set_permissions(&self, permissions: Permissions) -> io::Result<()> {
        File::set_permissions(self, permissions)
    }

    fn sync(&self) -> io::Result<()> {
        self.sync_all()
    }
}
