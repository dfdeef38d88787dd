//! Replaces files as a whole: whatever happens, the old content is there or the new one, and several files are
//! replaced together or not at all.

use crate::disk::file_system::{FileSystem, NewFile, OsFileSystem};
use crate::disk::paths::{directory_of, resolve};
use crate::error::WriteError;
use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A file to be written: its path, and a function that writes its content.
pub(crate) type FileWrite<'a> =
    (PathBuf, Box<dyn Fn(&mut (dyn Write + Send)) -> io::Result<()> + 'a>);

/// Writes a file so that it has either its old content or all of the new one, whatever happens meanwhile.
///
/// The content is first written beside the file, to the same disk, then takes its place. Symbolic links are followed
/// and permissions kept. What is no regular file, a device or a pipe, is written to directly.
///
/// # Errors
/// [`WriteError::Io`] if the system refuses; what stood at `path` then still stands there.
pub fn write(path: &Path, content: &[u8]) -> Result<(), WriteError> {
    write_all(&[(path.to_owned(), Box::new(|out| out.write_all(content)))])
}

/// Writes several files as [`write()`] does, all or none.
///
/// Contents go to temporary files first, which are renamed from the last entry to the first. The first entry is
/// the main file of the mesh, which readers open: until the main file is renamed, readers see no new mesh. If
/// another file changes too, the old first file is moved aside before, so that old and new files are never mixed.
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
    // Declared before what it protects, so that it is dropped after it.
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
            // The first one last, as it makes a mesh of them.
            let lost: Vec<_> = touched.rev().filter_map(|(_, it)| it.revert()).collect();
            return Err(with_lost(error, &lost));
        }
    }
    Ok(())
}

/// The error of a write after which some files could not be brought back either.
fn with_lost(error: WriteError, lost: &[String]) -> WriteError {
    match error {
        WriteError::Io { path, source, remedy } if !lost.is_empty() => {
            WriteError::Io { path, source, remedy: format!("{remedy}. {}", lost.join(". ")) }
        }
        error => error,
    }
}

/// Held while written files take their places.
static COMMITTING: Mutex<()> = Mutex::new(());
/// The temporary files of this process.
static TEMPORARIES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn lock<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps every thread from writing mesh files, see [`discard_pending_writes`].
pub struct BlockedWrites {
    _committing: MutexGuard<'static, ()>,
    _temporaries: MutexGuard<'static, Vec<PathBuf>>,
}

/// Removes the temporary files of all writes that are under way on other threads, for a program that is about to end:
/// [`std::process::exit`] would leave the files behind. Waits until writes that are renaming their files have
/// finished. No thread can write a mesh file as long as the returned value lives.
pub fn discard_pending_writes() -> BlockedWrites {
    let (committing, mut temporaries) = (lock(&COMMITTING), lock(&TEMPORARIES));
    for path in temporaries.drain(..) {
        let _ = fs::remove_file(path);
    }
    BlockedWrites { _committing: committing, _temporaries: temporaries }
}

/// Checks, as far as is possible without writing, whether [`write()`] can work: that the directory exists and takes new
/// files, and that no directory or read-only file is in the way.
///
/// # Errors
/// [`WriteError::Io`] that says what is wrong.
pub fn ensure_writable(path: &Path) -> Result<(), WriteError> {
    let (target, existing) = resolve(path).map_err(|source| refused(path, source))?;
    match existing {
        Some(existing) if existing.is_dir() => {
            return Err(refused(path, ErrorKind::IsADirectory.into()));
        }
        // A device or pipe: only writing to it can tell.
        Some(existing) if !existing.is_file() => return Ok(()),
        Some(existing) if existing.permissions().readonly() => {
            return Err(WriteError::Io {
                path: target,
                source: io::Error::new(ErrorKind::PermissionDenied, "the file is read-only"),
                remedy: "Make it writable, or write to another name".into(),
            });
        }
        _ => {}
    }
    let directory = directory_of(&target);
    if !directory.is_dir() {
        return Err(WriteError::Io {
            path: directory.to_owned(),
            source: io::Error::new(ErrorKind::NotFound, "no such directory"),
            remedy: "Create the directory first, or write to another one".into(),
        });
    }
    Temporary::create(&OsFileSystem, directory)
        .map(drop)
        .map_err(|source| refused(directory, source))
}

fn refused(path: &Path, source: io::Error) -> WriteError {
    let remedy = match source.kind() {
        ErrorKind::IsADirectory => "Give the name of a file",
        ErrorKind::NotFound => "Create the directory first, or write to another one",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "Write to a directory that you may change"
        }
        ErrorKind::FileTooLarge => "Let files be larger (ulimit -f), or write to another place",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "Make room, or write to another disk",
        _ => "Write to another place",
    };
    WriteError::Io { path: path.to_owned(), source, remedy: remedy.into() }
}

/// A written file that waits to take its place.
struct Staged<'d> {
    target: PathBuf,
    /// None if the content went straight to a device or pipe.
    content: Option<Temporary<'d>>,
    existed: bool,
    /// Whether the file that stood there has been given its other name, and there is none.
    is_aside: bool,
    /// A second name of the file that stood there, or a copy where there are no second names, as long as it may have to be
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
            file.set_permissions(existing.permissions())?;
        }
        // Otherwise a crash could leave the new name with none of the content.
        file.sync()?;
        Ok(Staged { target, content: Some(temporary), existed, is_aside: false, previous: None })
    };
    attempt().map_err(|source| refused(path, source))
}

impl<'d> Staged<'d> {
    /// Whether the file that stands there has another content.
    fn changes(&self) -> bool {
        let read = |path: &Path| fs::read(path).ok();
        match &self.content {
            Some(content) => self.existed && read(&self.target) != read(&content.path),
            None => false,
        }
    }

    /// Gives the file that stands there another name.
    fn set_aside(&mut self, disk: &'d dyn FileSystem) -> io::Result<()> {
        // What is no file stays in the way, and is told as that.
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

    fn commit(&mut self, disk: &'d dyn FileSystem, revertible: bool) -> io::Result<()> {
        let Some(content) = &self.content else { return Ok(()) };
        let directory = directory_of(&self.target);
        if revertible && self.existed {
            let previous = Temporary::named(disk, directory);
            // Not every system has second names.
            disk.hard_link(&self.target, &previous.path)
                .or_else(|_| disk.copy(&self.target, &previous.path))?;
            self.previous = Some(previous);
        }
        disk.rename(&content.path, &self.target)?;
        // So that the new name outlasts a crash too. Not every system lets a directory be opened for that.
        let _ = disk.sync_directory(directory);
        Ok(())
    }

    /// Brings back what stood there. Says what to do if the system refuses.
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

/// The path of a temporary file. Dropping it removes the file, unless the file was renamed.
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

    /// A name that a file may be given.
    fn named(disk: &'d dyn FileSystem, directory: &Path) -> Self {
        Temporary { path: Self::unused_name(directory), disk, is_kept: false }
    }

    /// Leaves the file where it is.
    fn keep(mut self) -> PathBuf {
        self.is_kept = true;
        self.path.clone()
    }

    /// An unused name. It is short, as the destination's own name may be as long as names can be.
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

    #[test]
    fn a_failing_rename_brings_the_files_before_it_back() {
        let directory = tempfile::tempdir().unwrap();
        let [a, b, c] = ["a", "b", "c"].map(|name| directory.path().join(name));
        fs::write(&a, "old").unwrap();
        // No file can take the place of a directory.
        fs::create_dir(&c).unwrap();
        let writes =
            [file_write(c, "new"), file_write(b.clone(), "new"), file_write(a.clone(), "new")];
        assert!(write_all(&writes).is_err());
        assert_eq!(fs::read_to_string(&a).unwrap(), "old");
        assert!(!b.exists());
        assert_eq!(entries(directory.path()), 2);
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
