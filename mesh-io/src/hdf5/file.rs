//! A file as the tree of its groups and datasets.

use super::bytes::{DAMAGED, Hdf5Error};
use super::file_bytes::{FileBytes, SIGNATURE};
use super::groups::{self, Link, Target};
use super::header::Header;
use crate::disk::source::Source;
use crate::error::{Location, ReadError};
use std::collections::HashMap;

/// A file with all its objects.
pub(crate) struct Hdf5<'a> {
    pub(crate) source: &'a Source,
    pub(super) raw: FileBytes<'a>,
    /// The root group is the first.
    objects: Vec<Object>,
}

/// A group, a dataset or a named type.
pub(crate) struct Object {
    /// Where its header stands.
    pub(crate) at: usize,
    pub(super) header: Result<Header, Hdf5Error>,
    links: Vec<Link>,
}

impl<'a> Hdf5<'a> {
    /// Reads the tree of a file. What is wrong with an object is told once it is asked for.
    pub(crate) fn open(source: &'a Source) -> Result<Hdf5<'a>, ReadError> {
        let told = |fault| error_of(source, fault);
        let (raw, root) = FileBytes::new(&source.bytes).map_err(told)?;
        let mut objects: Vec<Object> = Vec::new();
        let mut known: HashMap<usize, usize> = HashMap::from([(root, 0)]);
        let mut found = vec![root];
        let mut letters = 0_usize;
        while let Some(&at) = found.get(objects.len()) {
            let header = Header::read(&raw, at);
            let mut links = Vec::new();
            if let Ok(header) = &header {
                groups::links(&raw, header, &mut |name, place| {
                    letters = letters.saturating_add(name.len());
                    let target = place.map(|at| {
                        *known.entry(at).or_insert_with(|| {
                            found.push(at);
                            found.len() - 1
                        })
                    });
                    links.push(Link { name, target });
                    // Names that many links share are no program's work.
                    match letters > source.bytes.len() {
                        true => Err(Hdf5Error::damaged(at, "a group with its names")),
                        false => Ok(()),
                    }
                })
                .map_err(told)?;
            }
            objects.push(Object { at, header, links });
        }
        raw.allow_rereads();
        Ok(Hdf5 { source, raw, objects })
    }

    /// The same of a file that may be of another format; none if it is.
    pub(crate) fn open_any(source: &'a Source) -> Result<Option<Hdf5<'a>>, ReadError> {
        match source.bytes.starts_with(SIGNATURE) {
            true => Hdf5::open(source).map(Some),
            false => Ok(None),
        }
    }

    /// The root group.
    pub(crate) fn root(&self) -> &Object {
        &self.objects[0]
    }

    /// The object of a path, with a slash between names. None if there is none.
    pub(crate) fn find(&self, path: &[u8]) -> Option<&Object> {
        self.follow(self.root(), path, &mut 32)
    }

    /// What a group has by a name or a path; none if it has nothing so called.
    pub(crate) fn child<'h>(&'h self, group: &'h Object, path: &[u8]) -> Option<&'h Object> {
        self.follow(group, path, &mut 32)
    }

    /// What a group holds, by name, in the order of the file.
    pub(crate) fn children<'h>(
        &'h self,
        group: &'h Object,
    ) -> impl Iterator<Item = (&'h [u8], &'h Object)> {
        group
            .links
            .iter()
            .filter_map(|link| Some((&link.name[..], self.of_link(group, link, &mut 32)?)))
    }

    fn of_link(&self, group: &Object, link: &Link, left: &mut u32) -> Option<&Object> {
        match &link.target {
            Target::Object(number) => self.objects.get(*number),
            Target::Soft(path) => {
                *left = left.checked_sub(1)?;
                let from = if path.starts_with(b"/") { self.root() } else { self.at(group.at)? };
                self.follow(from, path, left)
            }
            Target::OtherFile => None,
        }
    }

    fn at(&self, at: usize) -> Option<&Object> {
        self.objects.iter().find(|object| object.at == at)
    }

    /// Follows a path over so many links to other paths.
    fn follow<'h>(&'h self, from: &'h Object, path: &[u8], left: &mut u32) -> Option<&'h Object> {
        // Longer paths are no program's work.
        /// Limit on the names of a path. Programs write no longer paths.
        const MAX_PATH_NAMES: usize = 64;
        let mut object = from;
        for (number, name) in path.split(|&byte| byte == b'/').enumerate() {
            if number == MAX_PATH_NAMES {
                return None;
            }
            if !name.is_empty() && name != b"." {
                let link = object.links.iter().find(|link| link.name == name)?;
                object = self.of_link(object, link, left)?;
            }
        }
        Some(object)
    }

    /// The error of a fault in this file.
    #[cold]
    pub(crate) fn error(&self, fault: Hdf5Error) -> ReadError {
        error_of(self.source, fault)
    }

    /// Opens a file, reads it, and checks that no two of the parts that were read share bytes.
    pub(crate) fn read<T>(
        source: &Source,
        read: impl FnOnce(&Hdf5<'_>) -> Result<T, ReadError>,
    ) -> Result<T, ReadError> {
        let hdf5 = Hdf5::open(source)?;
        let found = read(&hdf5)?;
        hdf5.check_no_overlaps()?;
        Ok(found)
    }

    /// Checks that no two of the things that were read share bytes, so that what is written to one changes no other.
    pub(crate) fn check_no_overlaps(&self) -> Result<(), ReadError> {
        match self.raw.first_overlap() {
            None => Ok(()),
            Some(at) => Err(self.error(Hdf5Error {
                at,
                problem: "two parts of the HDF5 file overlap".into(),
                remedy: DAMAGED,
            })),
        }
    }
}

#[cold]
fn error_of(source: &Source, Hdf5Error { at, problem, remedy }: Hdf5Error) -> ReadError {
    source.error_at(Location::Byte(at.min(source.bytes.len())), problem, remedy)
}
