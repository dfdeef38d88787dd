//! Replacement of whole files: whatever happens, a file has either its old content or all of the new content. If a
//! request to the system fails, several files are replaced together or not at all. If the process is killed between two
//! of their renames, the main file is missing or old, and never beside new files.

use crate::disk::file_system::{FileSystem, NewFile, OsFileSystem};
use crate::disk::paths::{directory_of, resolve};
use crate::error::WriteError;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A file to be written: its path, and a function that writes the content.
pub(crate) type FileWrite<'a> =
    (PathBuf, Box<dyn Fn(&mut (dyn Write + Send)) -> io::Result<()> + 'a>);

/// Replaces the content of a file. Whatever happens meanwhile, the file has either its old content or all of `content`.
///
/// Writes `content` to a temporary file in the same directory, then renames this file. Symbolic links are followed, and
/// permissions are kept. The owner and the group are kept where the system allows it. Devices and pipes are written to directly.
///
/// # Errors
/// [`WriteError::Io`] if the system refuses; an existing file at `path` is then unchanged.
pub fn write(path: &Path, content: &[u8]) -> Result<(), WriteError> {
    write_all(&[(path.to_owned(), Box::new(|out| out.write_all(content)))])
}

/// Writes several files as [`write()`] does: all or none.
///
/// Writes each content to a temporary file, then renames the temporary files from the last entry to the first. The
/// first entry is the main file of the mesh, which readers open: until the main file is renamed, readers see no new
/// mesh. If another file changes too, the old main file is moved aside before, so that old and new files are never
/// mixed.
pub(crate) fn write_all(writes: &[FileWrite<'_>]) -> Result<(), WriteError> {
    write_all_if(&OsFileSystem, writes, &|| Ok(()))
}

/// Writes several files as [`write_all`] does, to the file system `disk`. If `check` returns an error once all
/// contents are in temporary files, no file is replaced.
///
/// # Errors
/// The errors of [`write_all`], and the error of `check`.
pub(crate) fn write_all_if(
    disk: &dyn FileSystem,
    writes: &[FileWrite<'_>],
    check: &dyn Fn() -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let staged = writes.iter().map(|(path, content)| stage(disk, path, content));
    let staged = staged.collect::<Result<Vec<_>, _>>()?;
    // Declared before `staged`, so that the lock is released after the temporary files are removed.
    let _committing = lock(&COMMITTING);
    let mut staged = staged;
    check()?;
    let Some((first, others)) = staged.split_first_mut() else { return Ok(()) };
    if others.iter().any(Staged::changes) {
        first.set_aside(disk).map_err(|source| refused(&first.target, source))?;
    }
    for next in (0..staged.len()).rev() {
        let more_follow = next > 0;
        if let Err(source) = staged[next].commit(disk, more_follow) {
            let error = refused(&staged[next].target, source);
            let is_touched = |(i, it): &(usize, &mut Staged<'_>)| *i > next || it.is_aside;
            let touched = staged.iter_mut().enumerate().filter(is_touched);
            // The main file is restored last, as readers open the mesh by it.
            let lost: Vec<_> = touched.rev().filter_map(|(_, it)| it.revert()).collect();
            return Err(with_lost(error, &lost));
        }
    }
    HAS_WRITTEN.store(true, Ordering::Release);
    Ok(())
}

/// Adds messages about files that could not be restored to the remedy of a write error.
fn with_lost(error: WriteError, lost: &[String]) -> WriteError {
    match error {
        WriteError::Io { path, source, remedy } if !lost.is_empty() => {
            WriteError::Io { path, source, remedy: format!("{remedy}. {}", lost.join(". ")) }
        }
        error => error,
    }
}

/// Lock that a write holds while it renames its temporary files.
static COMMITTING: Mutex<()> = Mutex::new(());
/// Whether a write of this process has ended well.
static HAS_WRITTEN: AtomicBool = AtomicBool::new(false);
/// Paths of the temporary files that writes of this process have created.
static TEMPORARIES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn lock<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Guard that blocks all writes of mesh files in this process, made by [`discard_pending_writes`].
pub struct BlockedWrites {
    _committing: MutexGuard<'static, ()>,
    _temporaries: MutexGuard<'static, Vec<PathBuf>>,
}

impl BlockedWrites {
    /// Returns whether this process has replaced or made a file before.
    pub fn has_written(&self) -> bool {
        HAS_WRITTEN.load(Ordering::Acquire)
    }
}

/// Removes the temporary files of unfinished writes on other threads, before the program ends: [`std::process::exit`]
/// would leave the files behind. Waits for writes that are already renaming their files. No thread can write a mesh
/// file while the returned guard lives.
pub fn discard_pending_writes() -> BlockedWrites {
    let (committing, mut temporaries) = (lock(&COMMITTING), lock(&TEMPORARIES));
    for path in temporaries.drain(..) {
        let _ = fs::remove_file(path);
    }
    BlockedWrites { _committing: committing, _temporaries: temporaries }
}

/// Checks, without changing `path`, whether [`write()`] can succeed: the directory must exist and take new files, and
/// neither a directory nor a read-only file may be at `path`.
///
/// # Errors
/// [`WriteError::Io`] with the obstacle and a remedy.
pub fn ensure_writable(path: &Path) -> Result<(), WriteError> {
    let (target, existing) = resolve(path).map_err(|source| refused(path, source))?;
    match existing {
        Some(existing) if existing.is_dir() => {
            return Err(refused(path, ErrorKind::IsADirectory.into()));
        }
        // Only a write can show whether a device or pipe accepts data.
        Some(existing) if !existing.is_file() => return Ok(()),
        Some(existing) if existing.permissions().readonly() => {
            return Err(WriteError::Io {
                path: target,
                source: io::Error::new(ErrorKind::PermissionDenied, "the file is read-only"),
                remedy: "Make the file writable, or write to another name".into(),
            });
        }
        _ => {}
    }
    let directory = directory_of(&target);
    if !directory.is_dir() {
        return Err(WriteError::Io {
            path: directory.to_owned(),
            source: io::Error::new(ErrorKind::NotFound, "no such directory"),
            remedy: "Create the directory first, or write to another directory".into(),
        });
    }
    Temporary::create(&OsFileSystem, directory)
        .map(drop)
        .map_err(|source| refused(directory, source))
}

fn refused(path: &Path, source: io::Error) -> WriteError {
    let remedy = match source.kind() {
        ErrorKind::IsADirectory => "Give the name of a file",
        ErrorKind::NotFound => "Create the directory first, or write to another directory",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "Write to a directory that you may change"
        }
        ErrorKind::FileTooLarge => "Let files be larger (ulimit -f), or write to another place",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "Make room, or write to another disk",
        _ => "Write to another place",
    };
    WriteError::Io { path: path.to_owned(), source, remedy: remedy.into() }
}

/// A file with its content written to a temporary file, to be renamed to its destination.
struct Staged<'d> {
    target: PathBuf,
    /// The temporary file with the content; `None` if the content went straight to a device or pipe.
    content: Option<Temporary<'d>>,
    existed: bool,
    /// Whether the old file was moved aside, so that the destination is free.
    is_aside: bool,
    /// Hard link to the old file, or a copy on file systems without hard links, while the old file may have to be
    /// restored.
    previous: Option<Temporary<'d>>,
}

fn stage<'d>(
    disk: &'d dyn FileSystem,
    path: &Path,
    content: &dyn Fn(&mut (dyn Write + Send)) -> io::Result<()>,
) -> Result<Staged<'d>, WriteError> {
    let attempt = || {
        let (target, existing) = resolve(path)?;
        let existed = existing.is_some();
        if existing.as_ref().is_some_and(|existing| !existing.is_file() && !existing.is_dir()) {
            let mut out = BufWriter::new(OpenOptions::new().write(true).open(&target)?);
            content(&mut out)?;
            out.flush()?;
            return Ok(Staged { target, content: None, existed, is_aside: false, previous: None });
        }
        let (temporary, file) = Temporary::create(disk, directory_of(&target))?;
        let mut out = BufWriter::with_capacity(1 << 18, file);
        content(&mut out)?;
        let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
        if let Some(existing) = existing {
            // A change of the owner may clear bits of the permissions, so the owner comes first.
            file.set_owner(&existing);
            file.set_permissions(existing.permissions())?;
        }
        // Without this, a crash after the rename could leave an empty file under the new name.
        file.sync()?;
        Ok(Staged { target, content: Some(temporary), existed, is_aside: false, previous: None })
    };
    attempt().map_err(|source| refused(path, source))
}

impl<'d> Staged<'d> {
    /// Returns whether the destination exists with a content other than the new one.
    fn changes(&self) -> bool {
        self.content.as_ref().is_some_and(|content| {
            self.existed && !are_equal(&self.target, &content.path).unwrap_or(false)
        })
    }

    /// Moves the old file at the destination to a temporary name.
    fn set_aside(&mut self, disk: &'d dyn FileSystem) -> io::Result<()> {
        // A directory at the destination stays, and makes the later rename fail with an error that names it.
        if self.content.is_some() && self.target.is_file() {
            let directory = directory_of(&self.target);
            let previous = Temporary::named(disk, directory);
            disk.rename(&self.target, &previous.path)?;
            self.previous = Some(previous);
            self.is_aside = true;
            let _ = disk.sync_directory(directory);
        }
        Ok(())
    }

    /// Renames the temporary file to the destination. If `revertible`, the old file is kept under a temporary name
    /// before.
    fn commit(&mut self, disk: &'d dyn FileSystem, revertible: bool) -> io::Result<()> {
        let Some(content) = &self.content else { return Ok(()) };
        let directory = directory_of(&self.target);
        if revertible && self.existed {
            let previous = Temporary::named(disk, directory);
            // Some file systems have no hard links.
            disk.hard_link(&self.target, &previous.path)
                .or_else(|_| disk.copy(&self.target, &previous.path))?;
            self.previous = Some(previous);
        }
        disk.rename(&content.path, &self.target)?;
        // Makes the new name survive a crash. Errors are ignored, as some systems cannot open a directory.
        let _ = disk.sync_directory(directory);
        Ok(())
    }

    /// Restores the old file, or removes the new one if there was none. Returns a message with the remedy if the system
    /// refuses; `None` on success.
    fn revert(&mut self) -> Option<String> {
        let content = self.content.as_ref()?;
        let target = self.target.display();
        match self.previous.take() {
            Some(previous) => {
                content.disk.rename(&previous.path, &self.target).err()?;
                let kept = previous.keep();
                Some(format!("{target} is not as it was: its old content is in {}", kept.display()))
            }
            None if self.existed => None,
            None => {
                content.disk.remove(&self.target).err()?;
                Some(format!("{target} is there, and should not be"))
            }
        }
    }
}

/// Returns whether two files have equal contents. Reads the files piece by piece, as they may be as large as the memory.
fn are_equal(one: &Path, other: &Path) -> io::Result<bool> {
    let (mut one, mut other) = (File::open(one)?, File::open(other)?);
    let mut rest = one.metadata()?.len();
    if other.metadata()?.len() != rest {
        return Ok(false);
    }
    let mut pieces = [0; 2].map(|byte| vec![byte; 1 << 16]);
    while rest > 0 {
        let length = rest.min(1 << 16) as usize;
        let [a, b] = pieces.each_mut().map(|piece| &mut piece[..length]);
        one.read_exact(a)?;
        other.read_exact(b)?;
        if a != b {
            return Ok(false);
        }
        rest -= length as u64;
    }
    Ok(true)
}

/// The path of a temporary file. Dropping the value removes the file, unless the file was renamed or kept.
struct Temporary<'d> {
    path: PathBuf,
    disk: &'d dyn FileSystem,
    is_kept: bool,
}

impl<'d> Temporary<'d> {
    fn create(
        disk: &'d dyn FileSystem,
        directory: &Path,
    ) -> io::Result<(Temporary<'d>, Box<dyn NewFile>)> {
        loop {
            let path = Self::unused_name(directory);
            let mut temporaries = lock(&TEMPORARIES);
            match disk.create_new(&path) {
                Ok(file) => {
                    temporaries.push(path.clone());
                    return Ok((Temporary { path, disk, is_kept: false }, file));
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Returns an unused path, to which an existing file may be renamed or linked.
    fn named(disk: &'d dyn FileSystem, directory: &Path) -> Self {
        Temporary { path: Self::unused_name(directory), disk, is_kept: false }
    }

    /// Keeps the file on disk. Returns the path of the file.
    fn keep(mut self) -> PathBuf {
        self.is_kept = true;
        self.path.clone()
    }

    /// Returns an unused path in a directory. The name is short, as the destination's name may already have the maximum
    /// length.
    fn unused_name(directory: &Path) -> PathBuf {
        static COUNTER: AtomicU64 = AtomicU64::new(0);
        let number = COUNTER.fetch_add(1, Ordering::Relaxed);
        directory.join(format!(".mesh-io-{}-{number}.tmp", std::process::id()))
    }
}

impl Drop for Temporary<'_> {
    fn drop(&mut self) {
        if !self.is_kept {
            let _ = self.disk.remove(&self.path);
        }
        lock(&TEMPORARIES).retain(|path| *path != self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file_write(path: PathBuf, text: &'static str) -> FileWrite<'static> {
        (path, Box::new(move |out| out.write_all(text.as_bytes())))
    }

    fn entries(directory: &Path) -> usize {
        fs::read_dir(directory).unwrap().count()
    }

    #[test]
    fn a_failing_writer_leaves_everything_as_it_was() {
        let directory = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| directory.path().join(name));
        fs::write(&a, "old").unwrap();
        let failing: FileWrite<'_> = (
            b,
            Box::new(|out| {
                out.write_all(b"half")?;
                Err(ErrorKind::StorageFull.into())
            }),
        );
        let error = write_all(&[file_write(a.clone(), "new"), failing]).unwrap_err().to_string();
        assert!(error.contains("Make room"), "{error}");
        assert_eq!(fs::read_to_string(&a).unwrap(), "old");
        assert_eq!(entries(directory.path()), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_replaced_file_keeps_its_owner_group_and_mode() {
        use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        fs::write(&path, "old").unwrap();
        // Only root may give a file away. Other users check that their own files stay theirs.
        let _ = chown(&path, Some(12_345), Some(23_456));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        let facts = || {
            let found = fs::metadata(&path).unwrap();
            [found.uid(), found.gid(), found.mode() & 0o7777]
        };
        let before = facts();
        write(&path, b"new").unwrap();
        assert_eq!((facts(), fs::read_to_string(&path).unwrap().as_str()), (before, "new"));
    }

    #[test]
    fn a_failing_rename_brings_the_files_before_it_back() {
        let directory = tempfile::tempdir().unwrap();
        let [a, b, c] = ["a", "b", "c"].map(|name| directory.path().join(name));
        fs::write(&a, "old").unwrap();
        // A file cannot be renamed over a directory, so the write to `c` fails.
        fs::create_dir(&c).unwrap();
        let writes =
            [file_write(c, "new"), file_write(b.clone(), "new"), file_write(a.clone(), "new")];
        assert!(write_all(&writes).is_err());
        assert_eq!(fs::read_to_string(&a).unwrap(), "old");
        assert!(!b.exists());
        assert_eq!(entries(directory.path()), 2);
    }

    #[test]
    fn files_are_compared_to_their_last_byte() {
        let directory = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| directory.path().join(name));
        for length in [0, 1, 1 << 16, (1 << 17) + 1] {
            fs::write(&a, vec![7; length]).unwrap();
            for (other, expected) in [(length, true), (length + 1, false)] {
                fs::write(&b, vec![7; other]).unwrap();
                assert_eq!(are_equal(&a, &b).unwrap(), expected, "{length} and {other}");
            }
            if length > 0 {
                let mut content = vec![7; length];
                content[length - 1] = 8;
                fs::write(&b, content).unwrap();
                assert!(!are_equal(&a, &b).unwrap(), "{length}");
            }
        }
        assert!(are_equal(&a, &directory.path().join("missing")).is_err());
    }

    #[test]
    fn success_leaves_no_temporary_files() {
        let directory = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| directory.path().join(name));
        fs::write(&a, "old").unwrap();
        ensure_writable(&a).unwrap();
        write_all(&[file_write(a.clone(), "1"), file_write(b.clone(), "2")]).unwrap();
        assert_eq!(fs::read_to_string(&a).unwrap(), "1");
        assert_eq!(fs::read_to_string(&b).unwrap(), "2");
        assert_eq!(entries(directory.path()), 2);
    }
}
