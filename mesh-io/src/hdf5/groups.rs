//! The links of a group, in each of the ways that files have them.

use super::btree::{self, Tree};
use super::bytes::{ByteReader, Hdf5Error};
use super::file_bytes::FileBytes;
use super::header::{Header, LINK, LINK_INFO, SYMBOL_TABLE};
use super::heap::FractalHeap;

/// What a group calls one of its objects.
pub(super) struct Link {
    pub(super) name: Vec<u8>,
    pub(super) target: Target<usize>,
}

/// What a link leads to.
pub(super) enum Target<O> {
    Object(O),
    /// Another path.
    Soft(Vec<u8>),
    /// An object of another file, which is not read.
    OtherFile,
}

impl<O> Target<O> {
    pub(super) fn map<P>(self, make: impl FnOnce(O) -> P) -> Target<P> {
        match self {
            Target::Object(object) => Target::Object(make(object)),
            Target::Soft(path) => Target::Soft(path),
            Target::OtherFile => Target::OtherFile,
        }
    }
}

/// Called with the name and the target of each link of a group.
type LinkVisitor<'t> = dyn FnMut(Vec<u8>, Target<usize>) -> Result<(), Hdf5Error> + 't;

/// Hands on the links of a group; none if the object is no group.
pub(super) fn links(
    raw: &FileBytes<'_>,
    header: &Header,
    take: &mut LinkVisitor<'_>,
) -> Result<(), Hdf5Error> {
    for message in header.of(LINK) {
        let bytes = raw.at(message.content.start, "a link");
        link(bytes.within(message.content.clone()), take)?;
    }
    for message in header.of(SYMBOL_TABLE) {
        let mut bytes =
            raw.at(message.content.start, "a symbol table").within(message.content.clone());
        let (tree, names) = (bytes.address()?, bytes.address()?);
        if let (Some(tree), Some(names)) = (tree, names) {
            old_links(raw, tree, names, take)?;
        }
    }
    for message in header.of(LINK_INFO) {
        let mut bytes = raw.at(message.content.start, "a group").within(message.content.clone());
        bytes.expect(&[0])?;
        let flags = bytes.byte()?;
        bytes.skip(if flags & 1 != 0 { 8 } else { 0 })?;
        let (heap, tree) = (bytes.address()?, bytes.address()?);
        if let (Some(heap), Some(tree)) = (heap, tree) {
            let heap = FractalHeap::read(raw, heap)?;
            // Each record is a hash of the name, and where the link is.
            for record in btree::records(raw, tree)? {
                let id = record.get(4..).unwrap_or_default();
                link(heap.object(raw, id)?, take)?;
            }
        }
    }
    Ok(())
}

/// A link message.
fn link(mut bytes: ByteReader<'_>, take: &mut LinkVisitor<'_>) -> Result<(), Hdf5Error> {
    bytes.expect(&[1])?;
    let flags = bytes.byte()?;
    let kind = if flags & 8 != 0 { bytes.byte()? } else { 0 };
    // When it was made, and how its name is coded.
    bytes.skip(if flags & 4 != 0 { 8 } else { 0 })?;
    bytes.skip(if flags & 16 != 0 { 1 } else { 0 })?;
    let length = bytes.count(1 << (flags & 3))?;
    let name = bytes.take(length)?.to_vec();
    let target = match kind {
        0 => Target::Object(bytes.address()?.ok_or_else(|| bytes.damaged())?),
        1 => {
            let length = bytes.count(2)?;
            Target::Soft(bytes.take(length)?.to_vec())
        }
        _ => Target::OtherFile,
    };
    take(name, target)
}

/// The links of a group of the old style: a tree of tables, whose names stand in a heap.
fn old_links(
    raw: &FileBytes<'_>,
    tree: usize,
    heap: usize,
    take: &mut LinkVisitor<'_>,
) -> Result<(), Hdf5Error> {
    let mut bytes = raw.at(heap, "the names of a group");
    bytes.expect(b"HEAP\0\0\0\0")?;
    let size = bytes.length()?;
    bytes.length()?;
    let names = bytes.address()?.ok_or_else(|| bytes.damaged())?;
    raw.claim(heap..bytes.at(), &bytes)?;
    raw.claim(names..names.saturating_add(size), &bytes)?;
    let names = raw.bytes.get(names..names + size).ok_or_else(|| bytes.damaged())?;
    let mut tables = Vec::new();
    Tree::of_groups(raw).each(tree, &mut |_, child, _| {
        tables.push(child);
        Ok(())
    })?;
    for table in tables {
        let mut bytes = raw.at(table, "a table of links");
        bytes.expect(b"SNOD\x01\0")?;
        for _ in 0..bytes.count(2)? {
            let (name, object) = (raw.widths.address, bytes.clone());
            let at = bytes.count(name)?;
            let address = bytes.address()?;
            let kind = bytes.number(4)?;
            bytes.skip(4)?;
            let scratch = bytes.number(4)?;
            bytes.skip(12)?;
            let text = |at: usize| {
                let text = names.get(at..)?;
                text.get(..memchr::memchr(0, text)?).map(<[u8]>::to_vec)
            };
            let target = match kind {
                // The path of a soft link stands in the heap too.
                2 => Target::Soft(text(scratch as usize).ok_or_else(|| object.damaged())?),
                _ => Target::Object(address.ok_or_else(|| object.damaged())?),
            };
            take(text(at).ok_or_else(|| object.damaged())?, target)?;
        }
        raw.claim(table..bytes.at(), &bytes)?;
    }
    Ok(())
}
