//! Attributes of objects.

use super::btree;
use super::bytes::{ByteReader, Hdf5Error};
use super::file::{Hdf5, Object};
use super::file_bytes::FileBytes;
use super::header::{ATTRIBUTE, ATTRIBUTE_INFO, Header};
use super::heap::FractalHeap;
use super::strings;
use super::types::{Dataspace, Datatype};

/// The value of an attribute: its type and its undecoded bytes.
#[derive(Clone, Debug)]
pub(crate) struct Attribute<'a> {
    pub(crate) number: Datatype,
    pub(crate) bytes: &'a [u8],
}

impl<'a> Hdf5<'a> {
    /// Returns the attribute with this name; `None` if the object has none, or if the attribute cannot be read.
    pub(crate) fn attribute(&self, object: &Object, name: &[u8]) -> Option<Attribute<'a>> {
        let mut all = self.attributes(object).into_iter();
        all.find(|(own, _)| *own == name).map(|(_, attribute)| attribute)
    }

    /// Returns the name and the value of each attribute. Attributes that cannot be read are skipped.
    pub(crate) fn attributes(&self, object: &Object) -> Vec<(&'a [u8], Attribute<'a>)> {
        let Ok(header) = &object.header else { return Vec::new() };
        let raw = &self.raw;
        let own = header.of(ATTRIBUTE).filter_map(|message| {
            let bytes = raw.at(message.content.start, "an attribute");
            read(raw, bytes.within(message.content.clone())).ok()
        });
        own.chain(elsewhere(raw, header).unwrap_or_default()).collect()
    }
}

impl<'a> Attribute<'a> {
    /// Returns the text up to its first zero byte; `None` if the attribute is not text.
    pub(crate) fn text(&self) -> Option<&'a [u8]> {
        let Datatype::Text(_) = self.number else { return None };
        self.bytes.split(|&byte| byte == 0).next()
    }
}

impl Attribute<'_> {
    /// Returns the first integer; `None` if the attribute has another type or no items.
    pub(crate) fn whole(&self) -> Option<i64> {
        let Datatype::Whole(number, order) = self.number else { return None };
        Some(order.integer(number, self.bytes.get(..number.bytes)?))
    }
}

/// Returns the attributes that an object with many of them stores in a fractal heap.
fn elsewhere<'a>(
    raw: &FileBytes<'a>,
    header: &Header,
) -> Result<Vec<(&'a [u8], Attribute<'a>)>, Hdf5Error> {
    let mut all = Vec::new();
    for message in header.of(ATTRIBUTE_INFO) {
        let mut bytes = raw.at(message.content.start, "attributes").within(message.content.clone());
        bytes.expect(&[0])?;
        let flags = bytes.byte()?;
        bytes.skip(if flags & 1 != 0 { 2 } else { 0 })?;
        if let (Some(heap), Some(tree)) = (bytes.address()?, bytes.address()?) {
            let heap = FractalHeap::read(raw, heap)?;
            for record in btree::records(raw, tree)? {
                all.extend(heap.object(raw, record).and_then(|own| read(raw, own)).ok());
            }
        }
    }
    Ok(all)
}

/// Reads an attribute message: its name and its value. A single text of variable length is read from the global heap.
fn read<'a>(
    raw: &FileBytes<'a>,
    mut bytes: ByteReader<'a>,
) -> Result<(&'a [u8], Attribute<'a>), Hdf5Error> {
    let version = bytes.byte()?;
    let flags = bytes.byte()?;
    let sizes = [bytes.count(2)?, bytes.count(2)?, bytes.count(2)?];
    if version > 3 || version == 0 || (version > 1 && flags & 3 != 0) {
        return Err(bytes.unread("an attribute with a shared datatype"));
    }
    bytes.skip(if version == 3 { 1 } else { 0 })?;
    let mut part = |size: usize| {
        let start = bytes.at();
        bytes.skip(if version == 1 { size.next_multiple_of(8) } else { size })?;
        Ok(bytes.within(start..start + size))
    };
    let (mut name, number, space) = (part(sizes[0])?, part(sizes[1])?, part(sizes[2])?);
    let name = name.take(sizes[0])?;
    let name = name.split(|&byte| byte == 0).next().unwrap_or_default();
    let (number, space) = (Datatype::read(number)?, Dataspace::read(space)?);
    if number == Datatype::VariableText(number.bytes()) && space.count() == Some(1) {
        let text = strings::read(raw, bytes)?;
        return Ok((name, Attribute { number: Datatype::Text(text.len()), bytes: text }));
    }
    let size = space.count().and_then(|count| usize::try_from(count).ok());
    let size = size.and_then(|size| size.checked_mul(number.bytes())).unwrap_or(usize::MAX);
    let bytes = bytes.take(size)?;
    Ok((name, Attribute { number, bytes }))
}
