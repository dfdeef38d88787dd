//! Whether a file is still as it was read or written.

use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime};

/// The age from which a time of change tells any later change. Times on FAT have steps of two seconds.
const SETTLED: Duration = Duration::from_secs(2);

/// What the system says of a file without reading it. A file with an equal stamp has not changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stamp {
    length: u64,
    modified: SystemTime,
    /// Inode, and seconds and nanoseconds of the last change of content or attributes.
    #[cfg(unix)]
    inode: [i64; 3],
}

impl Stamp {
    /// Returns the stamp of a regular file; `None` for anything else.
    fn of(path: &Path) -> Option<Stamp> {
        let about = fs::metadata(path).ok().filter(Metadata::is_file)?;
        #[cfg(unix)]
        let inode = {
            use std::os::unix::fs::MetadataExt;
            [about.ino().cast_signed(), about.ctime(), about.ctime_nsec()]
        };
        Some(Stamp {
            length: about.len(),
            modified: about.modified().ok()?,
            #[cfg(unix)]
            inode,
        })
    }
}

/// The last state of a file that this process knows. Any thread may note a new one.
#[derive(Debug, Default)]
pub(crate) struct KnownState(Mutex<Option<Stamp>>);

impl KnownState {
    /// Returns the state of a file that is about to be read. Nothing is known of a file that changed in the last two seconds: a
    /// change after reading could have the same time.
    pub(crate) fn before_reading(path: &Path) -> KnownState {
        let is_settled = |stamp: &Stamp| stamp.modified.elapsed().is_ok_and(|age| age >= SETTLED);
        KnownState(Mutex::new(Stamp::of(path).filter(is_settled)))
    }

    /// Notes the state of a file that this process has just written.
    pub(crate) fn note_written(&self, path: &Path) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Stamp::of(path);
    }

    /// Whether a file has changed: it has neither the known state nor these bytes. What is no regular file any more, or cannot
    /// be read, counts as unchanged, as it has no content to lose or cannot be replaced.
    pub(crate) fn is_past(&self, path: &Path, bytes: &[u8]) -> bool {
        let Some(now) = Stamp::of(path) else { return false };
        let known = *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known != Some(now) && has_content(path, bytes).is_ok_and(|is_same| !is_same)
    }
}

/// Whether a file has exactly these bytes.
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
        assert!(!known.is_past(&path, b"abc"));
        // The same bytes in a new file are unchanged.
        fs::remove_file(&path).unwrap();
        assert!(!known.is_past(&path, b"abc"));
        fs::write(&path, "abc").unwrap();
        assert!(!known.is_past(&path, b"abc"));
        for other in ["abd", "ab", "abcd", ""] {
            fs::write(&path, other).unwrap();
            assert!(known.is_past(&path, b"abc"), "{other}");
        }
        known.note_written(&path);
        assert!(!known.is_past(&path, b"abc"));
        fs::write(&path, "longer").unwrap();
        assert!(known.is_past(&path, b"abc"));
    }
}
