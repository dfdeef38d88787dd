//! Object headers: the messages that describe a group, a dataset or a named datatype.

use super::bytes::{ByteReader, Hdf5Error};
use super::checksum::Checksum;
use super::file_bytes::FileBytes;
use std::ops::Range;

/// A message of an object header.
#[derive(Clone, Debug)]
pub(super) struct Message {
    pub(super) kind: u16,
    /// Range of the file with the content of the message.
    pub(super) content: Range<usize>,
    /// Whether the content is the location of a message that several objects share.
    pub(super) is_shared: bool,
    /// Index in [`Header::sums`] of the checksum that covers the message; `None` in headers of version 1.
    pub(super) sum: Option<usize>,
}

/// The messages of an object, and the checksums of its header blocks.
#[derive(Clone, Debug, Default)]
pub(super) struct Header {
    pub(super) messages: Vec<Message>,
    pub(super) sums: Vec<Checksum>,
}

/// Types of messages, by their numbers in the format specification.
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
    /// Reads the object header at offset `at`, of version 1 or 2.
    pub(super) fn read(raw: &FileBytes<'_>, at: usize) -> Result<Header, Hdf5Error> {
        match raw.bytes.get(at..).is_some_and(|bytes| bytes.starts_with(b"OHDR")) {
            true => Self::second(raw, at),
            false => Self::first(raw, at),
        }
    }

    /// Returns the messages of one type, in the order of the header.
    pub(super) fn of(&self, kind: u16) -> impl Iterator<Item = &Message> {
        self.messages.iter().filter(move |message| message.kind == kind)
    }

    /// Reads a header of version 1, whose messages start at multiples of eight bytes and have no checksums.
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
        // Continuation messages add blocks to the list while blocks are read.
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

    /// Reads a header of version 2, whose blocks have a checksum each.
    fn second(raw: &FileBytes<'_>, at: usize) -> Result<Header, Hdf5Error> {
        let mut bytes = raw.at(at, "the header of an object");
        bytes.expect(b"OHDR\x02")?;
        let flags = bytes.byte()?;
        // Four time stamps, and the limits on the number of attributes in the header.
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
            // The last four bytes of the block are its checksum.
            let messages = start + 4..end.saturating_sub(4).max(start + 4);
            header.block(raw, start, messages, flags, &mut blocks)?;
        }
        Ok(header)
    }

    /// Reads `messages`, the messages of a block that starts at offset `start`, and verifies the checksum of the block.
    /// Adds blocks of continuation messages to `blocks`.
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
        // A gap at the end of a block is shorter than the head of a message.
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

    /// Adds a message to the header, or the block of a continuation message to `blocks`. Padding (type 0) is skipped.
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
