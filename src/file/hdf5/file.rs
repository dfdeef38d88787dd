//! A file as the tree of its groups and datasets.

use super::bytes::{Bytes, DAMAGED, Fault, Widths};
use super::groups::{self, Link, Target};
use super::header::Header;
use super::sum::Sum;
use crate::error::{Location, ReadError};
use crate::file::source::Source;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::ops::Range;

/// What a file starts with.
pub(in crate::file) const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1A\n";

/// A file with all its objects.
pub(in crate::file) struct Hdf5<'a> {
    pub(super) source: &'a Source,
    pub(super) raw: Raw<'a>,
    /// The root group is the first.
    objects: Vec<Object>,
}

/// A group, a dataset or a named type.
pub(in crate::file) struct Object {
    /// Where its header stands.
    pub(in crate::file) at: usize,
    pub(super) header: Result<Header, Fault>,
    links: Vec<Link>,
}

/// The bytes of a file, and what its superblock says of them.
pub(super) struct Raw<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) widths: Widths,
    pub(super) end: End,
    /// What has been read, each part of which is of one thing alone, with where that starts.
    taken: RefCell<Vec<(Range<usize>, usize)>>,
    /// How many bytes of metadata may still be read. Where parts of a file lead to each other in circles, they would be read
    /// forever.
    left: Cell<usize>,
}

/// How many times the length of the file is read of metadata at most, once the tree is known: those of a dataset are read anew
/// each time it is asked for.
const AGAIN: usize = 64;

/// Where the superblock says how long the file is.
#[derive(Clone, Debug)]
pub(super) struct End {
    pub(super) place: Range<usize>,
    pub(super) sum: Option<Sum>,
}

impl<'a> Raw<'a> {
    /// Reads the superblock. Returns where the header of the root group stands, too.
    fn new(bytes: &'a [u8]) -> Result<(Raw<'a>, usize), Fault> {
        let what = "the superblock of the HDF5 file";
        let none = Widths { address: 8, length: 8 };
        let mut own = Bytes::new(bytes, 0, none, what);
        own.expect(SIGNATURE)?;
        let version = own.byte()?;
        own.skip(match version {
            0 | 1 => 4,
            2 | 3 => 0,
            _ => return Err(own.unread(format!("HDF5 with a superblock of version {version}"))),
        })?;
        let widths = Widths { address: own.byte()?.into(), length: own.byte()?.into() };
        if ![widths.address, widths.length].iter().all(|width| [2, 4, 8].contains(width)) {
            return Err(own.damaged());
        }
        // Those of the trees, and flags.
        own.skip(match version {
            0 => 1 + 4 + 4,
            1 => 1 + 4 + 4 + 4,
            _ => 1,
        })?;
        let mut own = Bytes::new(bytes, own.at(), widths, what);
        if own.address()? != Some(0) {
            return Err(own.unread("HDF5 that does not start with the file"));
        }
        own.skip(widths.address)?;
        let place = own.at()..own.at() + widths.address;
        own.skip(widths.address)?;
        let sum;
        let root;
        if version < 2 {
            // What the driver needs, and the name of the root group.
            own.skip(2 * widths.address)?;
            (root, sum) = (own.address()?, None);
        } else {
            root = own.address()?;
            sum = Some(Sum::take(0, &mut own)?);
        }
        let root = root.ok_or_else(|| own.damaged())?;
        let taken = RefCell::new(vec![(0..own.at(), 0)]);
        let left = Cell::new(bytes.len());
        Ok((Raw { bytes, widths, end: End { place, sum }, taken, left }, root))
    }

    /// Stands at a place of the file.
    pub(super) fn at(&self, at: usize, what: &'static str) -> Bytes<'a> {
        Bytes::new(self.bytes, at, self.widths, what)
    }

    /// Notes that a range of metadata was read, which has to lie in the file.
    pub(super) fn take(&self, range: Range<usize>, of: &Bytes<'_>) -> Result<(), Fault> {
        if range.end > self.bytes.len() {
            return Err(of.damaged());
        }
        let left = self.left.get().checked_sub(range.len());
        self.left.set(left.ok_or_else(|| of.damaged())?);
        self.taken.borrow_mut().push((range.clone(), range.start));
        Ok(())
    }

    /// Notes that the data of an object were read.
    pub(super) fn take_data(&self, ranges: impl Iterator<Item = Range<usize>>, object: usize) {
        self.taken.borrow_mut().extend(ranges.map(|range| (range, object)));
    }
}

impl<'a> Hdf5<'a> {
    /// Reads the tree of a file. What is wrong with an object is told once it is asked for.
    pub(in crate::file) fn open(source: &'a Source) -> Result<Hdf5<'a>, ReadError> {
        let told = |fault| error_of(source, fault);
        let (raw, root) = Raw::new(&source.bytes).map_err(told)?;
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
                        true => Err(Fault::damaged(at, "a group with its names")),
                        false => Ok(()),
                    }
                })
                .map_err(told)?;
            }
            objects.push(Object { at, header, links });
        }
        raw.left.set(source.bytes.len().saturating_mul(AGAIN));
        Ok(Hdf5 { source, raw, objects })
    }

    /// The same of a file that may be of another format; none if it is.
    pub(in crate::file) fn open_any(source: &'a Source) -> Result<Option<Hdf5<'a>>, ReadError> {
        match source.bytes.starts_with(SIGNATURE) {
            true => Hdf5::open(source).map(Some),
            false => Ok(None),
        }
    }

    /// The root group.
    pub(in crate::file) fn root(&self) -> &Object {
        &self.objects[0]
    }

    /// The object of a path, with a slash between names. None if there is none.
    pub(in crate::file) fn find(&self, path: &[u8]) -> Option<&Object> {
        self.follow(self.root(), path, &mut 32)
    }

    /// What a group holds, by name, in the order of the file.
    pub(in crate::file) fn children<'h>(
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
            Target::Elsewhere => None,
        }
    }

    fn at(&self, at: usize) -> Option<&Object> {
        self.objects.iter().find(|object| object.at == at)
    }

    /// Follows a path over so many links to other paths.
    fn follow<'h>(&'h self, from: &'h Object, path: &[u8], left: &mut u32) -> Option<&'h Object> {
        let mut object = from;
        for name in path.split(|&byte| byte == b'/') {
            if !name.is_empty() && name != b"." {
                let link = object.links.iter().find(|link| link.name == name)?;
                object = self.of_link(object, link, left)?;
            }
        }
        Some(object)
    }

    /// The error of a fault in this file.
    #[cold]
    pub(in crate::file) fn error(&self, fault: Fault) -> ReadError {
        error_of(self.source, fault)
    }

    /// Checks that no two of the things that were read share bytes, so that what is written to one changes no other.
    pub(in crate::file) fn check_apart(&self) -> Result<(), ReadError> {
        let mut taken = self.raw.taken.borrow_mut();
        taken.retain(|(range, _)| !range.is_empty());
        taken.sort_by_key(|(range, owner)| (range.start, range.end, *owner));
        taken.dedup();
        let shared = taken.windows(2).find(|pair| pair[0].0.end > pair[1].0.start);
        match shared {
            None => Ok(()),
            Some(pair) => Err(self.error(Fault {
                at: pair[1].0.start,
                problem: "two parts of the HDF5 file overlap".into(),
                remedy: DAMAGED,
            })),
        }
    }
}

#[cold]
fn error_of(source: &Source, Fault { at, problem, remedy }: Fault) -> ReadError {
    source.error_at(Location::Byte(at.min(source.bytes.len())), problem, remedy)
}
