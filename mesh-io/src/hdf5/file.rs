//! An HDF5 file as the tree of its groups and datasets.

use super::bytes::{DAMAGED, Hdf5Error};
use super::file_bytes::{FileBytes, SIGNATURE, user_block};
use super::groups::{self, Link, Target};
use super::header::Header;
use crate::disk::source::Source;
use crate::error::{Location, ReadError};
use std::collections::HashMap;

/// An HDF5 file with the headers and links of all its objects.
pub(crate) struct Hdf5<'a> {
    pub(crate) source: &'a Source,
    pub(super) raw: FileBytes<'a>,
    /// All objects to which the links of the root group lead. The root group is the first.
    objects: Vec<Object>,
}

/// A group, a dataset or a named datatype.
pub(crate) struct Object {
    /// Offset of the object header in the file.
    pub(crate) at: usize,
    pub(super) header: Result<Header, Hdf5Error>,
    links: Vec<Link>,
}

impl<'a> Hdf5<'a> {
    /// Reads the headers and links of all objects. The error of a damaged header is stored, and returned once the
    /// object is used.
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
                    // The names of all links exceed the file only if many links share a name, which no program writes.
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

    /// Reads a file of HDF5 or any other format; `None` if the file has no HDF5 signature, neither at its start nor behind
    /// a user block.
    pub(crate) fn open_any(source: &'a Source) -> Result<Option<Hdf5<'a>>, ReadError> {
        match source.bytes.starts_with(SIGNATURE) || user_block(&source.bytes).is_some() {
            true => Hdf5::open(source).map(Some),
            false => Ok(None),
        }
    }

    /// Returns the root group.
    pub(crate) fn root(&self) -> &Object {
        &self.objects[0]
    }

    /// Returns the object at a path from the root group, with slashes between names; `None` if there is none.
    pub(crate) fn find(&self, path: &[u8]) -> Option<&Object> {
        self.follow(self.root(), path, &mut 32)
    }

    /// Returns the object at a path from `group`, with slashes between names; `None` if there is none.
    pub(crate) fn child<'h>(&'h self, group: &'h Object, path: &[u8]) -> Option<&'h Object> {
        self.follow(group, path, &mut 32)
    }

    /// Returns the names and objects of a group, in the order of the file. Links without a readable target are skipped.
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

    /// Follows a path from an object, over at most `left` soft links.
    fn follow<'h>(&'h self, from: &'h Object, path: &[u8], left: &mut u32) -> Option<&'h Object> {
        /// Limit on the names in a path. No program writes longer paths.
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

    /// Makes the read error of damage or an unsupported feature, with the name of this file.
    #[cold]
    pub(crate) fn error(&self, fault: Hdf5Error) -> ReadError {
        error_of(self.source, fault)
    }

    /// Opens a file, calls `read`, and checks that the byte ranges of different objects do not overlap.
    pub(crate) fn read<T>(
        source: &Source,
        read: impl FnOnce(&Hdf5<'_>) -> Result<T, ReadError>,
    ) -> Result<T, ReadError> {
        let hdf5 = Hdf5::open(source)?;
        let found = read(&hdf5)?;
        hdf5.check_no_overlaps()?;
        Ok(found)
    }

    /// Checks that the byte ranges of different objects do not overlap, so that an edit of one object changes no other.
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
