//! Links of groups: link messages, symbol tables, and link messages in a fractal heap.

use super::btree::{self, Tree};
use super::bytes::{ByteReader, Hdf5Error};
use super::file_bytes::FileBytes;
use super::header::{Header, LINK, LINK_INFO, SYMBOL_TABLE};
use super::heap::FractalHeap;

/// A named link in a group.
pub(super) struct Link {
    pub(super) name: Vec<u8>,
    pub(super) target: Target<usize>,
}

/// Target of a link. `O` identifies an object: by the offset of its header, or by an index into [`Hdf5`](super::Hdf5)'s
/// objects.
pub(super) enum Target<O> {
    Object(O),
    /// A soft link: a path, from the root group if it starts with a slash, else from the group of the link.
    Soft(Vec<u8>),
    /// A link to another file, or of a type that applications define. Such a link is not followed.
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

/// Callback for the name and the target of each link.
type LinkVisitor<'t> = dyn FnMut(Vec<u8>, Target<usize>) -> Result<(), Hdf5Error> + 't;

/// Calls `take` for each link of a group. Objects other than groups have no links.
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
            // A record holds a hash of the name in four bytes, then the heap ID of the link message.
            for record in btree::records(raw, tree)? {
                let id = record.get(4..).unwrap_or_default();
                link(heap.object(raw, id)?, take)?;
            }
        }
    }
    Ok(())
}

/// Reads a link message, and calls `take` with its name and target.
fn link(mut bytes: ByteReader<'_>, take: &mut LinkVisitor<'_>) -> Result<(), Hdf5Error> {
    bytes.expect(&[1])?;
    let flags = bytes.byte()?;
    let kind = if flags & 8 != 0 { bytes.byte()? } else { 0 };
    // The creation order, and the character set of the name.
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

/// Reads the links of a symbol table: a B-tree of tables, with the names of links in a local heap.
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
                // The path of a soft link is in the local heap too, at the offset in the scratch space.
                2 => Target::Soft(text(scratch as usize).ok_or_else(|| object.damaged())?),
                _ => Target::Object(address.ok_or_else(|| object.damaged())?),
            };
            take(text(at).ok_or_else(|| object.damaged())?, target)?;
        }
        raw.claim(table..bytes.at(), &bytes)?;
    }
    Ok(())
}
