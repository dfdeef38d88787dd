//! Tests of writes to failing disks: each request fails alone, and each pair of requests fails together.

use crate::disk::atomic::{FileWrite, write_all_if};
use crate::disk::file_system::{FileSystem, NewFile, OsFileSystem};
use std::fs::{self, Metadata, Permissions};
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A file system that passes requests to the operating system, except for chosen requests, which fail.
#[derive(Clone, Default)]
struct Faults {
    /// Number of requests so far.
    asked: Arc<AtomicUsize>,
    /// Numbers of the requests that fail, counted from 0.
    failing: Vec<usize>,
    /// Number of the first request that finds the disk full. Requests that need no space succeed even then.
    full_from: Option<usize>,
    has_links: bool,
}

impl Faults {
    fn ask(&self, takes_room: bool) -> io::Result<()> {
        let number = self.asked.fetch_add(1, Ordering::Relaxed);
        if takes_room && self.full_from.is_some_and(|from| number >= from) {
            return Err(ErrorKind::StorageFull.into());
        }
        match self.failing.contains(&number) {
            true => Err(io::Error::other("a fault of the disk")),
            false => Ok(()),
        }
    }
}

impl FileSystem for Faults {
    fn create_new(&self, path: &Path) -> io::Result<Box<dyn NewFile>> {
        self.ask(true)?;
        Ok(Box::new(Faulty { file: OsFileSystem.create_new(path)?, faults: self.clone() }))
    }

    fn hard_link(&self, path: &Path, second: &Path) -> io::Result<()> {
        self.ask(true)?;
        match self.has_links {
            true => OsFileSystem.hard_link(path, second),
            false => Err(ErrorKind::Unsupported.into()),
        }
    }

    fn copy(&self, from: &Path, to: &Path) -> io::Result<()> {
        let done = self.ask(true);
        // A copy that fails may leave a part of the file.
        OsFileSystem.copy(from, to)?;
        done
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.ask(false)?;
        OsFileSystem.rename(from, to)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        // Removal never fails, as the test could not clean up otherwise.
        OsFileSystem.remove(path)
    }

    fn sync_directory(&self, path: &Path) -> io::Result<()> {
        self.ask(path.is_dir())
    }
}

struct Faulty {
    file: Box<dyn NewFile>,
    faults: Faults,
}

impl Write for Faulty {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let done = self.faults.ask(true);
        // Half of the bytes arrive, whether the request fails or not.
        let written = self.file.write(&bytes[..bytes.len().div_ceil(2)])?;
        done.map(|()| written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.faults.ask(true)?;
        self.file.flush()
    }
}

impl NewFile for Faulty {
    fn set_owner(&self, existing: &Metadata) {
        self.file.set_owner(existing);
    }

    fn set_permissions(&self, permissions: Permissions) -> io::Result<()> {
        self.faults.ask(true)?;
        self.file.set_permissions(permissions)
    }

    fn sync(&self) -> io::Result<()> {
        // The files of this test need not survive a crash.
        self.faults.ask(true)
    }
}

const NAMES: [&str; 3] = ["out.node", "out.ele", "out.poly"];

/// Writes three files to a failing disk. `old` says which files existed before. Checks that either all files are new or
/// all are old, without leftover files. Returns whether the files are new.
fn write_three(faults: &Faults, old: [bool; 3], is_same_mesh: bool) -> bool {
    let directory = tempfile::tempdir().unwrap();
    let paths = NAMES.map(|name| directory.path().join(name));
    let content = |path: &Path| format!("new {}", path.display()).repeat(3);
    // If the mesh is the same, only the file with the vertices changes.
    let old_content = |path: &Path| match is_same_mesh && !path.ends_with(NAMES[0]) {
        true => content(path),
        false => format!("old {}", path.display()),
    };
    for (path, _) in paths.iter().zip(old).filter(|(_, old)| *old) {
        fs::write(path, old_content(path)).unwrap();
    }
    let file_write = |path: &Path| -> FileWrite<'_> {
        let text = content(path);
        (path.to_owned(), Box::new(move |out| out.write_all(text.as_bytes())))
    };
    let writes: Vec<_> = paths.iter().map(|path| file_write(path)).collect();
    let done = write_all_if(faults, &writes, &|| Ok(()));
    drop(writes);
    let told = format!("{done:?} after {:?} of {old:?}", faults.failing);
    let message = done.as_ref().err().map(|error| error.to_string()).unwrap_or_default();
    // Counts the old contents that could not be restored.
    let mut expected = message.matches(" its old content is in ").count();
    for (path, was_there) in paths.iter().zip(old) {
        let found = fs::read_to_string(path).ok();
        let kept = was_there.then(|| old_content(path));
        let name = path.display().to_string();
        match done {
            Ok(()) => assert_eq!(found, Some(content(path)), "{told}"),
            // If the old content could not be restored, the message says where it is.
            Err(_) if found != kept => match message
                .split(&format!("{name} is not as it was: its old content is in "))
                .nth(1)
            {
                Some(rest) => {
                    let backup = rest.split(". ").next().unwrap();
                    assert_eq!(fs::read_to_string(backup).ok(), kept, "{told}");
                }
                None => {
                    assert!(message.contains(&format!("{name} is there, and should not")), "{told}")
                }
            },
            Err(_) => {}
        }
        expected += usize::from(found.is_some());
    }
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), expected, "{told}");
    done.is_ok()
}

#[test]
fn whichever_disk_request_fails_all_files_are_old_or_all_new() {
    let (mut failed, mut survived) = (0, 0);
    for (has_links, same) in [(true, false), (false, false), (true, true), (false, true)] {
        for old in [[true; 3], [false; 3], [true, false, true], [false, true, true]] {
            let faults = Faults { has_links, ..Faults::default() };
            assert!(write_three(&faults, old, same));
            let requests = faults.asked.load(Ordering::Relaxed);
            assert!(requests > 12, "only {requests} requests");
            for first in 0..requests {
                let alone = Faults { failing: vec![first], has_links, ..Faults::default() };
                *(if write_three(&alone, old, same) { &mut survived } else { &mut failed }) += 1;
                let full = Faults { full_from: Some(first), has_links, ..Faults::default() };
                write_three(&full, old, same);
                // The second fault does not depend on which files existed, so one case covers it.
                let seconds =
                    if old == [true; 3] && !same { first + 1..requests + 4 } else { 0..0 };
                for second in seconds {
                    let two =
                        Faults { failing: vec![first, second], has_links, ..Faults::default() };
                    write_three(&two, old, same);
                }
            }
        }
    }
    // Two kinds of requests may fail without harm: forcing names to the disk, and hard links where a copy works.
    assert!(failed > 100 && survived > 20, "{failed} failed, {survived} survived");
}
