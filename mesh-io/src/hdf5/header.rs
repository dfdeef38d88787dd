//! The header of an object: its messages, which tell what it is.

use super::bytes::{ByteReader, Hdf5Error};
use super::checksum::Checksum;
use super::file_bytes::FileBytes;
use std::ops::Range;

/// A message of a header.
#[derive(Clone, Debug)]
pub(super) struct Message {
    pub(super) kind: u16,
    pub(super) content: Range<usize>,
    /// Whether its content stands elsewhere, and it tells where.
    pub(super) is_shared: bool,
    /// The checksum that covers it, by its place among those of the header.
    pub(super) sum: Option<usize>,
}

/// The messages of an object and the checksums that cover them.
#[derive(Clone, Debug, Default)]
pub(super) struct Header {
    pub(super) messages: Vec<Message>,
    pub(super) sums: Vec<Checksum>,
}

/// The kinds of messages.
pub(super) const SPACE: u16 = 1;
pub(super) const LINK_INFO: u16 = 2;
pub(super) const TYPE: u16 = 3;
pub(super) const LINK: u16 = 6;
pub(super) const LAYOUT: u16 = 8;
pub(super) const FILTERS: u16 = 11;
pub(super) const ATTRIBUTE: u16 = 12;
const CONTINUATION: u16 = 16;
pub(super) const SYMBOL_TABLE: u16 = 17;
pub(super) const ATTRIBUTE_INFO: u16 = 21;

impl Header {
    /// Reads the header at this address.
    pub(super) fn read(raw: &FileBytes<'_>, at: usize) -> Result<Header, Hdf5Error> {
        match raw.bytes.get(at..).is_some_and(|bytes| bytes.starts_with(b"OHDR")) {
            true => Self::second(raw, at),
            false => Self::first(raw, at),
        }
    }

    /// Those of a kind.
    pub(super) fn of(&self, kind: u16) -> impl Iterator<Item = &Message> {
        self.messages.iter().filter(move |message| message.kind == kind)
    }

    /// Version 1: messages that start at multiples of eight bytes, without checksums.
    fn first(raw: &FileBytes<'_>, at: usize) -> Result<Header, Hdf5Error> {
        let mut bytes = raw.at(at, "the header of an object");
        bytes.expect(&[1])?;
        bytes.skip(1 + 2 + 4)?;
        let size = bytes.count(4)?;
        bytes.align(at, 8)?;
        let first = bytes.at()..bytes.at().saturating_add(size);
        let mut blocks = vec![first];
        raw.claim(at..bytes.at(), &bytes)?;
        let mut header = Header::default();
        // Blocks are found while others are read.
        let mut next = 0;
        while let Some(block) = blocks.get(next).cloned() {
            next += 1;
            raw.claim(block.clone(), &bytes)?;
            let mut block = bytes.within(block);
            while block.left() >= 8 {
                let (kind, size) = (block.number(2)? as u16, block.count(2)?);
                let is_shared = block.byte()? & 2 != 0;
                block.skip(3)?;
                let start = block.at();
                block.skip(size)?;
                let content = start..block.at();
                header.add(Message { kind, content, is_shared, sum: None }, &block, &mut blocks)?;
            }
        }
        Ok(header)
    }

    /// Version 2: blocks with checksums.
    fn second(raw: &FileBytes<'_>, at: usize) -> Result<Header, Hdf5Error> {
        let mut bytes = raw.at(at, "the header of an object");
        bytes.expect(b"OHDR\x02")?;
        let flags = bytes.byte()?;
        // Times, and when attributes are stored elsewhere.
        bytes.skip(if flags & 32 != 0 { 16 } else { 0 })?;
        bytes.skip(if flags & 16 != 0 { 4 } else { 0 })?;
        let size = bytes.count(1 << (flags & 3))?;
        let mut header = Header::default();
        let mut blocks = Vec::new();
        let messages = bytes.at()..bytes.at().saturating_add(size);
        header.block(raw, at, messages, flags, &mut blocks)?;
        let mut next = 0;
        while let Some(Range { start, end }) = blocks.get(next).cloned() {
            next += 1;
            bytes.within(start..end).expect(b"OCHK")?;
            // The last four bytes are the checksum.
            let messages = start + 4..end.saturating_sub(4).max(start + 4);
            header.block(raw, start, messages, flags, &mut blocks)?;
        }
        Ok(header)
    }

    /// Reads the messages of a block that starts at a place.
    fn block(
        &mut self,
        raw: &FileBytes<'_>,
        start: usize,
        messages: Range<usize>,
        flags: u8,
        blocks: &mut Vec<Range<usize>>,
    ) -> Result<(), Hdf5Error> {
        let mut bytes = raw.at(start, "the header of an object");
        bytes.skip(messages.end - start)?;
        let sum = Checksum::take(start, &mut bytes)?;
        raw.claim(start..bytes.at(), &bytes)?;
        self.sums.push(sum);
        let number = self.sums.len() - 1;
        let mut block = bytes.within(messages);
        let head = if flags & 4 != 0 { 6 } else { 4 };
        // A few bytes at the end may be too few for a message.
        while block.left() >= head {
            let (kind, size) = (u16::from(block.byte()?), block.count(2)?);
            let is_shared = block.byte()? & 2 != 0;
            block.skip(head - 4)?;
            let start = block.at();
            block.skip(size)?;
            let content = start..block.at();
            let message = Message { kind, content, is_shared, sum: Some(number) };
            self.add(message, &block, blocks)?;
        }
        Ok(())
    }

    /// Adds a message, or the block that goes on with them.
    fn add(
        &mut self,
        message: Message,
        bytes: &ByteReader<'_>,
        blocks: &mut Vec<Range<usize>>,
    ) -> Result<(), Hdf5Error> {
        match message.kind {
            0 => {}
            CONTINUATION => {
                let mut bytes = bytes.within(message.content);
                let (at, length) = (bytes.address()?, bytes.length()?);
                if let Some(at) = at {
                    blocks.push(at..at.saturating_add(length));
                }
            }
            _ => self.messages.push(message),
        }
        Ok(())
    }
}
