//! Detection of files that have changed since they were read or written.

use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime};

/// Age of a file from which a later change surely gets another modification time. Modification times on FAT have steps
/// of two seconds.
const MIN_AGE: Duration = Duration::from_secs(2);

/// Length, time of change and inode of a regular file. A file with an equal stamp has not changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FileStamp {
    length: u64,
    modified: SystemTime,
    /// Inode, and seconds and nanoseconds of the last change of content or attributes.
    #[cfg(unix)]
    inode: [i64; 3],
}

impl FileStamp {
    /// Returns the stamp of a regular file; `None` for anything else.
    fn of(path: &Path) -> Option<FileStamp> {
        let about = fs::metadata(path).ok().filter(Metadata::is_file)?;
        #[cfg(unix)]
        let inode = {
            use std::os::unix::fs::MetadataExt;
            [about.ino().cast_signed(), about.ctime(), about.ctime_nsec()]
        };
        Some(FileStamp {
            length: about.len(),
            modified: about.modified().ok()?,
            #[cfg(unix)]
            inode,
        })
    }
}

/// Latest known stamp of a file; `None` if unknown. Any thread may store a new stamp.
#[derive(Debug, Default)]
pub(crate) struct KnownState(Mutex<Option<FileStamp>>);

impl KnownState {
    /// Returns the stamp of a file before it is read. The stamp is unknown if the file changed in the last two seconds:
    /// a change after the read could leave the modification time unchanged.
    pub(crate) fn before_reading(path: &Path) -> KnownState {
        let is_settled =
            |stamp: &FileStamp| stamp.modified.elapsed().is_ok_and(|age| age >= MIN_AGE);
        KnownState(Mutex::new(FileStamp::of(path).filter(is_settled)))
    }

    /// Stores the stamp of a file that this process has just written.
    pub(crate) fn note_written(&self, path: &Path) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = FileStamp::of(path);
    }

    /// Returns whether a file has changed: both stamp and content differ from the known stamp and `bytes`. A path
    /// without a regular file counts as unchanged, as there is no content to lose. An unreadable file counts as
    /// unchanged too.
    pub(crate) fn has_changed(&self, path: &Path, bytes: &[u8]) -> bool {
        let Some(now) = FileStamp::of(path) else { return false };
        let known = *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known != Some(now) && has_content(path, bytes).is_ok_and(|is_same| !is_same)
    }
}

/// Returns whether a file has exactly the content `bytes`.
fn has_content(path: &Path, mut bytes: &[u8]) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let mut chunk = vec![0; bytes.len().clamp(1, 1 << 20)];
    loop {
        match file.read(&mut chunk) {
            Ok(0) => return Ok(bytes.is_empty()),
            Ok(read) => match bytes.strip_prefix(&chunk[..read]) {
                Some(rest) => bytes = rest,
                None => return Ok(false),
            },
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_past_once_its_bytes_are_others() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        fs::write(&path, "abc").unwrap();
        let known = KnownState::before_reading(&path);
        assert!(!known.has_changed(&path, b"abc"));
        // The same bytes in a new file are unchanged.
        fs::remove_file(&path).unwrap();
        assert!(!known.has_changed(&path, b"abc"));
        fs::write(&path, "abc").unwrap();
        assert!(!known.has_changed(&path, b"abc"));
        for other in ["abd", "ab", "abcd", ""] {
            fs::write(&path, other).unwrap();
            assert!(known.has_changed(&path, b"abc"), "{other}");
        }
        known.note_written(&path);
        assert!(!known.has_changed(&path, b"abc"));
        fs::write(&path, "longer").unwrap();
        assert!(known.has_changed(&path, b"abc"));
    }
}
